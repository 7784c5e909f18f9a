"""Figure group ``symmetry_breaking``."""
