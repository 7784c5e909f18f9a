"""Fixtures of figure groups at reduced size."""

from group_fixtures import looks_as_stored, one_process

__all__ = ["looks_as_stored", "one_process"]
