"""Figure group ``superposition``."""
