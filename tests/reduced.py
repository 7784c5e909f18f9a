"""Figure groups at reduced size, with the parameters of their notebooks."""

import os
import time
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from granular_response.store import files as store
from granular_response_paper.pipeline import GroupError, simulation

PATH = Path(__file__).parents[1] / "notebooks" / "reduced.yaml"


def parameters(group: str) -> dict[str, Any]:
    """The section of a group with what it takes of the section ``common``, as keyword arguments of its Parameters."""
    return simulation.parameters(group, PATH)[0]


def datasets(group: str, factory: pytest.TempPathFactory) -> dict[str, xr.Dataset]:
    """The group's datasets as a file gives them back."""
    return store.read(stored(group, factory))


def stored(group: str, factory: pytest.TempPathFactory) -> Path:
    """The file with the group's datasets, simulated once in a run of the tests, by the first process that asks."""
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "reduced"
    folder.mkdir(exist_ok=True)
    path = folder / f"{group}.nc"
    parameters(group)  # a group that is none ends here
    while not path.exists():
        try:
            simulation.simulate(group, path, parameter_file=PATH, workers=1)
        except GroupError:  # another process is at it
            time.sleep(0.1)
    return path
