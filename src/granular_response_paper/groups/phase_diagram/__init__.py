"""Figure group ``phase_diagram``."""
