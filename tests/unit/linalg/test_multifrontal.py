"""Multifrontal factorisation against dense and general sparse ones."""

import weakref
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve
from small_scenes import at_rest, pushed, scene

from granular_response.linalg import Sequence, multifrontal, nearby, ordering
from granular_response.linalg.dissection import Dissection
from granular_response.linalg.multifrontal import Multifrontal
from granular_response.machine import threads
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.stability import Spectrum
from granular_response.solvers.system import StaticSystem


def lattice(columns, rows):
    """Positions and neighbour pairs of a rectangular piece of a triangular lattice."""
    x, z = np.meshgrid(np.arange(columns), np.arange(rows))
    position = np.stack([(2.0 * x + z % 2).ravel(), np.sqrt(3.0) * z.ravel()], axis=1)
    distance = np.linalg.norm(position[:, None] - position[None], axis=2)
    first, second = np.nonzero(np.triu(distance < 2.1, 1))
    return position, first, second


def pattern(dissection, first, second, freedoms):
    """A random unsymmetric matrix that ties each disk to its neighbours, in the order of elimination."""
    n = len(dissection.order)
    place = np.argsort(dissection.order)
    graph = sp.csr_array((np.ones(len(first)), (place[first], place[second])), shape=(n, n))
    full = sp.csc_array(sp.kron(graph + graph.T + sp.eye_array(n), np.ones((freedoms, freedoms))))
    full.sort_indices()
    full.data = np.random.default_rng(1).normal(size=len(full.data))
    return full


def dissected(columns, rows, freedoms=2):
    """The nested dissection of a lattice, and a random matrix of its pattern."""
    position, first, second = lattice(columns, rows)
    dissection = Dissection(position, first, second)
    return dissection, pattern(dissection, first, second, freedoms)


def counted(monkeypatch, owner, name):
    """A list that grows with every call of a method."""
    method, calls = getattr(owner, name), []
    monkeypatch.setattr(owner, name, lambda *given, **named: calls.append(1) or method(*given, **named))
    return calls


def shifted(matrix, shift):
    return sp.csc_array(matrix + shift * sp.eye_array(matrix.shape[0]))


@pytest.mark.parametrize(("columns", "rows"), [(1, 1), (5, 3), (40, 9), (23, 31)])
def test_fronts_cover_every_disk_and_tie(columns, rows):
    position, first, second = lattice(columns, rows)
    dissection = Dissection(position, first, second)
    assert sorted(dissection.order.tolist()) == list(range(columns * rows))
    place = np.argsort(dissection.order)
    front = np.searchsorted(dissection.start, place, side="right") - 1
    for a, b in zip(first, second, strict=True):
        low, high = (a, b) if place[a] < place[b] else (b, a)
        assert front[low] == front[high] or place[high] in dissection.boundary[front[low]]
    children = [c for below in dissection.children for c in below]
    assert len(children) == len(set(children)) and all(
        child < parent for parent, below in enumerate(dissection.children) for child in below
    )


@pytest.mark.parametrize("shift", [60.0, 2.0])
def test_symmetric_matrices_are_solved_where_definite_and_their_negative_eigenvalues_counted(shift):
    dissection, matrix = dissected(15, 20)
    matrix = shifted(matrix + matrix.T, shift)
    expected = int((np.linalg.eigvalsh(matrix.toarray()) < 0).sum())
    assert (expected > 0) == (shift < 10.0)
    fronts = Multifrontal(dissection, 2)
    assert fronts.negative_eigenvalues(matrix) == expected
    factor = fronts.definite_factor(matrix)
    assert (factor is None) == (expected > 0)
    factor = fronts.factor(matrix) if factor is None else factor
    right = np.random.default_rng(2).normal(size=matrix.shape[0])
    assert factor.solve(right) == pytest.approx(np.linalg.solve(matrix.toarray(), right), rel=1e-7, abs=1e-10)


def test_singular_matrix_is_an_error():
    dissection, matrix = dissected(3, 2)
    with pytest.raises(RuntimeError, match="singular"):
        Multifrontal(dissection, 2).factor(0.0 * matrix)


def split(monkeypatch):
    monkeypatch.setattr(multifrontal, "OPTIONS", replace(multifrontal.OPTIONS, large=100, block=10))


