"""The small problems of the unit tests serve here too; studies run in this process unless a test says otherwise."""

import sys
from pathlib import Path

import pytest

from granular_response.sweeps.resources import using

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))

import reduced


@pytest.fixture(scope="module", autouse=True)
def one_process():
    with using(workers=1):
        yield


@pytest.fixture(scope="module")
def datasets(request, tmp_path_factory):
    """Those of the group that a module is named after, at reduced size, from a file."""
    return reduced.datasets(Path(request.module.__file__).stem.removeprefix("test_"), tmp_path_factory)
