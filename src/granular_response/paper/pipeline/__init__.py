"""Two stages of a figure group: ``simulation`` (parameters to datasets), ``drawing`` (datasets to figures).

A group is a folder of ``paper.groups``, with a module for each stage. The command line and the
pipeline come here; a stage depends on its module and on what the group imports, not on the command line.
"""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

_PACKAGE = "granular_response.paper.groups"


class GroupError(Exception):
    """A figure group, or its parameters, that does not exist. The message is one line."""


def data_path(group: str) -> Path:
    """Where the datasets of a group are kept."""
    return Path("data") / f"{group}.nc"


def figures_folder(group: str) -> Path:
    """Where the figures of a group are kept."""
    return Path("figures") / group


def groups(verb: str) -> list[str]:
    """Names of the groups that can ``"simulate"`` or ``"draw"``."""
    return [name for name in _names() if _verb(verb, name) is not None]


def group_function(verb: str, group: str) -> Callable[..., Any]:
    """The function ``simulate`` or ``draw`` of a group. Raises GroupError if there is no such group."""
    function = _verb(verb, group) if group in _names() else None
    if function is None:
        known = ", ".join(groups(verb)) or "none"
        raise GroupError(f"{group}: no such figure group to {verb}, must be one of {known}")
    return function


def _names() -> list[str]:
    return [module.name for module in pkgutil.iter_modules(importlib.import_module(_PACKAGE).__path__)]


def _verb(verb: str, name: str) -> Callable[..., Any] | None:
    module = f"{_PACKAGE}.{name}.{verb}"
    return getattr(importlib.import_module(module), verb) if importlib.util.find_spec(module) else None