@pytest.mark.parametrize("kind", ["unsymmetric", "definite", "indefinite"])
def test_the_bits_are_those_of_one_thread(monkeypatch, kind):
    split(monkeypatch)
    dissection, matrix = dissected(60, 25, 3)
    matrix = shifted(matrix if kind == "unsymmetric" else matrix + matrix.T, 80.0 if kind == "definite" else 3.0)
    right = np.random.default_rng(5).normal(size=matrix.shape[0])
    solutions, rough, negatives = [], [], []
    for count in (1, 2, 3):
        fronts = Multifrontal(dissection, 3)
        assert len(fronts.ranges) > 10 and len(fronts.above) > 5
        with threads.using(count):
            if kind == "unsymmetric":
                rough.append(fronts.rough_factor(matrix).solve(right))
            else:
                negatives.append(fronts.negative_eigenvalues(matrix))
                assert (fronts.definite_factor(matrix) is None) == (kind == "indefinite")
            factor = fronts.definite_factor(matrix) if kind == "definite" else fronts.factor(matrix)
            solutions.append(factor.solve(right))
    assert all(solution.tobytes() == solutions[0].tobytes() for solution in solutions[1:])
    assert solutions[0] == pytest.approx(spsolve(matrix, right), rel=1e-6, abs=1e-9)
    if kind == "unsymmetric":
        assert all(solution.tobytes() == rough[0].tobytes() for solution in rough[1:])
        left = np.abs(matrix @ rough[0] - right).max()
        sizes = np.abs(matrix).sum(axis=1).max() * np.abs(rough[0]).max() + np.abs(right).max()
        assert 1e-10 < left / sizes < 100.0 * np.finfo(np.float32).eps  # backward stable, in single precision
    if kind != "unsymmetric":
        assert len(set(negatives)) == 1 and (negatives[0] > 0) == (kind == "indefinite")


def test_a_packing_is_solved_alike_by_band_and_fronts(monkeypatch):
    problem = Problem.from_scene(scene(6, 13, contact__friction=0.2))
    state = problem.bare_state()
    banded = StaticSystem(problem, state)
    monkeypatch.setattr(ordering, "WIDEST_BAND", 0)
    fronts = StaticSystem(problem, state)
    assert type(banded.storage) is not type(fronts.storage)
    known = banded.start(state)
    q = known.q + 1e-3 * np.random.default_rng(3).normal(size=known.q.size)
    right = np.random.default_rng(4).normal(size=known.q.size)
    solutions = []
    for system in (banded, fronts):
        factor = system.factorise(system.tangent(system.trial(known, q), 1000.0))
        solutions.append(system.deinterleave(factor.solve(system.interleave(right))))
    assert solutions[1] == pytest.approx(solutions[0], rel=1e-9, abs=1e-12)


@pytest.fixture
def factorised(monkeypatch):
    """A pattern that is split into subtrees, a matrix of it with its rough LU, and a copy with changes in one place."""
    monkeypatch.setattr(multifrontal, "OPTIONS", replace(multifrontal.OPTIONS, large=0))
    dissection, matrix = dissected(23, 31, 3)
    matrix = shifted(matrix, 12.0)
    fronts = Multifrontal(dissection, 3)
    assert len(fronts.ranges) > 8 and len(fronts.above) > 4
    changed = matrix.copy()
    changed.data[500:504] += 3.0
    return fronts, matrix, fronts.rough_factor(matrix), changed


RIGHT = np.random.default_rng(2).normal(size=23 * 31 * 3)


def test_an_lu_that_becomes_singular_as_it_is_renewed_is_an_error(factorised):
    _, _, factor, changed = factorised
    changed.data[changed.indptr[0] : changed.indptr[9]] = 0.0
    with pytest.raises(RuntimeError, match="singular"):
        factor.renew(changed, 1e-3, 1.0)


def test_an_lu_is_renewed_where_entries_have_changed_to_the_bits_of_a_new_one(factorised, monkeypatch):
    fronts, matrix, factor, changed = factorised
    eliminated = []
    subtree = multifrontal._Elimination._subtree
    monkeypatch.setattr(
        multifrontal._Elimination, "_subtree", lambda self, span: eliminated.append(span) or subtree(self, span)
    )
    for now in (changed, matrix, changed):
        eliminated.clear()
        assert factor.renew(now, 1e-9, 0.9)
        assert 0 < len(eliminated) < 3
        assert np.array_equal(factor.solve(RIGHT), fronts.rough_factor(now).solve(RIGHT))
    # entries across the border of a subtree belong to it from both sides
    for entry in range(0, len(matrix.data), 97):
        now = changed.copy()
        now.data[entry] += 1.0
        assert factor.renew(now, 1e-9, 1.0)
        assert np.array_equal(factor.solve(RIGHT), fronts.rough_factor(now).solve(RIGHT))


