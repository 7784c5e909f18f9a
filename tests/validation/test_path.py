"""Quasi-static load paths against slow dynamics, and through loads that are hard to pass."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene
from solved import slab

import granular_response as gr
from granular_response.observe.floor import floor_force
from granular_response.solve import (
    Dynamics,
    NotSettled,
    PathError,
    PathRecord,
    Problem,
    Stop,
    finish,
    follow,
    loaded_states,
    path,
    relax,
    rest_state,
    solve_scene,
)  # fmt: skip
from granular_response.solve.equilibrium import external_force
from granular_response.solve.increment import HASTY, PATIENT, Work, minimise_with_limits, solve_increment
from granular_response.solve.path import LOOSE
from granular_response.solve.settle import settle
from granular_response.solve.system import StaticSystem
from granular_response.solve.timestep import stability_limit
from granular_response.state import OPEN

FLOOR = np.arange(13)


@pytest.fixture(scope="module")
def settled():
    """A small frictional slab at rest, ready to be loaded with unit force."""
    problem = Problem.from_scene(scene(6, 13, loads=[{"disk": "top-centre", "force": [0.0, -1.0]}]))
    rest = rest_state(problem)
    return problem.with_loads(rest.position), rest


def test_dynamics_approaches_the_path_as_its_ramp_grows(settled):
    problem, rest = settled
    force = 8.0
    expected = floor_force(follow(problem, rest, [force])[0], FLOOR)
    difference = []
    for ramp in (5.0, 20.0, 80.0):
        state = finish(problem, relax(Dynamics(problem, rest, time_step=4e-4), Stop(1e-14), load=(0.0, force, ramp)))
        difference.append(np.abs(floor_force(state, FLOOR) - expected).max() / force)
    assert difference[0] < 4e-3
    assert difference[1] < 0.5 * difference[0]
    assert difference[2] < 0.7 * difference[1]


def test_stops_on_the_way_do_not_matter_much(settled):
    problem, rest = settled
    once = follow(problem, rest, [6.0])[0]
    often = follow(problem, rest, [0.5, 1.0, 2.0, 3.5, 5.0, 6.0])
    assert [s.load_factor for s in often] == [0.5, 1.0, 2.0, 3.5, 5.0, 6.0]
    assert floor_force(often[-1], FLOOR) == pytest.approx(floor_force(once, FLOOR), abs=5e-3)


def test_a_path_goes_on_from_one_of_its_states(settled):
    problem, rest = settled
    half = follow(problem, rest, [3.0])[0]
    whole = follow(problem, rest, [3.0, 6.0])[1]
    assert np.array_equal(floor_force(follow(problem, half, [6.0])[0], FLOOR), floor_force(whole, FLOOR))


def test_a_path_back_leads_elsewhere_with_friction_and_back_within_the_reversible_range(settled):
    problem, rest = settled
    up, _, down = follow(problem, rest, [2.0, 4.0, 2.0])
    assert np.abs(floor_force(up, FLOOR) - floor_force(down, FLOOR)).max() > 1e-3
    first, _, again = follow(problem, rest, [1e-4, 2e-4, 1e-4])
    change = np.abs(floor_force(first, FLOOR) - floor_force(rest, FLOOR)).max()
    assert np.abs(floor_force(first, FLOOR) - floor_force(again, FLOOR)).max() < 0.02 * change


@pytest.mark.parametrize("factor", [1.0, 0.0])
def test_an_equilibrium_that_is_left_slowly_is_not_called_stable(factor):
    """A disk balanced on another, displaced by 1e-6, needs seconds to move: a look at once sees it at rest."""
    load = [{"disk": 1, "force": [0.0, -0.1]}]
    problem, state = free_disks([(10.0, 2.0), (10.0, 5.0)], [2.0, 1.0], contact__friction=0.0, loads=load)
    problem = problem.with_loads(state.position)
    balanced = finish(problem, state)
    assert balanced.certificate.negative_modes == 1
    record = PathRecord()
    with pytest.raises(PathError, match="no equilibrium beyond load factor 0"):
        follow(problem, balanced, [factor], record=record)
    assert record.stability_trials >= 1


def test_every_state_is_certified(settled):
    problem, rest = settled
    choice, states = loaded_states(problem, rest, [1.0, 4.0, 9.0])
    assert choice.method == "path"
    for state in states:
        certificate = state.certificate
        assert certificate.force_residual < 1e-9 and certificate.torque_residual < 1e-9
        assert certificate.coulomb_excess < 1e-9
        assert certificate.stable


def test_passes_the_load_where_contacts_begin_to_slide_together():
    """Near 29.3 at friction 0.2 plain Newton iterations chatter; the branch goes on and needs no dynamics."""
    state = slab(0.2, 31.0, "path").loaded[-1]
    assert state.reached.crossings == ()
    assert state.certificate.force_residual < 1e-9
    assert (state.pairs.status == 2).any()


def test_default_increments_are_within_the_aim_of_accuracy(settled):
    """Largest error of the normalised response against a path in far smaller steps."""
    problem, rest = settled
    force = 4.0
    fine = floor_force(follow(problem, rest, [force], longest_step=0.02)[0], FLOOR)
    assert np.abs(floor_force(follow(problem, rest, [force])[0], FLOOR) - fine).max() / force < 1e-4


@pytest.mark.parametrize("friction", [0.05, 0.2, 1.0])
def test_increments_keep_the_tolerance(friction):
    """Responses and open contacts are those of a path in increments of two fifths of the first.

    The estimate is no bound: the tolerance is kept within a factor of two.
    """
    load = [{"disk": "top-centre", "force": [0.0, -1.0]}]
    problem = Problem.from_scene(scene(8, 21, contact__friction=friction, loads=load))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    forces = [4.0, 15.0, 50.0]
    record, short = PathRecord(), PathRecord()
    states = follow(problem, rest, forces, tolerance=1e-5, record=record)
    fine = follow(problem, rest, forces, longest_step=0.4 * path.FIRST_STEP * problem.n**0.5, record=short)
    bottom = np.arange(21)
    for state, other in zip(states, fine, strict=True):
        error = np.abs(floor_force(state, bottom) - floor_force(other, bottom)).max()
        assert error <= 2e-5 * state.load_factor
        assert np.array_equal(state.pairs.status == OPEN, other.pairs.status == OPEN)
        assert state.certificate.stable and state.certificate.force_residual < 1e-10
    assert record.crossings == short.crossings == []
    assert record.comparisons > 0 and record.work.increments < 0.5 * short.work.increments


def _walls(state):
    return np.concatenate([state.walls.normal_force, state.walls.tangential_force])


@pytest.mark.parametrize("tolerance", [1e-5, 3e-6])
def test_a_contact_that_slides_and_stops_within_an_increment_is_seen(tolerance):
    """From 0.843 to 0.864 of the load: one and two increments beyond agree that it never slid, or that it still does.

    Their difference was the estimate, and the error 12 to 14 times the tolerance.
    """
    loads = [{"disk": "top-centre", "force": [0.0134, -0.1184]}]
    rubs = {"normal_stiffness": 1042.1, "stiffness_ratio": 0.8, "friction": 0.011985, "damping_ratio": 0.156}
    slab = {"kind": "slab", "layers": 5, "disks_per_row": 9, "polydispersity": 0.25, "seed": 986}
    slab["lattice_constant"] = 2.0
    wall = {"friction": 2.89, "normal_stiffness": 928.7}
    problem = Problem.from_scene(gr.Scene.from_dict({"packing": slab, "contact": rubs, "wall": wall, "loads": loads}))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    fine, state = (follow(problem, rest, [1.0], **how)[0] for how in ({"longest_step": 5e-4}, {"tolerance": tolerance}))
    assert np.abs(_walls(state) - _walls(fine)).max() <= tolerance * problem.load_size


def test_a_small_load_is_not_crossed_in_one_increment():
    """Of a hundredth of a weight on seven disks the first increment was 0.85, and the response wrong by 7 % of it."""
    loads = [{"disk": "top-centre", "force": [-0.002, -0.0101], "torque": 0.0018}]
    row = {"kind": "slab", "layers": 1, "disks_per_row": 7, "polydispersity": 0.05, "seed": 127}
    row["lattice_constant"] = "touching-largest"
    rubs = {"normal_stiffness": 1941.8, "stiffness_ratio": 0.8, "friction": 0.0}
    described = {"packing": row, "contact": rubs, "loads": loads, "preparation": {"gravity": "frictionless"}}
    described["wall"] = {"friction": 0.709, "normal_stiffness": 7966.0}
    problem = Problem.from_scene(gr.Scene.from_dict(described))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    fine = follow(problem, rest, [0.5, 1.5], longest_step=1e-5)
    for state, other in zip(follow(problem, rest, [0.5, 1.5]), fine, strict=True):
        assert np.abs(_walls(state) - _walls(other)).max() <= 2e-3 * problem.load_size * state.load_factor


def test_a_looser_tolerance_takes_longer_increments_and_is_kept():
    load = [{"disk": "top-centre", "force": [0.0, -1.0]}]
    problem = Problem.from_scene(scene(8, 21, contact__friction=1.0, loads=load))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    strict, loose = PathRecord(), PathRecord()
    bottom = np.arange(21)
    near = floor_force(follow(problem, rest, [30.0], tolerance=1e-5, record=strict)[0], bottom)
    state = follow(problem, rest, [30.0], tolerance=1e-4, record=loose)[0]
    assert np.abs(floor_force(state, bottom) - near).max() < 1e-4 * 30.0
    assert state.certificate.stable
    assert loose.work.increments < 0.8 * strict.work.increments


def test_a_smaller_tolerance_takes_shorter_increments_and_leaves_less(settled):
    problem, rest = settled
    fine = floor_force(follow(problem, rest, [4.0], longest_step=0.002)[0], FLOOR)
    errors, increments = [], []
    for tolerance in (1e-5, 1e-6):
        record = PathRecord()
        state = follow(problem, rest, [4.0], tolerance=tolerance, record=record)[0]
        errors.append(np.abs(floor_force(state, FLOOR) - fine).max() / 4.0)
        increments.append(record.work.increments)
    assert errors[0] < 2e-5 and errors[1] < 2e-6
    assert increments[1] > increments[0]


def test_a_stretch_that_costs_too_much_is_left_to_dynamics(settled, monkeypatch):
    problem, rest = settled
    monkeypatch.setattr(path, "MOST_WORK", 2)
    record = PathRecord()
    state = follow(problem, rest, [2.0], record=record)[0]
    assert {c.reason for c in record.crossings} == {"too much work"}
    assert record.crossings[-1].end <= 2.0 and state.load_factor == 2.0
    assert state.certificate.force_residual < 1e-9


def test_only_the_shortest_increment_has_patience_before_dynamics_takes_over(settled, monkeypatch):
    problem, rest = settled
    asked = []

    def fails(*args, patience, **options):
        asked.append(patience)
        return None if len(asked) <= 3 else solve_increment(*args, patience=patience, **options)

    monkeypatch.setattr(path, "solve_increment", fails)
    record = PathRecord()
    follow(problem, rest, [1.0], longest_step=0.2, record=record)
    assert asked[:4] == [HASTY, HASTY, PATIENT, HASTY]
    assert record.crossings[0].reason == "no equilibrium" and record.crossings[0].start == 0.0


def test_a_state_that_leaves_in_one_sense_alone_is_left_in_its_mirror_image_too():
    """With sliding contacts the tangent is that of one sense: it was tried, the other one was not."""
    peaks = []
    for sense, offset in ((1.0, 0), (-1.0, 1)):
        load = {"disk": {"row": "top", "offset": offset}, "force": [sense * 2.0641953231117673, -40.0]}
        solution = solve_scene(
            scene(
                5, 6, packing__lattice_constant=2.01, contact__friction=1.0, loads=[load], protocol__method="path",
                protocol__time_step="auto",
            ),
            load_factors=[0.594866],
        )  # fmt: skip
        (state,) = solution.loaded
        assert [crossing.reason for crossing in state.reached.crossings] == ["unstable"]
        assert state.certificate.stable
        added = floor_force(state, np.arange(6)) - floor_force(solution.rest, np.arange(6))
        peaks.append(added if sense > 0 else added[::-1])
    np.testing.assert_allclose(peaks[0], peaks[1], atol=1e-6)


@pytest.fixture(scope="module")
def slippery():
    """A slab with so little friction that increments are dear, at rest, ready to be loaded with unit force."""
    load = [{"disk": "top-centre", "force": [0.0, -1.0]}]
    problem = Problem.from_scene(scene(10, 25, contact__friction=0.05, loads=load))
    rest = rest_state(problem)
    return problem.with_loads(rest.position), rest


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_dynamics_takes_the_rest_of_the_way_where_it_is_cheaper_at_the_tolerance(slippery, tolerance):
    problem, rest = slippery
    force, bottom, record = 40.0, np.arange(25), PathRecord()
    state = follow(problem, rest, [force], tolerance=tolerance, record=record)[0]
    fine = follow(problem, rest, [force], tolerance=1e-5)[0]
    assert [(crossing.reason, crossing.end) for crossing in record.crossings] == [("too much work", force)]
    assert np.abs(floor_force(state, bottom) - floor_force(fine, bottom)).max() < tolerance * force
    assert state.certificate.stable and state.certificate.force_residual < 1e-10


def test_at_a_tight_tolerance_the_path_keeps_to_statics(slippery):
    """However dear: a ramp may leave a symmetric branch, for another one some hundredths of the load away."""
    problem, rest = slippery
    for part, leaves in ((1.0, True), (0.99, False)):
        record = PathRecord()
        follow(problem, rest, [15.0], tolerance=part * LOOSE, record=record)
        assert ("too much work" in {crossing.reason for crossing in record.crossings}) == leaves


@pytest.mark.parametrize(("ratio", "left"), [(0.5, 0.125), (0.125, 0.125), (0.05, 0.05)])
def test_where_dynamics_takes_the_rest_disks_move_like_rings_with_few_dashpots(slippery, monkeypatch, ratio, left):
    """Neither matters to where a slow ramp ends, and the step is longer; what is at rest is at rest for both."""
    seen = []

    def recorded(problem, *arguments, **options):
        seen.append((problem, options["time_step"]))
        return settle(problem, *arguments, **options)

    monkeypatch.setattr(path, "settle", recorded)
    problem, rest = slippery
    problem = replace(problem, scene=problem.scene.updated({"contact.damping_ratio": ratio}))
    follow(problem, rest, [40.0], tolerance=1e-2)
    (moving, step), *_ = seen
    dashpots = [2.0 * left * np.sqrt(k) for k in (problem.stiffness, problem.pair_law.tangential_stiffness)]
    assert moving.rings and np.array_equal(moving.weight, problem.weight)
    assert [moving.pair_law.normal_damping, moving.pair_law.tangential_damping] == pytest.approx(dashpots)
    assert moving.pair_law.friction == problem.pair_law.friction and moving.stiffness == problem.stiffness
    assert step == pytest.approx(0.9 * stability_limit(moving, "leapfrog"))


def test_a_path_that_left_the_rest_to_dynamics_goes_on_as_if_it_had_not_been_cut(slippery):
    problem, rest = slippery
    whole = follow(problem, rest, [40.0, 30.0, 45.0], tolerance=1e-2)
    assert all(state.reached.crossings for state in whole)
    cut = follow(problem, whole[0], [30.0, 45.0], tolerance=1e-2)
    for state, other in zip(cut, whole[1:], strict=True):
        assert np.array_equal(state.position, other.position)


def test_statics_goes_on_where_dynamics_that_is_cheaper_does_not_settle(slippery, monkeypatch):
    problem, rest = slippery
    asked = []

    def never(*arguments, **options):
        asked.append(options["what"])
        raise NotSettled("the packing did not come to rest")

    monkeypatch.setattr(path, "settle", never)
    record = PathRecord()
    state = follow(problem, rest, [8.0], tolerance=1e-2, record=record)[0]
    assert asked == ["load factor 8"] and record.crossings == []
    fine = follow(problem, rest, [8.0], tolerance=1e-5)[0]
    assert np.abs(_walls(state) - _walls(fine)).max() < 1e-2 * 8.0 and state.certificate.stable


def test_small_packings_are_not_left_to_dynamics(settled):
    """Single disks swing more slowly than a wave crosses them, so the ramp would be too short."""
    small, _ = settled
    problem = Problem.from_scene(scene(6, 13, contact__friction=0.05, loads=[{"disk": "top-centre", "force": [0, -1]}]))
    assert problem.n < path.MANY and small.n == problem.n
    rest = rest_state(problem)
    assert follow(problem.with_loads(rest.position), rest, [40.0], tolerance=1e-2)[0].reached.crossings == ()


def test_fixed_limits_have_the_same_minimum_by_factorisations_brought_up_to_date(slippery):
    problem, rest = slippery
    ends, made = [], []
    for updated in (False, True):
        system = StaticSystem(problem, rest, updated=updated)
        known, work = system.start(rest), Work()
        here = system.trial(known, known.q)
        limits = (0.05 * here.pair_normal, 0.0 * here.wall_normal)
        force = external_force(problem, 3.0)
        found = minimise_with_limits(system, known, force, known.q, limits, work, PATIENT.steps)
        assert np.abs(found.contact_force + force).max() < 1e-5
        ends.append(found.configuration.q)
        made.append(work.factorisations)
    assert np.abs(ends[0] - ends[1]).max() < 1e-7 * np.abs(ends[0]).max() + 1e-9
    assert made[1] <= made[0]
