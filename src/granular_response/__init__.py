"""Quasi-static response of two-dimensional granular solids to a localized force."""

__version__ = "0.1.0"
