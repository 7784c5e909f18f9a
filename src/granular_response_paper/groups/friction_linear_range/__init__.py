"""Figure group ``friction_linear_range``."""
