"""Fixtures of figure groups at reduced size."""

from group_fixtures import datasets, looks_as_stored, one_process

__all__ = ["datasets", "looks_as_stored", "one_process"]
