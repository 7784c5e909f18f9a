"""The figure groups that there are, by the collections that hold them.

A *figure group* is a folder with ``parameters.py`` (the class ``Parameters``, the group's section of ``params.yaml``),
``simulate`` (parameters to datasets), ``draw.py`` (datasets to figures), ``captions.yaml``, ``reduced.yaml`` (a run of
seconds) and, where something is claimed, ``claims.py``. A *collection* is a package of such
folders with a pipeline of its own. The paper is one. Others are installed beside it and found by their entry points,
so the paper knows none of them::

    [project.entry-points."granular_response_paper.collections"]
    extensions = "granular_response_extensions:COLLECTION"
"""

from __future__ import annotations

import difflib
import importlib
import importlib.util
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import metadata
from pathlib import Path
from typing import Any

from granular_response.errors import GranularError

ENTRY_POINTS = "granular_response_paper.collections"


class GroupError(GranularError):
    """A figure group, or its parameters, that does not exist. The message is one line."""


@dataclass(frozen=True)
class Collection:
    """A package of figure groups, and the folder of the checkout with its pipeline, parameters, datasets and figures.

    ``folder`` is given from the root of the checkout; ``title`` is what the collection is called in sentences.
    """

    name: str
    package: str
    folder: str
    title: str

    @cached_property
    def path(self) -> Path:
        """Where the package is."""
        spec = importlib.util.find_spec(self.package)
        assert spec is not None and spec.submodule_search_locations
        return Path(next(iter(spec.submodule_search_locations)))

    @property
    def here(self) -> Path:
        """Its folder seen from the current one, which is the root of the checkout, or that folder itself."""
        inside = Path(self.folder)
        return inside if (inside / "params.yaml").is_file() else Path()

    @cached_property
    def groups(self) -> tuple[str, ...]:
        """Names of its figure groups, in alphabetical order."""
        return tuple(sorted(file.parent.name for file in self.path.glob("*/parameters.py")))


PAPER = Collection("paper", "granular_response_paper.groups", ".", "the paper")


@cache
def collections() -> tuple[Collection, ...]:
    """The paper first, then what is installed beside it, by name."""
    found = sorted(metadata.entry_points(group=ENTRY_POINTS), key=lambda point: point.name)
    return (PAPER, *(point.load() for point in found))


def collection(name: str) -> Collection:
    """The collection of this name. Raises GroupError if it is not installed."""
    for one in collections():
        if one.name == name:
            return one
    raise GroupError(f"{name}: no such collection, must be one of {', '.join(one.name for one in collections())}")


def collection_of(group: str) -> Collection:
    """The collection that holds a figure group. Raises GroupError, which names the groups that there are."""
    for one in (PAPER, *collections()):  # without reading any entry point where the paper has it
        if group in one.groups:
            return one
    every = [name for one in collections() for name in one.groups]
    near = difflib.get_close_matches(group, every, 1)
    guess = f", did you mean {near[0]} ({collection_of(near[0]).title})?" if near else ","
    listed = "; ".join(f"{one.title}: {', '.join(one.groups)}" for one in collections())
    raise GroupError(f"{group}: no such figure group{guess} groups of {listed}")


def group_path(group: str) -> Path:
    """The folder of a figure group's modules. Raises GroupError if there is no such group."""
    return collection_of(group).path / group


def group_member(group: str, module: str, name: str, *, optional: bool = False) -> Any:
    """What the ``module`` of a group calls ``name``: its function ``simulate`` or ``draw``, its class ``Parameters``.

    None for what is ``optional`` where the group has no such module, or the module no such name. Raises GroupError if
    there is no such group.
    """
    path = f"{collection_of(group).package}.{group}.{module}"
    if optional:
        return getattr(importlib.import_module(path), name, None) if importlib.util.find_spec(path) else None
    return getattr(importlib.import_module(path), name)
