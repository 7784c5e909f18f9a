"""Stress tests: random scenes and motions known in closed form, each result checked from its positions alone."""
