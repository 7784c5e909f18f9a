"""The small problems of the unit tests serve here too; studies run in this process unless a test says otherwise."""

import sys
from pathlib import Path

import pytest

from granular_response.sweeps.resources import using

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))


@pytest.fixture(scope="module", autouse=True)
def one_process():
    with using(workers=1):
        yield
