"""Periodic sides: every place is like every other."""

import numpy as np
import pytest

import granular_response as gr
from granular_response.observe import network
from granular_response.observe.floor import floor_disks, floor_force, smoothed_response
from granular_response.observe.profile import force_profile
from granular_response.observe.stress import (
    coarse_grained_stress,
    contact_forces,
    grid_points,
    line_forces,
    line_stress,
)
from granular_response.observe.teardrop import open_region
from granular_response.scene import Scene
from granular_response.solvers.close_pairs import close_pairs
from granular_response.solvers.solution import solve_scene

LAYERS, ROW = 7, 24


def slab(disk, force=4.0, **changes) -> Scene:
    # pressed together along x: where equal disks just touch, rounding decides which of their contacts are open
    packing = {"kind": "slab", "layers": LAYERS, "disks_per_row": ROW, "sides": "periodic", "lattice_constant": 1.9995}
    loads = [{"disk": disk, "force": [0.0, -force]}]
    return Scene.from_dict({"packing": packing, "loads": loads}).updated(changes)


def floor_response(scene: Scene) -> np.ndarray:
    """Added floor forces in the order of the bottom row."""
    solution = solve_scene(scene)
    state = solution.loaded[-1]
    assert state.reached.certificate.stable and state.reached.certificate.force_residual < 1e-9
    disks = floor_disks([solution.rest], np.arange(ROW))
    assert np.array_equal(np.sort(disks), np.arange(ROW))
    rest, loaded = floor_force(solution.rest, np.arange(ROW)), floor_force(state, np.arange(ROW))
    assert loaded.sum() - rest.sum() == pytest.approx(4.0, abs=1e-8)
    return loaded - rest


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_the_response_is_the_same_one_wherever_the_load_is(friction, law):
    top = (LAYERS - 1) * ROW
    changes = {"contact.friction": friction, "contact.law": law}
    first = floor_response(slab(top + 3, **changes))
    assert first.max() > 0.2
    for column in (0, 11, ROW - 1):
        other = floor_response(slab(top + column, **changes))
        assert np.roll(first, column - 3) == pytest.approx(other, abs=1e-10)


def test_neighbours_across_the_sides():
    """Six in the bulk, four at the floor and on top; the search finds those of the lattice."""
    packing = slab("top-centre").packing.build()
    pairs = packing.neighbour_pairs()
    count = np.bincount(pairs.ravel(), minlength=packing.n).reshape(LAYERS, ROW)
    assert (count[1:-1] == 6).all() and (count[[0, -1]] == 4).all()
    shifted = packing.position + np.array([31.7, 0.0])  # positions are not wrapped
    for position in (packing.position, shifted):
        found = close_pairs(position, packing.radius, 0.1, packing.box.period)
        assert np.array_equal(np.stack(found, axis=1), pairs)


def test_forces_across_a_line_and_their_stress_are_those_of_one_period():
    small = {"packing.layers": 5, "packing.disks_per_row": 8, "packing.sides": "periodic", "wall.friction": 0.3}
    solution = solve_scene(Scene().updated(small))
    forces = contact_forces(solution.rest)
    assert line_forces(forces, 0.5)[1].sum() == pytest.approx(solution.problem.n)  # the weight above
    width = solution.rest.box.width
    x = np.linspace(0.0, width, 161)[:-1]
    for smooth in (2.0, 8.0):  # wider than the box at last
        line = line_stress(forces, 0.5, x, smooth)
        assert line.mean() * width == pytest.approx(solution.problem.n)
        np.testing.assert_allclose(line, line_stress(forces, 0.5, x + width, smooth), atol=1e-10)
        area = coarse_grained_stress(forces, grid_points(x, np.array([4.0])), smooth)
        again = coarse_grained_stress(forces, grid_points(x - 3 * width, np.array([4.0])), smooth)
        np.testing.assert_allclose(area, again, atol=1e-10)
        assert area == pytest.approx(np.roll(area, 20, axis=1), abs=1e-6)  # of a lattice: by one disk


def test_what_is_measured_of_contacts_does_not_depend_on_where_the_side_is():
    found = []
    for offset in (0, -5, -10, 10):
        load = {"disk": {"row": "top", "offset": offset}, "force": [0.0, -40.0]}
        size = {"packing.layers": 8, "packing.disks_per_row": 21}
        solution = solve_scene(slab(0, **size, **{"contact.friction": 0.0, "loads": [load]}))
        disk = int(solution.problem.load_disk[0])
        opened = network.opened(solution.rest.pairs, solution.loaded[0].pairs)
        region = open_region(solution.rest, opened, solution.rest.position[disk])
        profile = force_profile(solution.rest, solution.loaded[0], disk, 2.5 * 3**0.5)
        inside = np.abs(profile[0]) < 20.0  # those half a box away are on either side
        found.append((int(region.contacts.sum()), region.width, region.depth, *(part[inside] for part in profile)))
    assert found[0][0] > 5
    for other in found[1:]:
        for one, value in zip(found[0], other, strict=True):
            np.testing.assert_allclose(value, one, atol=1e-4)


def test_the_response_at_a_place_counts_images():
    """The nearest floor disk and the Gaussian go across the sides: a period further on is the same place."""
    result = gr.solve(slab("top-centre"), progress=False)
    period, x = result.rest.box.width, result.floor_response["x"].values
    assert result.response_at(period).identical(result.response_at(0.0))
    copies = np.add.outer(period * np.arange(-3, 4), x).ravel()
    expected = smoothed_response([0.5 * period], copies, np.tile(result.floor_response.values, 7), 2.0)[:, 0]
    assert result.response_at(0.5 * period, smooth=2.0).values == pytest.approx(expected, rel=1e-12)
    assert result.response_at(-0.5 * period, smooth=2.0).values == pytest.approx(expected, rel=1e-12)
