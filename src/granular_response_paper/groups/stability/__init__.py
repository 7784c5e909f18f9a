"""Figure group ``stability``."""
