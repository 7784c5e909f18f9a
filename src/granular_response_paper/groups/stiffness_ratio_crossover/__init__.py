"""Figure group ``stiffness_ratio_crossover``."""
