"""Figure group ``influence``."""
