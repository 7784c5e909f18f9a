"""Figure group ``moduli``."""
