"""Rolling resistance: its force by hand, closed forms of one disk, tangents against finite differences, restarts."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from small_scenes import free_disks, pushed, scene, shaken, started
from test_next_changes import added_to_tangent
from test_statics import dense_tangent, numerical_tangent

from granular_response.contact.coulomb import CUT, cut, limit, limit_slope, tangential
from granular_response.contact.rolling import Rolling
from granular_response.scene import Scene, SceneError
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.path import PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.rates import RateProblem, next_changes
from granular_response.solvers.solution import rest_state, solve_scene
from granular_response.solvers.system import StaticSystem
from granular_response.solvers.timestep import stability_limit
from granular_response.solvers.work import slid, stored, work
from granular_response.state import OPEN, SLIDING, STICKING
from granular_response.store.result import state_from, to_dataset

LAW = Rolling(tangential_stiffness=500.0, tangential_damping=10.0, friction=0.1)
EVERYWHERE = {
    "contact__friction": 0.3,
    "contact__rolling_friction": 0.1,
    "contact__rolling_stiffness_ratio": 0.5,
    "wall__friction": 0.4,
    "wall__rolling_friction": 0.2,
}
FLOOR = {"wall__friction": 1.0, "wall__rolling_friction": 0.3, "wall__rolling_stiffness_ratio": 0.5}


def test_the_rolling_force_by_hand():
    """Within the limit spring and dashpot; beyond it the cut force, and the spring that it leaves after the dashpot."""
    assert tangential(1e-3, 0.01, 10.0, LAW, CUT, 0.01) == pytest.approx((-0.65, 1.1e-3))
    assert tangential(3e-3, 0.01, 10.0, LAW, CUT, 0.0) == pytest.approx((-1.0, 0.9 / 500.0))
    assert tangential(-3e-3, 0.0, -10.0, LAW, CUT, 0.0) == pytest.approx((1.0, -1.0 / 500.0))
    assert cut(3e-3, 0.0, 1.0, LAW.tangential_stiffness) == pytest.approx((-1.0, 2e-3, True))
    assert cut(1e-3, 0.0, 1.0, LAW.tangential_stiffness) == pytest.approx((-0.5, 1e-3, False))
    assert limit(LAW, 10.0) == 1.0 and limit_slope(LAW, 10.0) == LAW.friction


def test_keys_that_do_nothing_together_are_refused_and_absent_ones_are_not_written():
    with pytest.raises(SceneError, match=r"^contact\.rolling_friction = 0\.2: must be 0 unless contact\.friction"):
        Scene().updated({"contact.rolling_friction": 0.2})
    with pytest.raises(SceneError, match=r"^wall\.rolling_friction = 0\.2: must be 0 unless wall\.friction"):
        Scene().updated({"wall.rolling_friction": 0.2, "contact.rolling_stiffness_ratio": 0.5})
    rolls = scene(**EVERYWHERE)
    assert Scene.from_text(rolls.to_yaml()) == rolls and "rolling_friction: 0.1" in rolls.to_yaml()
    assert "rolling" not in Scene().to_yaml()
    assert rolls.updated({"contact.rolling_friction": 0.0}).contact.rolls is False


@pytest.mark.parametrize("torque", [0.29, -0.29, 0.31])
def test_a_disk_on_the_floor_holds_a_couple_up_to_its_limit(torque):
    """No force along the floor: the couple is mu_R times the weight times the radius at most."""
    problem, _ = free_disks([[10.0, 1.0]], width=20.0, loads=[{"disk": 0, "force": [0, 0], "torque": torque}], **FLOOR)
    rest = rest_state(problem)
    problem, record = problem.with_loads(rest.position), PathRecord()
    if abs(torque) > 0.3:
        follow(problem, rest, [1.0], record=record)
        assert [event.kind for event in record.events] == ["rolls", "jump"]
        assert record.events[0].load_factor * torque == pytest.approx(0.3, abs=1e-8)
        assert record.events[1].displacement > 5.0  # to the side wall
        return
    (state,) = follow(problem, rest, [1.0], record=record)
    assert not record.events and state.certificate.torque_residual < 1e-12
    assert state.walls.rolling_force[0] == pytest.approx(-torque)
    assert state.angle[0] - rest.angle[0] == pytest.approx(torque / problem.laws[1][1].tangential_stiffness)


@pytest.mark.parametrize("body", ["disk", "floor"])
def test_energy_is_never_gained(body):
    """Collisions with any spin, without gravity: what flies apart has less energy than what met."""
    rng, lost = np.random.default_rng(3), []
    strong = EVERYWHERE | {"contact__rolling_friction": 1.0, "wall__rolling_friction": 1.0}
    for _ in range(60):
        v, spin = rng.normal(0.0, 0.3, (2, 2)), rng.normal(0.0, 1.0, 2)
        v[0, 1], v[1, 1] = -abs(v[0, 1]) - 0.01, abs(v[1, 1])
        places = [[500.0, 52.0], [500.0 + 2.0 * np.sin(0.3), 52.0 - 2.0 * np.cos(0.3)]]
        count = 2
        if body == "floor":
            places, v, spin, count = [[500.0, 1.0]], v[:1], spin[:1], 1
        problem, state = free_disks(places, velocity=v[:count], spin=spin[:count], **strong)
        dynamics = Dynamics(problem, state, time_step=1e-5)
        dynamics.set_ramps(gravity=(0.0, 0.0, 0.0))
        before = dynamics.kinetic_energy()
        dynamics.advance(10_000)
        assert not dynamics.touching().any()
        lost.append(1.0 - dynamics.kinetic_energy() / before)
    assert min(lost) > -1e-9 and max(lost) > 0.1


def rolled(spring=1e-5, roll=2e-4):
    """A shaken slab with springs along the rolling too, some beyond their limits."""
    problem = Problem.from_scene(scene(**EVERYWHERE))
    state = shaken(problem, seed=4, size=1e-4, spring=spring)
    rng = np.random.default_rng(7)
    pairs, walls = (
        replace(one, rolling_spring=rng.normal(0, roll, len(one.first))) for one in (state.pairs, state.walls)
    )
    return problem, problem.with_static_forces(replace(state, pairs=pairs, walls=walls))


@pytest.mark.parametrize("roll", [1e-6, 5e-3], ids=["held", "rolls"])
def test_forces_agree_with_dynamics_at_rest_and_the_tangent_is_their_derivative(roll):
    problem, state = rolled(roll=roll)
    system, known = started(problem, state)
    q = known.q + np.random.default_rng(1).normal(0, 1e-7, system.dof)
    trial = system.trial(known, known.q)
    force = Dynamics(problem, state).history[0, : system.dof] / problem.inverse_mass
    assert trial.contact_force + problem.weight_vector == pytest.approx(force, abs=1e-9)
    trial = system.trial(known, q)
    statuses = np.abs(trial.sense[len(trial.status) :])
    assert (statuses == (SLIDING if roll > 1e-3 else STICKING)).sum() > 20
    exact, numerical = dense_tangent(system, trial), numerical_tangent(system, known, q)
    assert np.abs(exact - numerical).max() < 1e-6 * np.abs(exact).max()
    fixed = np.full_like(system.limits(trial), 0.05)
    held = system.trial(known, q, limits=fixed)
    exact, numerical = dense_tangent(system, held), numerical_tangent(system, known, q, limits=fixed)
    assert np.abs(exact - numerical).max() < 1e-6 * np.abs(exact).max()
    v = np.random.default_rng(2).normal(size=system.dof)
    assert system.force_rates(trial, v) == pytest.approx(-dense_tangent(system, trial) @ v, abs=1e-8)


def test_what_comes_next_along_the_rolling_falls_at_the_rate_that_is_said():
    problem, state = rolled(roll=1e-6)
    system = StaticSystem(problem, state)
    known, count = system.start(state), len(system.listed.gap)
    sense = system.coupled(np.where(system.trial(known, known.q).sense == OPEN, OPEN, STICKING))
    here = system.trial(known, known.q, fixed=sense)
    v = np.random.default_rng(5).normal(size=system.dof)
    found = next_changes(system, here, v, sense, 0.0, 0.0)
    seen, h = set(), 1e-8
    there, back = (system.trial(known, known.q + s * h * v, fixed=sense) for s in (1.0, -1.0))
    for c in np.flatnonzero(found.rate > 0.0):
        if c < count:
            continue
        side = np.sign(found.what[c])

        def left(trial, c=c - count, side=side):
            return system.limits(trial)[count + c] - side * trial.contacts.tangential[count + c]

        seen.add((int(side), bool(c - count < len(system.first))))
        assert found.left[c] == pytest.approx(left(here), abs=1e-12)
        assert found.rate[c] == pytest.approx((left(back) - left(there)) / (2.0 * h), rel=1e-4, abs=1e-2)
        until = RateProblem(system, 1.0, force=0.0).until(here, c, int(found.what[c]), v)
        assert until == pytest.approx((found.left[c], found.rate[c]))
    assert seen == {(1, True), (-1, True), (1, False), (-1, False)}


def test_a_changed_status_is_the_difference_of_tangents():
    problem, state = rolled()
    system = StaticSystem(problem, state)
    known, count = system.start(state), len(system.listed.gap)
    here = system.trial(known, known.q)
    closed = np.flatnonzero(here.status != OPEN)
    for c in (closed[0], closed[len(closed) // 2], closed[-1]):
        for before in (STICKING, SLIDING, -SLIDING):
            for after in (OPEN, STICKING, SLIDING, -SLIDING):
                matrices = []
                for status in (before, after):
                    sense = here.sense.copy()
                    sense[count + c] = STICKING if status == OPEN else status
                    trial = system.trial(known, known.q, fixed=sense)
                    if status == OPEN:
                        trial.tangents[c, 3] = 0.0
                    matrices.append(system.tangent(trial).toarray())
                added, _ = added_to_tangent(system, known.q, count + c, before, after)
                assert added == pytest.approx(matrices[1] - matrices[0], abs=1e-8)


@pytest.fixture(scope="module")
def solution():
    weak = EVERYWHERE | {"contact__rolling_friction": 0.02, "wall__rolling_friction": 0.02}
    return solve_scene(scene(5, 9, loads=pushed(1.0, -6.0), protocol__load_factors=[0.5, 1.0], **weak))


def test_a_path_keeps_the_limits_and_its_energy(solution):
    last = solution.loaded[-1]
    kinds = {event.kind for state in solution.loaded for event in state.reached.events}
    assert "rolls" in kinds and (last.pairs.rolling_status == SLIDING).any()
    for state in solution.loaded:
        c = state.certificate
        assert c.stable and max(c.coulomb_excess, c.rolling_excess) < 1e-8 and c.torque_residual < 1e-9
        held = state.pairs.touching
        assert np.array_equal(state.pairs.rolling_status[held] != OPEN, np.ones(held.sum(), bool))
    problem = solution.problem
    states = follow(problem, solution.rest, np.linspace(0.0, 1.0, 401)[1:])
    ends = [solution.rest, *states]
    done = sum(work(problem, a, b) for a, b in pairwise(ends))
    lost = sum(slid(problem, a, b).total for a, b in pairwise(ends))
    kept = stored(problem, ends[-1]) - stored(problem, ends[0])
    assert lost > 1e-4 and done == pytest.approx(kept + lost, abs=2e-3 * lost)


def test_a_file_has_what_rolls_where_something_does(solution):
    dataset = to_dataset(solution)
    assert {"contact_rolling_spring", "wall_rolling_status", "certificate_rolling_excess"} <= set(dataset)
    units = {"force": "mean_weight", "excess": "mean_weight", "spring": "mean_radius", "status": None}
    for name in (str(name) for name in dataset.variables if "rolling" in str(name)):
        assert dataset[name].attrs.get("units") == units[name.rpartition("_")[2]], name
    again = state_from(dataset, 1).certificate.rolling_excess
    assert again == solution.loaded[0].certificate.rolling_excess
    plain = to_dataset(solve_scene(scene(3, 5)))
    assert not [name for name in plain.variables if "rolling" in str(name)]


def test_stiff_rolling_shortens_the_time_step():
    """A disk between neighbours that spin the other way; at the limit a packing settles, and beyond it does not."""
    soft, stiff = (
        Problem.from_scene(scene(3, 5, **(EVERYWHERE | {"contact__rolling_stiffness_ratio": ratio})))
        for ratio in (0.5, 20.0)
    )
    assert stability_limit(stiff) < 0.7 * stability_limit(soft)
    rng = np.random.default_rng(0)
    for part, rests in ((0.95, True), (2.0, False)):
        state = replace(stiff.bare_state(), angular_velocity=rng.normal(0, 1e-3, stiff.n))
        dynamics = Dynamics(stiff, state, time_step=part * stability_limit(stiff))
        dynamics.set_ramps()
        try:
            dynamics.advance(100_000)
            energy = dynamics.kinetic_energy()
        except RuntimeError:
            energy = np.inf
        assert (energy < 1e-12) == rests


def test_an_event_names_the_contact_that_changes():
    """Also where a wall contact and the rolling of a pair change at one load: a disk is where its wall contact is."""
    rolls = {"contact__friction": 0.5, "contact__rolling_friction": 0.05, "contact__rolling_stiffness_ratio": 1.0}
    solved = solve_scene(
        scene(packing__layers=5, packing__disks_per_row=9, wall__friction=0.3, **rolls, loads=pushed(0.3, -6.0)),
        load_factors=[1.0, 2.0],
    )
    at_wall = [event for state in solved.loaded for event in state.reached.events if event.at_wall]
    position, box = solved.rest.position, solved.rest.box
    for event in at_wall:
        foot = box.on_wall(position[[event.first]], [event.second])[0]
        assert np.hypot(event.x - foot[0], event.z - foot[1]) < 0.1
    assert at_wall
