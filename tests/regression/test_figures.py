"""Figures of groups at reduced size are the small pictures beside the tests of the group, and each has a caption."""

from pathlib import Path

import pytest
import reduced

from granular_response_paper.pipeline import group_member

GROUPS = (
    "crossover_scaling",
    "experiments",
    "hysteresis",
    "influence",
    "moduli",
    "network",
    "peak_width",
    "polydisperse_averages",
    "rolling_resistance",
    "slab_comparison",
    "stiffness_ratio_crossover",
    "superposition",
    "tangent_moduli",
)

#: Of groups with several, in the order in which they are drawn.
ORDER = {
    "experiments": ["experiments", "experiments_images"],
    "rolling_resistance": ["rolling_resistance", "rolling_resistance_torque"],
}


@pytest.fixture(params=GROUPS)
def group(request):
    return request.param


@pytest.fixture
def original_datadir(group):
    return Path(__file__).parent / f"test_{group}"


def test_figures_look_as_stored_and_have_captions(group, looks_as_stored, tmp_path_factory):
    datasets = reduced.datasets(group, tmp_path_factory)
    drawn = group_member(group, "draw", "draw")(datasets)
    assert list(drawn) == ORDER.get(group, list(drawn))
    looks_as_stored(drawn)
    assert {path.stem for path in (Path(__file__).parent / f"test_{group}").glob("*.png")} == set(drawn)
    parameters = group_member(group, "parameters", "Parameters")(**reduced.parameters(group))
    assert set(group_member(group, "draw", "captions")(datasets, parameters)) == set(drawn)
