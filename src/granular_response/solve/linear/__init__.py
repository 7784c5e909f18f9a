"""Factorisations of tangent stiffnesses."""
