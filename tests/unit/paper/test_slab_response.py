"""What is stored of slabs under a growing force, as datasets."""

import numpy as np
import pytest
from small_scenes import scene

from granular_response.state import OPEN, SLIDING, STICKING
from granular_response.studies import LoadPath, Measures, happenings
from granular_response_paper.groups.symmetry_breaking import simulate as copies
from granular_response_paper.slab_response import (
    locate,
    measured,
    measured_dataset,
    states_picture,
)


@pytest.fixture(scope="module")
def path():
    return LoadPath.of(scene(5, 17, contact__friction=0.0, loads=[{"disk": "top-centre", "force": [0.0, -1.0]}]))


def test_events_are_located_with_their_friction_and_definition(path):
    forces = [0.1, 1.0, 4.0]
    asked = happenings(Measures(path), path.through(forces)[0], 0.2)
    found = locate(path, forces, asked, 0.1)
    assert [event.name for event in found] == list(asked) and {event.friction for event in found} == {0.0}
    assert [event.definition for event in found] == [what.definition for what in asked.values()]
    assert found[0].low < found[0].high <= 4.0


def test_measurements_are_spread_over_a_grid(path):
    measures = Measures(path)
    states = path.through([0.1, 0.2, 0.3])
    both, one = measured(measures, states[:2]), measured(measures, states[2:])
    grid = measured_dataset(("a", "b"), [((0, [0, 2]), both), ((1, [1]), one)], (2, 3))
    centre = grid["response_at_centre"].values
    np.testing.assert_array_equal(np.isnan(centre), [[False, True, False], [True, False, True]])
    assert centre[0, 2] == measures.centre(states[1])
    np.testing.assert_array_equal(grid["floor_response"].values[1, 1], measures.response(states[2]))
    np.testing.assert_array_equal(both.isel(state=[1])["floor_response"][0], both["floor_response"][1])
    assert grid["certificate_force_residual"].values[0, 0] < 1e-9


def test_pictures_keep_what_they_need(path):
    states = [path.rest, path.at(0.3)]
    picture = states_picture(states, path.problem)
    assert picture["force"].values.tolist() == [0.0, 0.3]
    np.testing.assert_array_equal(picture["position"].values[1], states[1].position)
    assert int(picture["loaded_disk"]) == path.problem.load_disk[0]
    assert set(np.unique(picture["contact_status"])) <= {OPEN, STICKING, SLIDING}


def test_copies_of_a_packing_are_the_same_packing():
    packing = scene(4, 7).packing.build()
    image = copies.mirrored(packing)
    np.testing.assert_array_equal(np.sort(image.position, axis=0), np.sort(packing.position, axis=0))
    np.testing.assert_array_equal(image.position[0], packing.position[6])

    shift = np.zeros((packing.n, 2))
    shift[0] = [1e-3, 2e-3]
    moved = copies.displaced(packing, shift, mirror_image=True)
    np.testing.assert_allclose(moved.position[6] - packing.position[6], [-1e-3, 2e-3], atol=1e-15)
    np.testing.assert_array_equal(moved.position[:6], packing.position[:6])
