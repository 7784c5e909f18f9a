"""Figure group ``network``."""
