"""The influence of every disk on a slab of 6 layers, from parameters through a file."""

import numpy as np
import pytest
import xarray as xr

from granular_response_extensions.influence import simulate
from granular_response_paper.claims.claim import Data
from granular_response_paper.claims.table import claims_of
from granular_response_paper.claims.verdict import judge


def test_equivalent_loads_differ_less_from_row_to_row(datasets):
    lattice = datasets["saint_venant"]["difference"].isel(case=0, realization=0, separation=0).values
    assert (np.diff(lattice[:4]) < 0.0).all()
    assert np.isnan(datasets["saint_venant"]["exponent"].isel(case=0, realization=1)).all()  # a lattice has one


def test_the_power_of_a_power_law_is_found():
    height = np.linspace(1.0, 30.0, 30)
    assert simulate.decay(height, 3.0 * height**-1.7, 2.0, (2.0, 8.0)) == pytest.approx([1.7] * 3)
    assert np.isnan(simulate.decay(height, height**-1.7, 2.0, (2.0, 2.5))).all()


@pytest.mark.parametrize(
    ("lattice", "disordered", "verdict"),
    [(2.0, 1.9, "supported"), (2.0, 1.2, "in part"), (1.0, 0.1, "not supported")],
)
def test_the_claim_follows_the_powers(lattice, disordered, verdict):
    exponent = np.full((2, 4, 1, 3), np.nan)
    exponent[0, 0] = lattice
    exponent[1] = disordered + np.array([-0.02, 0.0, 0.01, 0.02])[:, None, None]
    study = xr.Dataset(
        {
            "exponent": (("case", "realization", "separation", "fit"), exponent),
            "polydispersity": ("case", [0.0, 0.1]),
            "friction": ("case", [0.0, 0.2]),
        }
    )
    assert judge(claims_of("influence")[0], Data({"influence": {"saint_venant": study}})).verdict == verdict
