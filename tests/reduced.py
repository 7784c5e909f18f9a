"""Figure groups at reduced size, with the parameters that stand beside each of them."""

import os
import time
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from places import ROOT

from granular_response.store import files as store
from granular_response_paper.pipeline import simulation
from granular_response_paper.registry import GroupError, collection_of, collections, group_path

#: All figure groups, of the paper and beyond.
GROUPS = [name for one in collections() for name in one.groups]


def path(group: str) -> Path:
    """The parameter file of a group at reduced size."""
    return group_path(group) / "reduced.yaml"


def parameters(group: str) -> dict[str, Any]:
    """The section of a group with what it takes of the section ``common``, as keyword arguments of its Parameters."""
    return simulation.parameters(group, path(group))[0]


def expected(group: str) -> Path:
    """The folder with the stored values and pictures of a group at reduced size."""
    return ROOT / collection_of(group).folder / "tests" / "groups" / group


def datasets(group: str, factory: pytest.TempPathFactory) -> dict[str, xr.Dataset]:
    """The group's datasets as a file gives them back."""
    return store.read(stored(group, factory))


def stored(group: str, factory: pytest.TempPathFactory) -> Path:
    """The file with the group's datasets, simulated once in a run of the tests, by the first process that asks."""
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "reduced"
    folder.mkdir(exist_ok=True)
    output = folder / f"{group}.nc"
    parameters(group)  # a group that is none ends here
    while not output.exists():
        try:
            simulation.simulate(group, output, parameter_file=path(group), workers=1)
        except GroupError as error:
            if "another run is making it" not in str(error):
                raise
            time.sleep(0.1)
    return output
