"""Figure group ``crossover_scaling``."""
