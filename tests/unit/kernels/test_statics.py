"""Static forces against the dynamics' kernels, and tangents against finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene, shaken, started

from granular_response.contact import LAWS
from granular_response.kernels.statics import Increment, Response, fill_pair
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem
from granular_response.solvers.stability import Spectrum
from granular_response.state import OPEN, SLIDING, STICKING

FRICTION = {"none": (0.0, 0.0), "pairs": (0.3, 0.0), "both": (0.3, 0.4), "walls": (0.0, 0.4)}


def problem_with(friction: str, law: str = "linear") -> Problem:
    pair, wall = FRICTION[friction]
    return Problem.from_scene(scene(contact__law=law, contact__friction=pair, wall__friction=wall))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("friction", "spring"), [*((name, 1e-6) for name in FRICTION), ("both", 5e-3)])
def test_forces_agree_with_dynamics_at_rest(friction, spring, law):
    """A shaken packing with springs below the Coulomb limit or beyond, no velocities: two codes, one force."""
    problem = problem_with(friction, law)
    state = shaken(problem, spring=spring)
    system, known = started(problem, state)
    dynamics = Dynamics(problem, state)
    force = dynamics.history[0, : system.dof] / problem.inverse_mass
    trial = system.trial(known, known.q)
    assert trial.contact_force + problem.weight_vector == pytest.approx(force, abs=1e-9)
    if spring > 1e-3:
        assert (trial.status == SLIDING).sum() > 10
        return
    assert (trial.status == STICKING).sum() > 20 and (trial.status == OPEN).any()
    # and the third place where forces are made: the state itself
    for found, part in ((trial.normal, "normal_force"), (trial.tangential, "tangential_force")):
        expected = np.concatenate([getattr(state.pairs, part), getattr(state.walls, part)])
        assert found == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("size", [1e-4, 0.1])
def test_pairs_have_the_bits_in_vectors_that_each_has_alone(law, size):
    """Random displacements, small and large turns, kept statuses, and contacts that keep the statuses of their own."""
    problem = problem_with("both", law)
    system, known = started(problem, shaken(problem, spring=5e-3))
    rng = np.random.default_rng(1)
    q, rates = known.q + size * rng.normal(size=system.dof), rng.normal(size=system.dof)
    sense = rng.choice([OPEN, STICKING, SLIDING, -SLIDING], len(known.spring)).astype(np.int8)
    free = system.trial(known, q)
    for fixed in (sense, None):
        trial = system.trial(known, q, fixed=fixed, velocity=rates, length=1e-3)
        alone = Response(*np.zeros((7, len(sense))))
        none = np.zeros(0)
        kept = none if fixed is None else fixed.astype(float)
        step = Increment(q, known.q, rates, 1e-3, known.overlap, known.spring, none, kept)
        for c in range(len(system.first)):
            fill_pair(c, 0.0, known.spring, step, system.listed, np.zeros(16), alone)
        for name, found in alone._asdict().items():
            assert np.array_equal(found[: len(system.first)], getattr(trial.contacts, name)[: len(system.first)]), name
    own = system.trial(known, q, fixed=free.sense)
    assert own.contradiction == 0.0 and np.array_equal(own.contact_force, free.contact_force)
    assert system.trial(known, q, fixed=sense).contradiction > 1.0


def dense_tangent(system, trial):
    """The tangent as a dense matrix in the order ``[x | z | angle]``."""
    matrix = system.tangent(trial).toarray()
    unit = np.eye(system.dof)
    order = np.array([int(np.flatnonzero(system.interleave(e))[0]) for e in unit])
    return matrix[np.ix_(order, order)]


def numerical_tangent(system, known, q, *, h=1e-7, **options):
    columns = []
    for k in range(len(q)):
        e = np.zeros(len(q))
        e[k] = h
        up, down = system.trial(known, q + e, **options), system.trial(known, q - e, **options)
        assert np.array_equal(up.status, down.status)  # else the derivative has two values
        columns.append((down.contact_force - up.contact_force) / (2.0 * h))
    return np.array(columns).T


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("step", [1e-6, 3e-3], ids=["sticking", "sliding"])
def test_tangent_is_the_derivative(friction, step, law):
    problem = problem_with(friction, law)
    # pressed so hard that no contact opens or closes within the increment
    state = shaken(problem, seed=4, size=1e-4, spring=1e-5)
    system, known = started(problem, state)
    q = known.q + np.random.default_rng(1).normal(0, step, system.dof)
    trial = system.trial(known, q)
    before, now = known.overlap, trial.configuration.overlap
    if step < 1e-4:
        assert np.array_equal(before > 0, now > 0)
        assert (trial.status == STICKING).sum() > 30
    elif problem.rotations:
        assert (trial.status == SLIDING).sum() > 3
    if step < 1e-4 or not problem.rotations:
        assert dense_tangent(system, trial) == pytest.approx(numerical_tangent(system, known, q), abs=2e-3)
        return
    # contacts that close within the increment have a tangent of their own (tested below): compare the others
    newly = np.flatnonzero((before <= 0) & (now > 0))
    involved = set()
    for c in newly:
        m = len(system.first)
        involved |= {int(system.first[c]), int(system.second[c])} if c < m else {int(system.wall_disk[c - m])}
    free = np.array([k for k in range(problem.n) if k not in involved])
    assert len(free) >= 3
    rows = np.concatenate([free + part * problem.n for part in range(3)])
    difference = dense_tangent(system, trial) - numerical_tangent(system, known, q)
    assert np.abs(difference[rows]).max() < 2e-3


@pytest.mark.parametrize("law", LAWS)
def test_tangent_with_fixed_limits_is_the_derivative_and_symmetric_but_for_the_turn(law):
    problem = problem_with("both", law)
    state = shaken(problem, seed=4, size=1e-4, spring=1e-5)
    system, known = started(problem, state)
    q = known.q + np.random.default_rng(1).normal(0, 1e-4, system.dof)
    limits = np.full(len(known.spring), 0.05)
    trial = system.trial(known, q, limits=limits)
    assert (trial.status == SLIDING).sum() > 3
    matrix = dense_tangent(system, trial)
    assert matrix == pytest.approx(numerical_tangent(system, known, q, limits=limits), abs=2e-3)
    assert np.abs(matrix - matrix.T).max() < 1e-3 * np.abs(matrix).max()


def two_disks(wall: bool):
    """A pair, or a disk above the floor, that is open by 1e-4."""
    if wall:
        return free_disks([[500.0, 1.0001]], wall__friction=0.4)
    return free_disks([[500.0, 50.0], [502.0001, 50.0]], contact__friction=0.4)


@pytest.mark.parametrize("wall", [False, True], ids=["pair", "wall"])
def test_newly_closed_contact_collects_slip_from_where_it_closed(wall):
    """It closes after 1/3 of the increment: two thirds of the tangential displacement stretch the spring."""
    problem, state = two_disks(wall)
    system, known = started(problem, state)
    n = problem.n
    q = np.zeros(system.dof)
    q[n if wall else 0] = -3e-4 if wall else 3e-4  # 1e-4 to close, then 2e-4 of overlap
    q[0 if wall else n] = 3e-6
    trial = system.trial(known, q)
    slip = -3e-6  # on disk 0: t = (-1, 0) at the floor, (0, -1) beside a disk at its right
    assert trial.status[0] == STICKING
    assert trial.configuration.spring[0] == pytest.approx(slip * 2 / 3, rel=1e-3)


@pytest.mark.parametrize("wall", [False, True], ids=["pair", "wall"])
def test_tangent_of_a_newly_closed_contact(wall):
    """Exact where no slip has been collected yet; the change of the share of slip is left out of it."""
    problem, state = two_disks(wall)
    system, known = started(problem, state)
    q = np.zeros(system.dof)
    q[problem.n if wall else 0] = -3e-4 if wall else 3e-4
    trial = system.trial(known, q)
    assert trial.status[0] == STICKING
    matrix = dense_tangent(system, trial)
    assert np.abs(matrix).max() > 1000
    assert matrix == pytest.approx(numerical_tangent(system, known, q), abs=2e-3)


def test_large_turn_of_a_pair_is_followed_exactly():
    """Disk 0 is carried by 1 radian around disk 1 without spinning: the spring is distance times angle."""
    problem, state = free_disks([[500.0, 50.0], [501.9, 50.0]], contact__friction=1.0, contact__stiffness_ratio=1e-3)
    system, known = started(problem, state)
    q = np.zeros(6)
    # disk 0 starts on the left of disk 1: n = (-1, 0), t = (0, -1); counter-clockwise is along +t
    q[0], q[2] = 1.9 * (1.0 - np.cos(1.0)), -1.9 * np.sin(1.0)
    trial = system.trial(known, q)
    assert trial.status[0] == STICKING
    assert trial.configuration.spring[0] == pytest.approx(1.9)
    q[4] = q[5] = 0.95  # rolling: both turn by as much as takes the slip away
    assert system.trial(known, q).configuration.spring[0] == pytest.approx(0.0, abs=1e-12)


def test_open_contacts_forget():
    problem, state = free_disks([[500.0, 50.0], [501.99, 50.0]], contact__friction=1.0)
    state = problem.with_static_forces(replace(state, pairs=replace(state.pairs, spring=np.array([1e-3]))))
    assert state.pairs.tangential_force[0] == pytest.approx(-2.4)
    system, known = started(problem, state)
    trial = system.trial(known, np.array([-0.02, 0, 0, 0, 0, 0.0]))
    assert trial.status[0] == OPEN
    assert trial.configuration.spring[0] == 0.0
    assert not trial.contact_force.any()


@pytest.mark.parametrize("rollers", [0, 2, 10])
def test_an_instability_is_found_beside_disks_that_roll_freely(rollers):
    """A disk balanced on another, a floor contact that slides, and disks on the floor that nothing holds along it.

    Each of these rolls at an eigenvalue of nearly zero, nearer to it than that of the unstable stack.
    """
    places = [(5.0, 0.9995), (5.0, 2.9985), (12.0, 0.9995)] + [(20.0 + 4.0 * i, 0.9995) for i in range(rollers)]
    force = 30.0
    friction = {"contact__friction": 0.5, "wall__friction": 0.5}
    problem, state = free_disks(places, loads=[{"disk": 1, "force": [0.0, -force]}], **friction)
    system, known = started(problem, state)
    slides = np.where(system.wall_disk == 2, 1.0, 0.0)  # a spring far beyond Coulomb's limit
    q = known.q.copy()
    q[problem.n : problem.n + 2] -= np.array([1.0, 2.0]) * force / problem.stiffness
    trial = system.trial(replace(known, spring=np.concatenate([np.zeros(len(system.first)), slides])), q)
    assert SLIDING in system.split(trial.status)[1]
    mass = system.interleave(1.0 / problem.inverse_mass)
    values, vectors = np.linalg.eig(system.tangent(trial, 1e-6).toarray() / mass[:, None])
    every = values.real
    assert (every < 0).sum() == 1 and every.min() < -1e-3 * problem.stiffness
    assert Spectrum(system, trial).negative_modes == 1
    lowest, found = system.deinterleave(vectors[:, np.argmin(every)].real), Spectrum(system, trial).direction
    lowest, found = (v[: 2 * problem.n] / v[1] for v in (lowest, found))  # along x of the disk on top
    np.testing.assert_allclose(found, lowest, atol=1e-6)
