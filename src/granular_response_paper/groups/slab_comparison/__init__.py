"""Figure group ``slab_comparison``."""
