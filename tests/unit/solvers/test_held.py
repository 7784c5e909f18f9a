"""Displacement-controlled loads: disks that are moved and held, and the force that this takes."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from printed import shown
from small_scenes import free_disks, scene
from stress.random_scenes import check, contradiction, rounding_of

import granular_response as gr
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Scene, SceneError
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.equilibrium import certify, reaction
from granular_response.solvers.path import PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state, solve_scene
from granular_response.solvers.work import slid, stored, work


def pushed(displacement, **changes) -> Scene:
    return scene(4, 9, loads=[{"disk": "top-centre", "displacement": displacement}], **changes)


def travel(solution, state) -> np.ndarray:
    """Displacement of the first loaded disk since rest."""
    disk = int(solution.problem.load_disk[0])
    return state.position[disk] - solution.rest.position[disk]


def check_audit(solution) -> None:
    """Every state is in balance, reactions included, as summed anew from its positions."""
    for state in (solution.rest, *solution.loaded):
        assert contradiction(state, check(solution, state), rounding_of(solution)) == ""
        assert state.certificate.force_residual < 1e-9


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("displacement", [[None, -4e-4], [0.0, -4e-4], [2e-4, None], [2e-4, -4e-4]])
def test_force_and_displacement_lead_to_one_state(friction, displacement):
    """Moving a disk takes the reaction, and the reaction moves the disk there."""
    moving = Problem.from_scene(pushed(displacement, contact__friction=friction))
    rest = rest_state(moving)
    moving = moving.with_loads(rest.position)
    disk = int(moving.load_disk[0])
    # a force in one direction can follow how the reaction grows
    factors = [0.25, 0.5, 1.0] if None in displacement else [1.0]
    record = PathRecord()
    moved = follow(moving, rest, factors, together=10.0, record=record)
    assert not any(event.lost for event in record.events)
    forces = [reaction(moving, state)[0] for state in moved]
    free = [part is None for part in displacement]
    assert np.hypot(*forces[-1]) > 0.05 and not forces[-1][free].any()

    force = forces[-1]
    load = [{"disk": disk, "force": force.tolist()}]
    forcing = Problem.from_scene(moving.scene.updated({"loads": load})).with_loads(rest.position)
    for state, other, factor in zip(
        moved, follow(forcing, rest, [float(f @ force / (force @ force)) for f in forces], together=10.0), factors,
        strict=True,
    ):  # fmt: skip
        wanted = [factor * (part or 0.0) for part in displacement]
        there, too = (one.position[disk] - rest.position[disk] for one in (state, other))
        assert there[~np.array(free)] == pytest.approx(np.array(wanted)[~np.array(free)], abs=1e-14)
        assert too == pytest.approx(there, abs=1e-8)
        assert np.abs(other.position - state.position).max() < 1e-8
        assert state.certificate.stable and state.certificate.force_residual < 1e-10


@pytest.mark.parametrize(
    ("friction", "changes"),
    [
        (0.2, {}),
        (0.2, {"contact.law": "hertz"}),
        (0.2, {"packing.sides": "periodic"}),
        (0.2, {"packing.polydispersity": 0.1, "protocol.method": "path"}),
        (0.0, {"protocol.method": "path"}),
        (0.0, {"packing.polydispersity": 0.1}),
        (0.0, {"packing.sides": "periodic", "packing.lattice_constant": 1.9998}),
    ],
)
def test_a_programme_of_displacements_by_every_method(friction, changes):
    base = pushed([0.0, -1e-3], contact__friction=friction).updated(changes)
    solution = solve_scene(base, load_factors=[0.5, 1.0, 0.0])
    check_audit(solution)
    by_motion = base.updated({"protocol.method": "dynamics", "protocol.stop_kinetic_energy": 1e-10})
    slow = solve_scene(by_motion, load_factors=[0.5, 1.0, 0.0])
    check_audit(slow)
    for state, other in zip(solution.loaded, slow.loaded, strict=True):
        assert travel(solution, state) == pytest.approx([0.0, -1e-3 * state.load_factor], abs=1e-14)
        assert travel(slow, other) == pytest.approx(travel(solution, state), abs=1e-11)
    up, down = (solution.reaction(state)[0, 1] for state in solution.loaded[:2])
    assert down < up < -0.2
    for state, other in zip(solution.loaded[:2], slow.loaded[:2], strict=True):
        assert slow.reaction(other) == pytest.approx(solution.reaction(state), rel=0.02, abs=0.02)


@pytest.mark.parametrize("method", ["auto", "path", "dynamics"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_one_disk_on_the_floor_has_the_closed_form(method, friction):
    """The floor pushes back with its stiffness; a disk that is lifted off the floor weighs what it weighs."""
    rubs, load = {"friction": friction}, {"disk": 0, "displacement": [0.0, -0.01]}
    one = {"packing": {"kind": "pile", "layers": 1}, "contact": rubs, "wall": rubs, "loads": [load]}
    scene = Scene.from_dict({**one, "protocol": {"method": method}})
    stiffness = scene.resolved_wall.normal_stiffness
    solution = solve_scene(scene, load_factors=[1.0, -1.0])
    pressed, lifted = (solution.reaction(state)[0] for state in solution.loaded)
    assert pressed == pytest.approx([0.0, -0.01 * stiffness], abs=1e-9)
    assert lifted == pytest.approx([0.0, 1.0], abs=1e-12)
    assert not solution.loaded[1].walls.touching.any()


def test_a_disk_dragged_over_a_rough_floor_rolls():
    alone, state = free_disks([(10.0, 1.0)], wall__friction=0.3, loads=[{"disk": 0, "displacement": [0.2, None]}])
    problem = alone.with_loads(state.position)
    start = rest_state(alone)
    (rolled,) = follow(problem, start, [1.0])
    assert reaction(problem, rolled)[0] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert rolled.angle[0] == pytest.approx(-0.2, abs=1e-9)


def test_a_displaced_disk_that_is_not_where_it_is_held_shows_in_the_certificate():
    solution = solve_scene(pushed([None, -1e-3], contact__friction=0.2))
    (state,) = solution.loaded
    assert state.certificate.force_residual < 1e-10
    wrong = certify(solution.problem, replace(state, load_factor=0.5))
    assert wrong.force_residual == pytest.approx(5e-4 * solution.problem.stiffness, rel=1e-6)


@pytest.mark.parametrize("integrator", sorted(INTEGRATORS))
def test_dynamics_moves_a_held_disk_at_a_constant_rate_and_stops_it(integrator):
    solution = solve_scene(pushed([1e-3, -2e-3], contact__friction=0.2), load_factors=[0.0])
    problem, disk = solution.problem, int(solution.problem.load_disk[0])
    dynamics = Dynamics(problem, solution.rest, integrator, 3e-4)
    dynamics.set_ramps(load=(0.0, 2.0, 0.1))  # 333 steps and a third
    start = solution.rest.position[disk]
    for steps in (100, 200, 100, 100):
        dynamics.advance(steps)
        done = min(dynamics.time / 0.1, 1.0)
        assert dynamics.position[disk] - start == pytest.approx([2e-3 * done, -4e-3 * done], abs=1e-13)
    assert not dynamics.v[[disk, problem.n + disk]].any()
    assert dynamics.state().load_factor == 2.0 and np.isfinite(dynamics.kinetic_energy())


def test_a_displaced_disk_and_a_force_act_together():
    """A disk that is held where it is carries what a force on another one brings to it."""
    loads = [{"disk": "top-centre", "displacement": [0.0, 0.0]}, {"disk": {"row": 1}, "force": [0.3, -3.0]}]
    solution = solve_scene(scene(4, 9, contact__friction=0.2, loads=loads))
    check_audit(solution)
    held, free = solution.reaction(solution.loaded[0])
    assert not free.any() and held.any()
    assert travel(solution, solution.loaded[0]) == pytest.approx([0.0, 0.0], abs=1e-14)
    assert solution.applied_force(solution.loaded[0]) == pytest.approx(np.hypot(0.3, 3.0) + np.hypot(*held))


def test_a_file_has_the_reaction(tmp_path):
    base = pushed([None, -1e-3], contact__friction=0.2)
    whole = solve_scene(base, load_factors=[0.5, 1.0, 0.25])
    result = gr.solve(base, load_factors=[0.5, 1.0, 0.25])
    result.save(tmp_path / "whole.nc")
    stored = gr.open_result(tmp_path / "whole.nc")
    assert stored.reaction.dims == ("load", "load_point", "axis")
    assert np.array_equal(stored.reaction.values, [whole.reaction(state) for state in whole.loaded])
    assert float(stored.reaction.sel(load=0.25, axis="z").squeeze()) == whole.reaction(whole.loaded[2])[0, 1]
    forces = np.abs(stored.reaction.sel(axis="z").values[:, 0])
    assert stored.to_dataset()["total_force"].values == pytest.approx(forces)
    assert stored.floor_response.sum("floor_disk").values == pytest.approx(np.ones(3), abs=1e-8)
    said = shown(tmp_path / "whole.nc")
    assert "force that holds displaced disks" in said and f"{whole.reaction(whole.loaded[1])[0, 1]:.6g}" in said
    for what in (gr.plot.packing, gr.plot.forces):
        what(stored)
    with pytest.raises(ValueError, match="reaction: there is none, no load of this scene has a displacement"):
        _ = gr.solve(scene(3, 7)).reaction


def test_two_loads_cannot_hold_one_coordinate():
    twice = [{"disk": "top-centre", "displacement": [None, -1e-3]}, {"disk": 31, "displacement": [0.0, -2e-3]}]
    with pytest.raises(SceneError, match=r"^loads\[1\]\.displacement: moves disk \d+ along z, and so does loads\[0\]"):
        solve_scene(scene(4, 9, loads=[{**one, "disk": 31} for one in twice]))
    apart = [{"disk": 31, "displacement": [None, -1e-4]}, {"disk": 31, "displacement": [1e-4, None]}]
    both = solve_scene(scene(4, 9, loads=apart, contact__friction=0.2))
    assert travel(both, both.loaded[0]) == pytest.approx([1e-4, -1e-4], abs=1e-14)


def of_disks(disks, *, loads, friction, sides="walls", width, **more) -> gr.Result:
    """Disks (x, z, radius of each), solved."""
    rubs = {"contact": {"friction": friction}, "wall": {"friction": friction}}
    scene = {"loads": loads, **rubs, **more}
    return gr.solve(Scene.from_arrays(*np.transpose(disks), width=width, sides=sides, scene=scene))


#: Where the path fails: one increment as long as the way leads through a disk, or thousands that lead nowhere.
@pytest.mark.parametrize(
    ("method", "friction", "other", "way"),
    [
        ("auto", 0.0, 6.0, 8.0),
        ("auto", 0.0, 4.3, 5.0),
        *(("path", friction, other, way) for friction in (0.0, 0.5) for other, way in ((6.0, 8.0), (4.3, 5.0))),
    ],
)
def test_a_displaced_disk_pushes_what_is_on_its_way(other, way, friction, method):
    result = of_disks(
        [(2, 1, 1), (other, 1, 1)], width=20.0, friction=friction, protocol={"method": method},
        loads=[{"disk": 0, "displacement": [way, None]}],
    )  # fmt: skip
    first, second = result.loaded[-1].position[:, 0]
    assert first == pytest.approx(2.0 + way)
    assert second > first + 2.0 - 1e-3  # in front of it, or rolled on


@pytest.mark.parametrize("method", ["path", "dynamics"])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_two_disks_may_meet_across_a_side_after_they_were_neighbours_within(friction, method):
    loads = [{"disk": 0, "displacement": [-0.9, None]}, {"disk": 1, "displacement": [0.0, None]}]
    result = of_disks(
        [(0.01, 1, 1), (2.56, 1, 1)], width=5.3, sides="periodic", friction=friction, loads=loads,
        protocol={"method": method},
    )  # fmt: skip
    pressed = 3000.0 * (2.0 - (5.3 - 2.55 - 0.9))  # k_N times the overlap across the side
    assert result.reaction.values[-1, :, 0] == pytest.approx([-pressed, pressed], abs=0.5)


def test_a_path_finds_contacts_that_the_list_of_the_fall_has_not():
    radius, off = 0.92, 0.22
    z = 1.0 + ((1.0 + radius) ** 2 - (1.0 - off) ** 2) ** 0.5
    disks = [(1, 1, 1), (3, 1, 1), (5, 1, 1), (2 - off, z, radius), (4 + off, z, radius)]
    loads = [{"disk": 3, "displacement": [0.098, 0.065]}, {"disk": 4, "displacement": [-0.098, 0.065]}]
    result = of_disks(
        disks, width=6.0, friction=0.5, loads=loads, preparation={"gravity": "slow"},
        protocol={"method": "path", "maximum_steps": 600_000},
    )  # fmt: skip
    last = result.loaded[-1]
    reach = 2.0 * result.to_dataset()["radius"].values[3]
    overlap = reach - np.hypot(*(last.position[3] - last.position[4]))
    assert overlap > 0.01
    listed = {(i, j): f for i, j, f in zip(last.pairs.first, last.pairs.second, last.pairs.normal_force, strict=True)}
    assert listed[3, 4] == pytest.approx(3000.0 * overlap, rel=1e-6)


def test_the_work_of_displaced_disks_is_stored_or_has_slid():
    solution = solve_scene(
        pushed([0.0005, -0.001], contact__friction=0.2, protocol__method="path"),
        load_factors=[*np.linspace(0.0, 1.0, 101)[1:], *np.linspace(1.0, 0.2, 81)[1:]],
    )
    problem, states = solution.problem, [solution.rest, *solution.loaded]
    assert not any(event.lost for state in states for event in state.reached.events)
    done = sum(work(problem, *two) for two in pairwise(states))
    lost = sum(slid(problem, *two).total for two in pairwise(states))
    kept = stored(problem, states[-1]) - stored(problem, states[0])
    assert lost > 1e-5
    assert done == pytest.approx(kept + lost, rel=2e-3)
