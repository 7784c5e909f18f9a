"""Fixtures of tests of figure groups: studies run in this process, at reduced size."""

from pathlib import Path

import pytest
import reduced

from granular_response.plot import style
from granular_response.sweeps.resources import using

#: Mean difference of two pictures in percent of black and white that is no change; a thin curve more or less is 0.1.
SAME = 0.03


@pytest.fixture(scope="module", autouse=True)
def one_process():
    with using(workers=1):
        yield


@pytest.fixture(scope="module")
def datasets(request, tmp_path_factory):
    """Those of the group that a module is named after, at reduced size, from a file."""
    return reduced.datasets(Path(request.module.__file__).stem.removeprefix("test_"), tmp_path_factory)


@pytest.fixture
def looks_as_stored(image_regression):
    """Compares figures, by file stem, with the small pictures beside the test; ``--regen-all`` renews these."""

    def check(drawn):
        for stem, figure in drawn.items():
            image_regression.check(style.render(figure, dpi=40), diff_threshold=SAME, basename=stem)

    return check
