"""Two stages of a figure group: ``simulation`` (parameters to datasets), ``drawing`` (datasets to figures).

A group is a folder of ``paper.groups``, with a module for each stage and one for its parameters. The command line and
the pipeline come here; a stage depends on its module and on what the group imports, not on the command line.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

from granular_response.errors import GranularError
from granular_response_paper.groups import NAMES


class GroupError(GranularError):
    """A figure group, or its parameters, that does not exist. The message is one line."""


def data_path(group: str) -> Path:
    """Where the datasets of a group are kept."""
    return Path("data") / f"{group}.nc"


def figures_folder(group: str) -> Path:
    """Where the figures of a group are kept."""
    return Path("figures") / group


def group_member(group: str, module: str, name: str, *, optional: bool = False) -> Any:
    """What the ``module`` of a group calls ``name``: its function ``simulate`` or ``draw``, its class ``Parameters``.

    None for what is ``optional`` where the group has no such module, or the module no such name. Raises GroupError if
    there is no such group.
    """
    if group not in NAMES:
        raise GroupError(f"{group}: no such figure group, must be one of {', '.join(NAMES)}")
    path = f"granular_response_paper.groups.{group}.{module}"
    if optional:
        return getattr(importlib.import_module(path), name, None) if importlib.util.find_spec(path) else None
    return getattr(importlib.import_module(path), name)
