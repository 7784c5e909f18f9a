"""Figure group ``peak_width``."""
