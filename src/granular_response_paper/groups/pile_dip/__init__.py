"""Figure group ``pile_dip``."""
