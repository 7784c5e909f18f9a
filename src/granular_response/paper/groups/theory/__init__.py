"""Figure group ``theory``."""
