"""Two stages of a figure group: ``simulation`` (parameters to datasets), ``drawing`` (datasets to figures).

The command line and the pipeline come here, from the folder of the group's collection; a stage depends on its module
and on what the group imports, not on the command line.
"""

from __future__ import annotations

from pathlib import Path


def data_path(group: str) -> Path:
    """Where the datasets of a group are kept."""
    return Path("data") / f"{group}.nc"
