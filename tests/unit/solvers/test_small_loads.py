"""The influence of every disk on the floor against the answer to one small load after another."""

import numpy as np
import pytest
from refusals import refuses
from small_scenes import scene

import granular_response as gr
from granular_response.errors import EquilibriumError
from granular_response.observe.difference import pair_force_difference, wall_force_difference
from granular_response.observe.floor import floor_disks, floor_response
from granular_response.scene import Scene
from granular_response.solvers.small_loads import added_forces, force_on, influence, sticking
from granular_response.solvers.solution import solve_scene

SMALL = np.array([3e-5, -1e-4, 2e-5])
CASES = {
    "ordered, frictionless": {"contact.friction": 0.0, "wall.friction": 0.0},
    "ordered": {"preparation.gravity": "frictionless"},
    "disordered": {"packing.polydispersity": 0.1, "packing.lattice_constant": "touching-largest"},
    "3/2 law": {"contact.law": "hertz", "preparation.gravity": "frictionless"},
    "periodic": {"packing.sides": "periodic", "packing.lattice_constant": 1.999, "preparation.gravity": "frictionless"},
}


def described(changes, disk, load) -> Scene:
    loads = [{"disk": disk, "force": list(load[:2]), "torque": float(load[2])}]
    return scene(6, 15, wall__friction=0.2, protocol__time_step="auto", loads=loads).updated(changes)


@pytest.mark.parametrize("disk", [19, 80])
@pytest.mark.parametrize("changes", CASES.values(), ids=CASES)
def test_it_is_the_answer_to_a_small_load(changes, disk):
    turns = changes.get("contact.friction", 0.2) > 0.0
    solution = solve_scene(described(changes, disk, SMALL * [1.0, 1.0, float(turns)]))
    rest, loaded = solution.rest, solution.loaded[0]
    disks = floor_disks([rest, loaded])
    found = influence(solution.problem, rest, disks)
    assert found.shape == (len(disks), solution.problem.n, 3 if turns else 2)
    size = float(np.hypot(*SMALL[:2]))
    expected = floor_response(rest, loaded, disks, size)
    assert found[:, disk] @ SMALL[: found.shape[2]] / size == pytest.approx(expected, abs=1e-6)
    assert np.abs(expected).max() > 0.1


def test_without_friction_of_the_walls_the_floor_bears_every_force():
    changes = {"wall.friction": 0.0, "preparation.gravity": "frictionless"}
    solution = solve_scene(described(changes, 80, SMALL))
    found = influence(solution.problem, solution.rest, floor_disks([solution.rest]))
    assert found[:, :, 1].sum(axis=0) == pytest.approx(-1.0, abs=1e-8)
    assert found[:, :, 0].sum(axis=0) == pytest.approx(0.0, abs=1e-8)


def test_contacts_at_the_limit_are_refused_unless_they_shall_stick():
    changes = {"contact.friction": 0.1, "preparation.gravity": "frictionless", "loads.0.force": [0.0, -20.0]}
    solution = solve_scene(described(changes, 80, [0.0, 0.0, 0.0]))
    state = solution.loaded[0]
    disks = floor_disks([solution.rest, state])
    refuses(EquilibriumError, r"^\d+ contacts are at the Coulomb limit", influence, solution.problem, state, disks)
    assert np.isfinite(influence(solution.problem, state, disks, sliding="stick")).all()
    with pytest.raises(ValueError, match=r"sliding = 'slip': must be refuse or stick"):
        influence(solution.problem, state, disks, sliding="slip")


def test_nothing_holds_a_periodic_slab_on_a_smooth_floor_along_x():
    changes = CASES["periodic"] | {"wall.friction": 0.0}
    solution = solve_scene(described(changes, 80, [0.0, -1e-4, 0.0]))
    found = influence(solution.problem, solution.rest, floor_disks([solution.rest]))
    assert np.isnan(found[:, :, 0]).all() and np.isfinite(found[:, :, 1]).all()


def test_an_unknown_that_a_load_holds_adds_nothing():
    load = [{"disk": "top-centre", "displacement": [None, -1e-4]}]
    solution = solve_scene(described({}, 80, SMALL).updated({"loads": load}))
    found = influence(solution.problem, solution.loaded[0], floor_disks([solution.rest]), sliding="stick")
    disk = int(solution.problem.load_disk[0])
    assert (found[:, disk, 1] == 0.0).all() and np.abs(found[:, disk, 0]).max() > 0.01


def test_what_is_not_certified_is_refused():
    scene = described({"protocol.static_finish": False, "protocol.stop_kinetic_energy": 1e-6}, 80, [0.0, 0.0, 0.0])
    solution = solve_scene(scene.updated({"loads": []}))
    with pytest.raises(EquilibriumError, match="not certified as stable"):
        influence(solution.problem, solution.rest, floor_disks([solution.rest]))


def test_a_result_has_it_labelled_and_a_stored_one_too(tmp_path):
    result = gr.solve(described({"preparation.gravity": "frictionless"}, 80, SMALL))
    found = result.influence(state=0)
    response = result.floor_response.values[-1] * float(np.hypot(*SMALL[:2]))
    one = found.isel(disk=80).values @ SMALL
    assert one == pytest.approx(response, abs=1e-9)
    assert list(found["component"].values) == ["x", "z", "torque"]
    assert float(found["disk_x"][80]) == pytest.approx(0.0, abs=1e-12)
    result.save(tmp_path / "r.nc")
    assert np.array_equal(gr.open_result(tmp_path / "r.nc").influence(state=0).values, found.values)
    refuses(IndexError, "state = 7", result.influence, state=7)


@pytest.mark.parametrize("changes", CASES.values(), ids=CASES)
def test_every_contact_answers_as_to_a_small_load(changes):
    solution = solve_scene(described(changes, 80, [0.0, -1e-4, 0.0]))
    rest, loaded = solution.rest, solution.loaded[0]
    system, trial = sticking(solution.problem, rest, "refuse")
    down = force_on(solution.problem, 80, 1, -1.0)
    pairs, walls = added_forces(system, trial, system.answers(trial)(down))
    assert pairs == pytest.approx(pair_force_difference(rest, loaded) / 1e-4, abs=1e-4)
    assert walls == pytest.approx(wall_force_difference(rest, loaded) / 1e-4, abs=1e-4)
    assert np.abs(pairs).max() > 0.1


def test_a_displacement_holds_a_periodic_packing_along_x():
    loads = [{"disk": "top-centre", "displacement": [0.0, None]}]
    changes = {"packing.layers": 4, "packing.disks_per_row": 7, "packing.sides": "periodic", "contact.friction": 0.0}
    changes["packing.lattice_constant"] = 1.999  # pressed together, so that small forces open no contact
    free = gr.solve(Scene().updated(changes)).influence().sel(component="x")
    assert np.isnan(free).all()
    scene = Scene().updated({**changes, "loads": loads})
    result = gr.solve(scene)
    size, disk = 1e-5, 10
    more = gr.solve(scene.updated({"loads": [*loads, {"disk": disk, "force": [size, 0.0]}]}))
    forces = [one.to_dataset()["floor_force"].values[-1] for one in (result, more)]
    found = result.influence().sel(component="x").isel(disk=disk)
    np.testing.assert_allclose(found, (forces[1] - forces[0]) / size, atol=1e-4)
