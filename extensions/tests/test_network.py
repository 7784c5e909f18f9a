"""Contact networks of small slabs, from parameters through a file."""

import numpy as np
import pytest

from granular_response_extensions.network import simulate


def test_distributions_are_normalised(datasets):
    data = datasets["statistics"]
    assert np.nanmax(np.abs(data["force_mean"] - 1.0)) < 1e-12
    assert np.nanmax(data["force_density"].sum("force")) * np.diff(simulate.FORCES)[0] <= 1.0 + 1e-12
    rough = data["mobilization_density"].sel(friction=0.2, state="rest").sum("mobilization")
    assert rough.values * np.diff(simulate.MOBILIZATION)[0] == pytest.approx(1.0)
    assert np.isnan(data["mobilization_density"].sel(friction=0.0)).all()
    assert data["angle_density"].sel(state="rest").sum("angle").values * np.pi / simulate.ANGLES == pytest.approx(1.0)


def test_every_cut_bears_what_rests_on_it(datasets):
    assert np.nanmax(datasets["statistics"]["cut_imbalance"]) < 1e-8
