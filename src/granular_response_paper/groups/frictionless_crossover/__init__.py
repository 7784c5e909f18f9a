"""Figure group ``frictionless_crossover``."""
