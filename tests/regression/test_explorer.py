"""The slabs that the page's explorer adds: small ones, followed up to where they collapse."""

import numpy as np
import pytest
from granular_response_paper.groups.explorer.numbers import numbers

from granular_response.observe.floor import smoothed_response


@pytest.fixture(scope="module")
def slabs(datasets):
    return [datasets["slab_0"], datasets["slab_1"]]


def test_states_begin_at_rest_and_end_before_the_collapse(slabs):
    for slab in slabs:
        assert slab["force"].values.tolist()[:3] == [0.0, 0.5, 2.0]
        sink = slab["position"].values[:, int(slab["loaded_disk"]), 1]
        assert np.all(sink[0] - sink <= 0.2)
        assert float(slab["certificate_force_residual"].max()) < 1e-9
    assert slabs[1].sizes["state"] == 3


def test_slabs_say_what_they_are(slabs):
    lattice, disordered = slabs
    names = ("polydispersity", "friction", "wall_friction", "stiffness_ratio", "smoothing_width")
    assert [float(lattice[name]) for name in names] == [0.0, 0.2, 0.0, 0.2, 0.0]
    assert [float(disordered[name]) for name in names] == [0.25, 0.2, 0.2, 0.8, 3.0]


def test_walls_without_friction_leave_the_whole_load_to_the_floor(slabs):
    lattice, disordered = slabs
    np.testing.assert_allclose(lattice["floor_response"][1:].sum("floor_disk"), 1.0, atol=1e-6)
    assert np.all(np.isnan(lattice["floor_response"][0]))
    assert np.all(disordered["floor_response"][1:].sum("floor_disk") < 1.0)  # rough walls bear a part


def test_only_disorder_is_smoothed(slabs):
    lattice, disordered = slabs
    np.testing.assert_array_equal(lattice["smoothed_response"], lattice["floor_response"])
    x = disordered["x"].values
    expected = smoothed_response(np.append(x, 0.0), x, disordered["floor_response"].values[1:], 3.0)
    np.testing.assert_allclose(disordered["smoothed_response"][1:], expected[:, :-1], rtol=1e-12)
    np.testing.assert_allclose(disordered["response_at_centre"][1:], expected[:, -1], rtol=1e-12)


def test_numbers_are_those_of_the_last_states(slabs):
    found = numbers({"a": slabs[1]})
    assert 0.0 <= found.pop("max. unbalanced force") < 1e-9
    (largest, response) = found.values()
    assert largest == 2.0 and response == float(slabs[1]["response_at_centre"][-1])
