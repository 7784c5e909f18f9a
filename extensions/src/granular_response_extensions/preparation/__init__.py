"""Figure group ``preparation``."""
