"""Figure groups at reduced size, with the parameters of their notebooks."""

import os
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from granular_response.machine.turns import Turns
from granular_response.paper.pipeline import group_member, simulation
from granular_response.store import files as store
from granular_response.sweeps.resources import using

PATH = Path(__file__).parents[2] / "notebooks" / "reduced.yaml"


def parameters(group: str) -> dict[str, Any]:
    """The section of a group with what it takes of the section ``common``, as keyword arguments of its Parameters."""
    return simulation.parameters(group, PATH)[0]


def datasets(group: str, factory: pytest.TempPathFactory) -> dict[str, xr.Dataset]:
    """The group's datasets as a file gives them back."""
    return store.read(stored(group, factory))


@cache
def _turns(folder: Path) -> Turns:
    return Turns(folder / "turns")


def stored(group: str, factory: pytest.TempPathFactory) -> Path:
    """The file with the group's datasets, simulated once in a run of the tests, by the first process that asks.

    Others wait, but not for ever: of two that simulate the same the later one leaves the file as it is.
    """
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "reduced"
    folder.mkdir(exist_ok=True)
    path = folder / f"{group}.nc"
    with _turns(folder).taken(group), using(workers=1):
        if not path.exists():
            described = group_member(group, "parameters", "Parameters")
            simulate = group_member(group, "simulate", "simulate")
            store.write(path, simulate(described(**parameters(group))), {"group": group})
    return path
