"""Figure group ``sensitivity``."""
