"""Figure group ``torque``."""
