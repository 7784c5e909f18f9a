"""Widths of the response in slabs of 4 to 12 layers, from parameters through a file."""

import numpy as np
import pytest

from granular_response_paper.claims.claim import Data
from granular_response_paper.claims.verdict import judge
from granular_response_paper.groups.peak_width.claims import CLAIMS

SMALL, LARGE, DISORDERED = 0, 1, 2


def test_beside_smooth_walls_every_line_bears_the_whole_force(datasets):
    for data in datasets.values():
        share = data["transmitted"].isel(case=[SMALL, LARGE]).values
        assert share[np.isfinite(share)] == pytest.approx(1.0, abs=1e-6)


def test_a_lattice_is_as_wide_as_the_elastic_slab(datasets):
    """Twelve layers already, beyond the grains: the same lines, and floors, of a series in closed form."""
    inside, floors = (datasets[name].isel(case=SMALL, definition=slice(0, 2)) for name in ("inside", "floors"))
    fitted = inside["fitted"].values == 1.0
    assert fitted.sum() >= 5
    assert inside["length"].values[fitted] == pytest.approx(inside["elastic_length"].values[fitted], rel=0.1)
    assert floors["length"].values[-1] == pytest.approx(floors["elastic_length"].values[-1], rel=0.05)


def test_beyond_the_first_opening_the_lattice_has_two_peaks(datasets):
    inside = datasets["inside"].sel(definition="peak_position")
    at = inside["fitted"].values[LARGE] == 1.0
    assert np.isfinite(inside["length"].values[LARGE, at]).all()
    assert np.isnan(inside["length"].values[SMALL, at]).all()


def test_intervals_hold_the_power(datasets):
    floors = datasets["floors"].isel(definition=slice(0, 2))
    low, high = np.moveaxis(floors["interval"].values, -1, 0)
    value = floors["power"].isel(fit=0).values
    assert (low <= value).all() and (value <= high).all()
    assert (low < high).all()


@pytest.mark.parametrize(
    ("name", "value", "verdict"), [("B6", 1.0, "supported"), ("B6", 0.5, "not supported"), ("B7", 0.76, "cannot tell")]
)
def test_the_claims_follow_the_powers(datasets, name, value, verdict):
    changed = {key: data.copy() for key, data in datasets.items()}
    for data in changed.values():
        data["power"] = data["power"].fillna(0.0) * 0.0 + value
        data["interval"] = data["interval"].fillna(0.0) * 0.0 + value + np.array([-0.02, 0.02])
    claim = next(one for one in CLAIMS if one.id == name)
    assert judge(claim, Data({"peak_width": changed})).verdict == verdict
