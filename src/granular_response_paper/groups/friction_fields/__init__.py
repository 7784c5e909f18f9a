"""Figure group ``friction_fields``."""