def test_a_factor_serves_matrices_nearby_as_long_as_it_pays(factorised, monkeypatch):
    fronts, matrix, _, changed = factorised
    made = counted(monkeypatch, Multifrontal, "rough_factor")
    largest = np.abs(matrix.data).max()
    near = Sequence(fronts, same=0.0)
    assert near.solve(matrix, RIGHT, 1e-9, 0.0) is not None
    for size in (0.9 * nearby.OPTIONS.change * largest, 3.0):  # by GMRES alone, and where an entry's subtree is renewed
        now = changed.copy()
        now.data[:200] += size
        found = near.solve(now, RIGHT, 1e-9, 0.0)
        assert np.linalg.norm(now @ found - RIGHT) <= 1.1e-9 * np.linalg.norm(RIGHT)
        assert np.linalg.norm(fronts.factor(matrix).solve(RIGHT) - found) > 1e-4 * np.linalg.norm(found)
    assert near.solve(changed, np.zeros_like(RIGHT), 1e-9, 0.0) == pytest.approx(np.zeros_like(RIGHT), abs=0.0)
    assert len(made) == 1
    near.solve(shifted(matrix, -30.0), RIGHT, 1e-9, 0.0)
    assert len(made) == 2  # all has changed
    monkeypatch.setattr(multifrontal, "OPTIONS", replace(multifrontal.OPTIONS, multiplications=1e9))
    dear = Sequence(fronts, same=0.0)
    now = matrix.copy()
    now.data[:200] += 0.9 * nearby.OPTIONS.change * largest
    for one, factorisations in ((matrix, 3), (now, 3), (now, 4)):  # at last a new one is cheaper
        assert dear.solve(one, RIGHT, 1e-9, 0.0) is not None and len(made) == factorisations


def test_a_sequence_of_solutions_renews_what_serves_and_leaves_the_rest_to_exact_factors(factorised, monkeypatch):
    fronts, matrix, _, changed = factorised
    made = counted(monkeypatch, Multifrontal, "rough_factor")
    steps = Sequence(fronts, same=1e-6)
    for now, shift, factorisations in ((matrix, 0.0, 1), (changed, 1e-7, 1), (matrix, 1.0, 2)):
        found = steps.solve(now, RIGHT, 1e-9, shift)
        assert np.linalg.norm(now @ found - RIGHT) <= 1.1e-9 * np.linalg.norm(RIGHT)
        assert len(made) == factorisations and steps.factor is not None
    assert steps.solve(0.0 * matrix, RIGHT, 1e-9, 1.0) is None  # singular
    assert steps.factor is None
    monkeypatch.setattr(nearby, "OPTIONS", replace(nearby.OPTIONS, most=1))
    assert steps.solve(matrix, RIGHT, 1e-14, 0.0) is None  # one product of single precision is not enough


def test_a_path_with_renewed_factors_is_the_path(monkeypatch):
    smooth = {"preparation__gravity": "frictionless", "loads": pushed(0.0, -12.0)}
    problem, rest = at_rest(scene(9, 19, contact__friction=0.2, **smooth))
    roughly = counted(monkeypatch, Multifrontal, "rough_factor")
    alone = follow(problem, rest, [1.0])[0]
    monkeypatch.setattr(ordering, "WIDEST_BAND", 0)
    monkeypatch.setattr(multifrontal, "OPTIONS", replace(multifrontal.OPTIONS, large=0))
    left, solve = [], Sequence.solve

    def watched(steps, matrix, right, most, shift):
        found = solve(steps, matrix, right, most, shift)
        if found is not None:
            left.append(np.linalg.norm(matrix @ found - right) / np.linalg.norm(right))
        return found

    monkeypatch.setattr(Sequence, "solve", watched)
    kept = follow(problem, rest, [1.0])[0]
    assert 0 < len(roughly) < 0.5 * kept.reached.increments
    assert 1e-7 < max(left) < 1.01e-6  # of a force out of balance, by the factorisation of another tangent
    # what increments leave out of events
    assert kept.walls.normal_force == pytest.approx(alone.walls.normal_force, abs=12.0 * 1e-5)
    assert kept.reached.certificate.force_residual < 1e-10


def test_no_other_factorisation_is_in_memory_when_eigenvalues_are_looked_for(monkeypatch):
    monkeypatch.setattr(ordering, "WIDEST_BAND", 0)
    monkeypatch.setattr(multifrontal, "OPTIONS", replace(multifrontal.OPTIONS, large=0))
    smooth = {"preparation__gravity": "frictionless", "loads": pushed(0.0, -28.0)}
    problem, rest = at_rest(scene(4, 9, contact__friction=1.0, **smooth))
    state = follow(problem, rest, [1.0])[0]
    system = StaticSystem(problem, state)
    trial = system.at(state)
    force = np.ones(system.dof)
    alive = weakref.WeakSet()
    most = []
    for name in ("rough_factor", "definite_factor", "factor"):
        make = getattr(Multifrontal, name)

        def counting(self, *arguments, make=make, **options):
            made = make(self, *arguments, **options)
            if made is not None:
                alive.add(made)
            most.append(len(alive))
            return made

        monkeypatch.setattr(Multifrontal, name, counting)
    system.step(trial, force)
    system.definite_step(trial, force, 4.0 * problem.stiffness)
    assert len(alive) == 1  # that of the step
    before = len(most)
    assert Spectrum(system, trial).negative_modes == 0
    assert len(most) > before + 1  # it was a suspicion
    assert max(most[before:]) == 1
