"""Figure group ``rolling_resistance``."""
