"""Figure group ``contact_law``."""
