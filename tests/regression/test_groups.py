"""Every figure group at reduced size: numbers and pictures are the stored ones, no parameters end in a traceback.

The cases come from the folders of the groups. ``pytest --force-regen`` stores new numbers and pictures.
"""

import contextlib
import re
from typing import Any

import numpy as np
import pytest
import reduced

from granular_response.errors import SolveError
from granular_response.plot import style
from granular_response.scene import SceneError, text
from granular_response.sweeps.errors import SweepError
from granular_response_paper.pipeline import drawing, simulation
from granular_response_paper.registry import GroupError, group_member

#: What the command line tells in one line.
LINES = (GroupError, SceneError, SolveError)

#: Differences of stored numbers that rounding may make beyond a lost equilibrium, relative and absolute.
SAME, NOTHING = 1e-4, 1e-6


@pytest.fixture(params=reduced.GROUPS)
def group(request):
    return request.param


@pytest.fixture
def original_datadir(group):
    return reduced.expected(group)


def sizes(values: np.ndarray) -> tuple[float, float, float]:
    """Mean, root mean square and largest size of finite values: a mirrored solution has the same last two."""
    finite = np.abs(values[np.isfinite(values)].astype(float))
    return (finite.mean(), np.sqrt((finite**2).mean()), finite.max()) if finite.size else (0.0, 0.0, 0.0)


def test_numbers_are_the_stored_ones_and_states_certified(group, num_regression, tmp_path_factory):
    columns = {}
    for name, dataset in reduced.datasets(group, tmp_path_factory).items():
        for variable, values in dataset.data_vars.items():
            if values.dtype.kind == "f":
                columns[f"{name}/{variable}"] = sizes(values.values)
            if re.match(r"certificate_\w+_(residual|excess|modes)$", variable):
                assert float(values.max()) < 1e-9, variable
    assert columns
    num_regression.check(columns, basename="numbers", default_tolerance={"rtol": SAME, "atol": NOTHING})


def test_figures_look_as_stored_and_have_captions(group, looks_as_stored, tmp_path_factory):
    datasets = reduced.datasets(group, tmp_path_factory)
    with style.context():
        drawn = group_member(group, "draw", "draw")(datasets)
    parameters = group_member(group, "parameters", "Parameters")(**reduced.parameters(group))
    assert set(group_member(group, "draw", "captions")(datasets, parameters)) == set(drawn)
    looks_as_stored(drawn)
    assert {path.stem for path in reduced.expected(group).glob("*.png")} == set(drawn)


def shortened(value: Any, to: int | None) -> Any:
    """With as many entries of each list."""
    if isinstance(value, dict):
        return {key: shortened(one, to) for key, one in value.items()}
    return [shortened(one, to) for one in value[:to]] if isinstance(value, list) else value


def scaled(section: Any, factor: float, inside: bool = False) -> Any:
    """Forces that are far too weak, or far too strong; ``inside`` a key of forces."""
    if isinstance(section, dict):
        return {
            key: scaled(value, factor, re.search(r"(?<!most_)forces?$", key) is not None)
            for key, value in section.items()
        }
    if isinstance(section, list):
        return [scaled(value, factor, inside) for value in section]
    number = isinstance(section, float | int) and not isinstance(section, bool)
    return section * factor if inside and number else section


def few(group: str, factor: float) -> dict[str, Any]:
    """Forces that are scaled, and as few entries of each list, from two on, as the group takes."""
    for count in (2, 3, None):
        section = scaled(shortened(reduced.parameters(group), count), factor)
        with contextlib.suppress(SceneError):
            group_member(group, "parameters", "Parameters")(**section)
            break
    return section


#: Allowed parameters, or nearly, that nobody would take: what is measured is then often nothing.
ODD = {
    "one of each": lambda group: shortened(reduced.parameters(group), 1),
    "strong forces": lambda group: few(group, 8.0),
}


@pytest.fixture
def coarse_pictures(monkeypatch):
    """All that is asked here is that a picture can be drawn; texts of the stored size are known from the others."""
    render = style.render

    def coarse(drawn, file_format):
        drawn.set_layout_engine("none")  # to lay out takes as long as to draw
        return render(drawn, file_format, dpi=40)

    monkeypatch.setattr(style, "render", coarse)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("coarse_pictures")
@pytest.mark.parametrize("kind", ODD)
def test_an_experiment_never_ends_in_a_traceback(group, kind, tmp_path):
    section = ODD[kind](group)
    section.pop("method", None)
    (tmp_path / "params.yaml").write_text(text.write({"common": {"method": "auto"}, group: section}))
    data = tmp_path / "data.nc"
    for stage in (
        lambda: simulation.simulate(group, data, parameter_file=tmp_path / "params.yaml", workers=1),
        lambda: drawing.draw(group, data, tmp_path / "figures"),
    ):
        try:
            stage()
        except SweepError as error:  # a scene that is not solved is told by its own line
            assert isinstance(error.__cause__, LINES), error
            assert "\n" not in str(error)
        except LINES as error:
            assert "\n" not in str(error)
        if not data.exists():
            return
