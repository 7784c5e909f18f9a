"""Figure group ``numerics``."""
