"""Figure group ``tangent_moduli``."""
