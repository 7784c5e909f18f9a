"""The factorisation from both ends against one of the whole tangent."""

from dataclasses import replace

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.solve import Problem, rest_state
from granular_response.solve.equilibrium import external_force, newton
from granular_response.solve.linear.two_sided import TwoSided
from granular_response.solve.system import StaticSystem


@pytest.fixture(scope="module")
def resting():
    """A slab at rest under its weight, long enough for several checkpoints on either side of its load."""
    scene = Scene.from_dict(
        {
            "packing": {"kind": "slab", "layers": 5, "disks_per_row": 41},
            "contact": {"friction": 0.2},
            "loads": [{"disk": "top-centre", "force": [0.0, -2.0]}],
        }
    )
    problem = Problem.from_scene(scene)
    rest = rest_state(problem)
    return problem.with_loads(rest.position), rest


@pytest.fixture
def begun(resting):
    """A system that nothing has been factorised of, and the trial at rest."""
    problem, rest = resting
    system = StaticSystem(problem, rest, updated=True)
    known = system.start(rest)
    return system, system.trial(known, known.q)


def whole(system, trial, right):
    return system.factorise(trial).solve(right)


def changed(trial, pairs=(), walls=()):
    """The trial with tangents of some contacts halved."""
    pair, wall = trial.pair_tangent.copy(), trial.wall_tangent.copy()
    pair[list(pairs)] *= 0.5
    wall[list(walls)] *= 0.5
    return replace(trial, pair_tangent=pair, wall_tangent=wall)


def test_solves_with_what_has_changed_since_brought_up_to_date(begun):
    system, trial = begun
    rng = np.random.default_rng(1)
    m, w = len(system.first), len(system.wall_disk)
    for turn in range(25):
        right = rng.normal(size=system.dof)
        factor, made = system.updated_factor(trial, anew=False)
        assert made
        assert factor.solve(right) == pytest.approx(whole(system, trial, right), rel=1e-9, abs=1e-12)
        assert not system.updated_factor(trial, anew=False)[1]
        walls = rng.integers(w, size=1) if turn % 5 == 0 else ()
        trial = changed(trial, rng.integers(m, size=1 + turn % 2), walls)


@pytest.mark.parametrize(
    ("disks", "reach", "centre"),
    [(1, 0, 0), (2, 1, 0), (3, 1, 1), (5, 1, 4), (5, 4, 2), (30, 1, 0), (30, 1, 29), (60, 5, 33), (24, 20, 12)],
)
def test_chains_of_any_length_and_width_with_the_load_anywhere(disks, reach, centre):
    """Nothing on one side or on both, a core narrower than the band, no second checkpoint."""
    rng = np.random.default_rng(disks)
    ties = [(i, j) for i in range(disks) for j in range(i + 1, min(disks, i + reach + 1))]
    pairs = np.array(ties, np.int64).reshape(-1, 2)
    pairs[::2] = pairs[::2, ::-1]
    walls, arms = np.arange(0, disks, 2), rng.uniform(0.5, 1.5, disks)

    def tangents(count):
        found = 0.2 * rng.normal(size=(count, 3, 3)) - np.eye(3)
        found[:, 2, 2] *= -1.0
        return found

    def matrix(pair, wall):
        whole = 6.0 * np.eye(3 * disks)
        for (i, j), g in [*zip(pairs, pair, strict=True), *(((i, None), g) for i, g in zip(walls, wall, strict=True))]:
            for row, row_sign in ((i, 1.0), (j, -1.0)):
                for column, sign in ((i, 1.0), (j, -1.0)):
                    if row is not None and column is not None:
                        left, right = np.diag([row_sign, row_sign, -arms[row]]), np.diag([sign, sign, arms[column]])
                        whole[3 * row : 3 * row + 3, 3 * column : 3 * column + 3] -= left @ g @ right
        return whole

    pair, wall = tangents(len(pairs)), tangents(len(walls))
    factor = TwoSided(pairs, walls, arms, half_width=3 * reach + 2, centre=centre, diagonal=6.0, stiffness=1.0)
    for _ in range(4):
        factor.update(pair, wall)
        right = rng.normal(size=3 * disks)
        assert factor.solve(right) == pytest.approx(np.linalg.solve(matrix(pair, wall), right), rel=1e-11, abs=1e-12)
        pair, wall = pair.copy(), wall.copy()
        wall[rng.integers(len(walls))] = tangents(1)[0]
        if len(pairs):
            pair[rng.integers(len(pairs))] = tangents(1)[0]


def test_little_changes_are_left_until_all_is_asked_for_anew(begun):
    system, trial = begun
    right = np.ones(system.dof)
    before = system.updated_factor(trial, anew=False)[0].solve(right)
    little = replace(trial, pair_tangent=trial.pair_tangent * (1.0 + 1e-3))
    factor, made = system.updated_factor(little, anew=False)
    assert not made
    assert np.array_equal(factor.solve(right), before)
    factor, made = system.updated_factor(little, anew=True)
    assert made
    assert factor.solve(right) == pytest.approx(whole(system, little, right), rel=1e-9, abs=1e-12)


def test_what_is_not_finite_is_forgotten(begun):
    system, trial = begun
    right = np.ones(system.dof)
    before = system.updated_factor(trial, anew=False)[0].solve(right)
    broken = trial.pair_tangent.copy()
    broken[len(broken) // 2] = np.nan
    assert not np.isfinite(system.updated_factor(replace(trial, pair_tangent=broken), anew=False)[0].solve(right)).all()
    assert np.array_equal(system.updated_factor(trial, anew=False)[0].solve(right), before)


def test_newton_finds_the_same_equilibrium(resting):
    problem, rest = resting
    found = []
    for updated in (False, True):
        system = StaticSystem(problem, rest, updated=updated)
        assert system.updated == updated
        trial, report = newton(system, system.start(rest), external_force(problem, 0.2))
        assert report.converged
        found.append(trial)
    assert found[1].wall_normal == pytest.approx(found[0].wall_normal, abs=1e-9)
    assert np.array_equal(found[0].sense, found[1].sense)
