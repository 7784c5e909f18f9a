"""What contacts do next against finite differences, changes of the tangent, and solutions brought up to date."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from small_scenes import free_disks, scene, shaken

from granular_response.contact import LAWS
from granular_response.kernels import transitions
from granular_response.linalg.band import Band
from granular_response.linalg.updated import Updated
from granular_response.solvers.path import PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.rates import RateProblem, next_changes
from granular_response.solvers.solution import rest_state
from granular_response.solvers.system import StaticSystem
from granular_response.state import OPEN, SLIDING, STICKING

SENSES = (OPEN, STICKING, SLIDING, -SLIDING)


def pressed(friction=(0.3, 0.4), law="linear", spring=1e-3):
    """A shaken slab whose contacts have all statuses, with a little room to the next one."""
    pair, wall = friction
    problem = Problem.from_scene(scene(3, 5, contact__law=law, contact__friction=pair, wall__friction=wall))
    state = shaken(problem, seed=2, spring=spring)
    system = StaticSystem(problem, state)
    return system, system.start(state)


def what_is_left(system, trial, c, what) -> float:
    """The force that is left until contact ``c`` does ``what``, from the forces of a trial alone."""
    law = system.problem.pair_law if c < len(system.first) else system.problem.wall_law
    if what in (transitions.OPENS, transitions.CLOSES):
        return float(law.normal_stiffness * trial.configuration.overlap[c] * (1 if what == transitions.OPENS else -1))
    return float(law.friction * trial.normal[c] - np.sign(what) * trial.tangential[c])


def added_to_tangent(system, q, c, before, after) -> tuple[np.ndarray, int]:
    """What another status of contact ``c`` adds to the tangent, and in how many columns it is said."""
    problem = system.problem
    senses = np.zeros((2, 2 * len(system.friction)), np.int8)
    senses[:, c] = before, after
    columns = transitions.Columns(np.zeros(2, np.int64), np.zeros((2, 6), np.int64), *np.zeros((2, 2, 6)))
    count = transitions.changed_stiffness(
        np.array([c]), *senses, q, system.listed, problem.freedoms, system.pattern.place, columns
    )
    owner, places, left, right = columns
    added = np.zeros((system.dof, system.dof))
    for at, p, r in zip(places[:count], left, right, strict=False):
        np.add.at(added, np.ix_(at, at), np.outer(p, r))
    assert (owner[:count] == c).all()
    return added, count


@pytest.mark.parametrize("law", LAWS)
def test_what_is_left_falls_at_the_rate_that_is_said(law):
    """Contacts that close and slide either way, pairs and walls; that open, below."""
    system, known = pressed(law=law)
    here = system.trial(known, known.q)
    sense = np.where(here.status == OPEN, OPEN, STICKING)
    here = system.trial(known, known.q, fixed=sense)
    seen = set()
    for seed in range(4):
        velocity = np.random.default_rng(seed).normal(size=system.dof)
        found = next_changes(system, here, velocity, sense, 0.0, 0.0)
        rates = RateProblem(system, 1.0, force=0.0)
        h = 1e-8
        there, back = (system.trial(known, known.q + s * h * velocity, fixed=sense) for s in (1.0, -1.0))
        for c in np.flatnonzero(found.rate > 0.0):
            what = int(found.what[c])
            seen.add((what, c < len(system.first)))
            assert found.left[c] == pytest.approx(what_is_left(system, here, c, what), abs=1e-12)
            by_difference = (what_is_left(system, back, c, what) - what_is_left(system, there, c, what)) / (2.0 * h)
            assert found.rate[c] == pytest.approx(by_difference, rel=2e-4, abs=1e-2)
            assert rates.until(here, c, what, velocity) == pytest.approx((found.left[c], found.rate[c]), rel=1e-12)
        # what is first is what comes first as all goes on
        first, length = transitions.first_change(found.left, found.rate)
        others = found.left[found.rate > 0.0].clip(0.0) / found.rate[found.rate > 0.0]
        assert length == others.min() == max(found.left[first], 0.0) / found.rate[first]
    assert {what for what, pair in seen if pair} >= {transitions.CLOSES, transitions.SLIDES, -transitions.SLIDES}
    assert {what for what, pair in seen if not pair} & {transitions.SLIDES, -transitions.SLIDES}


@pytest.mark.parametrize("law", LAWS)
def test_contacts_that_slide_stick_where_the_return_map_lets_them(law):
    """A step along the rates: those of which it says so are below the limit afterwards, the others at it."""
    system, known = pressed(law=law, spring=5e-3)
    trial = system.trial(known, known.q)
    assert (trial.status == SLIDING).sum() > 6
    known = trial.configuration  # springs at the limit
    velocity = np.random.default_rng(5).normal(size=system.dof)
    found = next_changes(system, system.trial(known, known.q, fixed=trial.sense), velocity, trial.sense, 0.0, 0.0)
    after = system.trial(known, known.q + 1e-9 * velocity)
    sliding = np.flatnonzero(trial.status == SLIDING)
    sticks = found.what[sliding] == transitions.STICKS
    assert 2 < sticks.sum() < len(sliding) - 2
    assert np.array_equal(after.status[sliding] == STICKING, sticks)
    assert not found.left[sliding][sticks].any()


def test_a_contact_that_would_open_before_it_slides_opens():
    """Pulled straight up; and one that is pushed along the floor while it is relieved slides first."""
    problem, state = free_disks([[500.0, 1.0 - 1e-3]], contact__friction=0.2, wall__friction=0.2)
    system = StaticSystem(problem, problem.with_static_forces(state))
    known = system.start(state)
    trial = system.trial(known, known.q)
    up = next_changes(system, trial, np.array([0.0, 1.0, 0.0]), trial.sense, 0.0, 0.0)
    k = problem.wall_law.normal_stiffness
    assert (up.what[0], up.left[0], up.rate[0]) == (transitions.OPENS, pytest.approx(k * 1e-3), pytest.approx(k))
    for side in (1.0, -1.0):
        moved = next_changes(system, trial, np.array([side, 0.1, 0.0]), trial.sense, 0.0, 0.0)
        # the floor holds back: along its tangent (-1, 0) the force is positive for a disk that goes to the right
        assert moved.what[0] == side * transitions.SLIDES
        assert moved.left[0] == pytest.approx(0.2 * k * 1e-3)
        assert moved.rate[0] == pytest.approx(problem.wall_law.tangential_stiffness + 0.2 * 0.1 * k)


def beside_a_corner(gap):
    """A disk in the left corner, which bears it on two sides, and one on the floor that touches it at no force."""
    places = [[1.0 - 1e-3, 1.0 - 1e-3], [3.0 - 1e-3 - gap, 1.0 - 1e-3]]
    problem, state = free_disks(places, width=50.0, contact__friction=0.0, wall__friction=0.0)
    system = StaticSystem(problem, problem.with_static_forces(state))
    known = system.start(state)
    sense = np.full(len(known.spring), STICKING)
    assert (len(system.first), len(system.wall_disk)) == (1, 3)
    return system, system.trial(known, known.q, fixed=sense), sense


def test_a_rattler_that_another_disk_pushes_along_or_leaves():
    """It rests on the floor alone. Where it would be drawn along it stays behind, and the contact opens."""
    system, trial, sense = beside_a_corner(0.0)
    for velocity, does, rate in (([1.0, 1.0], transitions.NOTHING, 0.0), ([-1.0, -1.0], transitions.OPENS, 3000.0)):
        moves = np.array([*velocity, 0.0, 0.0])
        found = next_changes(system, trial, moves, sense, 1e-9, 1e-9)
        assert (found.what[0], found.rate[0], found.left[0]) == (does, pytest.approx(rate, rel=1e-3), 0.0)


def test_a_disk_that_is_pushed_against_another_does_not_leave_it():
    """They touch at no force between two walls, and the load presses them together: nothing is lost."""
    load = [{"disk": 0, "force": [1.0, 0.0]}]
    friction = {"contact__friction": 0.3, "wall__friction": 0.3}
    problem, _ = free_disks([[1.0, 1.0], [3.0, 1.0]], width=4.0, loads=load, **friction)
    rest = rest_state(problem)
    record = PathRecord()
    (state,) = follow(problem.with_loads(rest.position), rest, [0.5], record=record)
    assert state.pairs.touching.all() and not [event for event in record.events if event.lost]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("friction", [(0.3, 0.4), (0.3, 0.0), (0.0, 0.4), (0.0, 0.0)])
def test_a_changed_stiffness_is_the_difference_of_tangents(law, friction):
    """For every two statuses of a pair and of a contact with a wall, up to the turn of a force that comes or goes."""
    system, known = pressed(friction, law)
    problem = system.problem
    m = len(system.first)
    here = system.trial(known, known.q)
    closed = np.flatnonzero(known.overlap > 0.0)
    for c in (closed[0], closed[len(closed) // 2], closed[-1]):
        rubs = problem.pair_friction if c < m else problem.wall_friction
        kinds = SENSES if rubs else (OPEN, STICKING)
        for before in kinds:
            for after in kinds:
                sense = here.sense.copy()
                matrices = []
                for status in (before, after):
                    sense[c] = status
                    trial = system.trial(known, known.q, fixed=sense)
                    # the turn of forces is left out of the update: of trials that bear nothing here it is nothing
                    matrices.append(system.tangent(_without_turn(system, trial, c)).toarray())
                added, count = added_to_tangent(system, known.q, c, before, after)
                assert added == pytest.approx(matrices[1] - matrices[0], abs=1e-7)
                assert count <= 2 and (count == 0) == (before == after or not np.abs(matrices[1] - matrices[0]).max())


def _without_turn(system, trial, c):
    """The trial with the stiffness of contact ``c`` alone: what its force adds as its normal turns is taken out."""
    m = len(system.first)
    if c >= m:  # the normal of a wall does not turn
        return trial
    q, n = trial.configuration.q, system.problem.n
    i, j = system.first[c], system.second[c]
    d = np.array([system.dx0[c] + q[i] - q[j], system.dz0[c] + q[n + i] - q[n + j]])
    normal = d / np.hypot(*d)
    along = np.array([-normal[1], normal[0]])
    turn = np.outer(trial.normal[c] * along - trial.tangential[c] * normal, along) / np.hypot(*d)
    local = trial.tangent.copy()
    local[c, :2, :2] -= turn
    return replace(trial, local=lambda: local)


def of_all(change):
    """Columns of several changes, from what gives those of one."""

    def columns(keys):
        parts = [change(key) for key in keys]
        owner = np.repeat(keys, [len(part[0]) for part in parts])
        return owner, *map(np.concatenate, zip(*parts, strict=True))

    return columns


@pytest.mark.parametrize("seed", range(12))
def test_solutions_brought_up_to_date_are_those_of_the_changed_matrix(seed):
    """Random changes that come and go: solutions, and the sign of the determinant."""
    rng = np.random.default_rng(seed)
    n, b, most, e = 30, 5, 12, 4
    dense = np.triu(np.tril(rng.normal(size=(n, n)), b), -b) + 4.0 * np.eye(n)
    updated = Updated(_factor(dense, b), n, most, e, np.zeros(6, np.int64))
    known = {}

    def change(key):
        """One column or two; large enough to turn the sign of the determinant now and then."""
        return known[key]

    wanted = np.zeros(6, np.int64)
    right = rng.normal(size=n)
    signs = set()
    for turn in range(40):
        key = int(rng.integers(6))
        if wanted[key] and rng.random() < 0.5:
            wanted[key] = 0
        else:
            wanted[key] = turn + 1
            rows = int(rng.integers(1, 3))
            places = np.array([rng.choice(n, e, replace=False) for _ in range(rows)])
            known[key] = places, *(rng.normal(0.0, 2.0, (rows, e)) for _ in range(2))
        assert updated.update(wanted.copy(), of_all(change))
        matrix = dense.copy()
        for k in np.flatnonzero(wanted):
            for at, p, q in zip(*known[k], strict=True):
                matrix[np.ix_(at, at)] += np.outer(p, q)
        sign = np.linalg.slogdet(matrix)[0]
        signs.add(sign)
        assert (-1.0) ** updated.negative_pivots == sign
        if updated.accurate:
            exact = np.linalg.solve(matrix, right)
            assert updated.solve(right) == pytest.approx(exact, rel=1e-5, abs=1e-7 * np.abs(exact).max())
            assert updated.solve_same(right) == pytest.approx(updated.solve(right), rel=1e-14, abs=1e-14)
    assert signs == {1.0, -1.0}


def _factor(dense, b):
    """Banded factorisation of a dense matrix with ``b`` diagonals on either side."""
    matrix = sp.csc_array(dense)
    return Band(matrix.indptr, matrix.indices).factor(matrix)


@pytest.mark.parametrize("b", [0, 1, 9, 40])
def test_several_right_hand_sides_have_the_digits_that_each_has_alone(b):
    """Those that begin with zeros too, of which all begin with some in the end."""
    rng = np.random.default_rng(b)
    n = 61
    dense = np.triu(np.tril(rng.normal(size=(n, n)), b), -b) + 9.0 * np.eye(n)
    factor = _factor(dense, b)
    right = rng.normal(size=(5, n))
    for zeros in (0, 3, 30, 60):
        right[1:, :zeros] = 0.0
        for rows in (right, right[1:], right[:1]):
            found = factor.solve(rows)
            assert np.array_equal(found, [factor.solve(row) for row in rows])
            assert dense @ found.T == pytest.approx(rows.T, abs=1e-12)


@pytest.mark.parametrize("held", [1e-12, 1e12])
def test_a_change_that_takes_hold_of_what_nothing_held_is_not_called_accurate(held):
    dense = np.diag([1.0, 1.0, held, 1.0])
    updated = Updated(_factor(dense, 0), 4, 2, 1, np.zeros(1, np.int64))
    one = np.array([[2]]), np.array([[1.0]]), np.array([[-held + 1e-3 if held > 1.0 else 1.0]])
    assert updated.accurate
    assert updated.update(np.array([1]), of_all(lambda _: one)) and not updated.accurate
    assert updated.update(np.array([0]), of_all(lambda _: one)) and updated.accurate
