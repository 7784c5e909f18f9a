"""Figure group ``hysteresis``."""
