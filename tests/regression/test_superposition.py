"""Figs. 23 and 24 on small slabs, from parameters through a file to figures."""

import numpy as np
import reduced

from granular_response.scene import Scene
from granular_response.sweeps.rest import rest_of
from granular_response_paper.groups.superposition import simulate as study

PARAMETERS = reduced.parameters("superposition")


def test_stored_errors_are_those_of_the_stored_responses(datasets) -> None:
    responses = datasets["responses"]["floor_response"].isel(realization=1, distance=0, force=2)
    left, right, both = (responses.sel(part=part).values for part in study.PARTS)
    stored = datasets["errors"].isel(realization=1, distance=0, force=2)
    difference = both - left - right
    np.testing.assert_allclose(stored["floor_error"], np.sqrt(np.mean(difference**2) / np.mean(both**2)), rtol=1e-12)
    np.testing.assert_allclose(stored["floor_error_largest"], np.abs(difference).max() / np.abs(both).max(), rtol=1e-12)


def test_the_end_of_the_linear_range_is_bracketed(datasets) -> None:
    linear = datasets["linear_range"]
    assert linear.sizes["realization"] == 3
    centre = linear["response_at_centre"].values
    forces = linear["force"].values
    for realization in range(3):
        change = np.abs(centre[realization] / centre[realization, 0] - 1.0)
        until, beyond = float(linear["linear_until"][realization]), float(linear["nonlinear_from"][realization])
        assert np.all(change[forces <= until] <= 0.05)
        if np.isfinite(beyond):
            assert change[forces == beyond] > 0.05
            assert forces[np.searchsorted(forces, until) + 1] == beyond
    assert np.all(linear["contact_change"][:, 0] == 0.0)
    assert np.any(np.isfinite(linear["nonlinear_from"]))


def test_paths_agree_with_the_protocol_of_the_paper(datasets) -> None:
    """Dynamics from rest to the force, in place of a path: a different history, nearly the same responses."""
    changes = {"protocol.method": "dynamics", "protocol.ramp_time": 20.0, "loads": []}
    scene = Scene().updated({**PARAMETERS["scene"], **changes})
    pair = study.load_pair(scene, rest_of(scene), 4, (0.2,))
    assert pair.by_motion.all()
    slow = datasets["responses"]["floor_response"].isel(realization=0, distance=1).sel(force=0.2).values
    np.testing.assert_allclose(pair.floor_response[0], slow, atol=0.01 * slow.max())
