"""Figure group ``experiments``."""
