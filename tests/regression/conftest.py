"""Studies run in this process, and are those of the notebooks."""

from pathlib import Path

import pytest
import reduced

from granular_response.sweeps.resources import using


@pytest.fixture(scope="module", autouse=True)
def one_process():
    with using(workers=1):
        yield


@pytest.fixture(scope="module")
def datasets(request, tmp_path_factory):
    """Those of the group that a module is named after, at reduced size, from a file."""
    return reduced.datasets(Path(request.module.__file__).stem.removeprefix("test_"), tmp_path_factory)
