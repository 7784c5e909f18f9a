"""The shape of a response, the crossover of a path, and their statistics on hand-made ensembles."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from places import ROOT

from granular_response.studies import linear_end
from granular_response_paper.claims import bounds
from granular_response_paper.survey import datasets as survey
from granular_response_paper.survey.crossover import (
    ABOVE,
    BELOW,
    FOUND,
    Ensemble,
    censored_medians,
    cross,
    folded,
    grown,
    passed,
    seen_in_samples,
    shape,
    shape_of_single,
    shapes_of_samples,
    weights,
)

X = np.arange(0.0, 30.5, 0.5)


def crossover(force, shapes, tolerance=0.0):
    """Of one path."""
    return passed(force, grown(shapes), tolerance)


def bumps(distance: float) -> np.ndarray:
    """Two bumps, one on each side, as a symmetric response."""
    return np.exp(-(((X - distance) / 6.0) ** 2)) + np.exp(-(((X + distance) / 6.0) ** 2))


def test_shape_tells_one_peak_from_two() -> None:
    assert shape(X, bumps(0.0), 6.0) < 0.0
    assert shape(X, bumps(12.0), 6.0) > 0.5
    one, two = bumps(0.0), bumps(12.0)
    np.testing.assert_allclose(shape(X, np.stack([one, two]), 6.0), [shape(X, one, 6.0), shape(X, two, 6.0)])
    # the largest response is the scale
    np.testing.assert_allclose(shape(X, 7.0 * bumps(12.0), 6.0), shape(X, bumps(12.0), 6.0))


@pytest.mark.parametrize(
    ("shapes", "expected"),
    [
        ([-0.1, -0.1, 0.1, 0.3], (np.sqrt(2.0 * 4.0), FOUND)),
        ([-0.1, -0.3, 0.2, 0.2], (2.0 * 2.0**0.5, FOUND)),  # a dip before it moves nothing far away
        ([0.01, -0.2, -0.1, 0.3], (4.0 * 2.0 ** (0.29 / 3.0 / (0.29 / 3.0 + 0.3)), FOUND)),  # a chance dip at 1
        ([-0.1, -0.3, 0.1, -0.2], (8.0, ABOVE)),  # a chance dip at 4
        ([0.1, 0.2, 0.3, 0.4], (1.0, BELOW)),
        ([-0.4, -0.3, -0.2, -0.1], (8.0, ABOVE)),
        ([-0.4, -0.3, np.nan, np.nan], (2.0, ABOVE)),
        ([np.nan, np.nan, np.nan, np.nan], (np.nan, ABOVE)),
    ],
)
def test_crossover(shapes, expected) -> None:
    force, kind = crossover(np.array([1.0, 2.0, 4.0, 8.0]), np.array(shapes))
    np.testing.assert_allclose(force, expected[0])
    assert kind == expected[1]


def test_crossovers_of_many_paths_are_those_of_each() -> None:
    """With unknown shapes at the end of a path, in its middle and all along it."""
    rng = np.random.default_rng(0)
    force = np.array([1.0, 2.0, 3.0, 5.0, 8.0])
    shapes = rng.normal(0.0, 0.1, (40, 5)).cumsum(axis=1)
    shapes[::4, 3:], shapes[1::5, 1], shapes[7] = np.nan, np.nan, np.nan
    many = passed(force, grown(shapes), 0.01)
    for row, value, kind in zip(shapes, *many, strict=True):
        known = np.isfinite(row)
        expected = crossover(force[known], row[known], 0.01) if known.any() else (np.nan, ABOVE)
        np.testing.assert_equal((value, kind), expected)
    assert {FOUND, BELOW, ABOVE} == set(many[1].tolist())


def make_ensemble(spread: float, size: int = 40) -> Ensemble:
    """Responses whose bumps part in proportion to the logarithm of the force, with scatter."""
    force = np.array([1.0, 2.0, 4.0, 8.0])
    rng = np.random.default_rng(1)
    scatter = rng.normal(0.0, spread, size)
    response = np.stack([[bumps(max(0.0, 3.0 + 2.0 * np.log2(f) + s)) for f in force] for s in scatter])
    return Ensemble(force, response, X, 6.0)


def alone(responses) -> Ensemble:
    """Responses (r, x) to one force."""
    return Ensemble(np.array([1.0]), responses[:, None], X, 6.0)


def test_bootstrap_interval_narrows_with_the_scatter_and_holds_the_crossover() -> None:
    wide, narrow = (cross(make_ensemble(spread), number=5, draws=300, seed=0) for spread in (2.0, 0.2))
    for found in (wide, narrow):
        assert found.kind == FOUND
        assert found.interval[0] <= found.force <= found.interval[-1]
    assert 0.0 < np.ptp(narrow.interval) < 0.3 * np.ptp(wide.interval)


def test_a_large_ensemble_knows_better_how_far_its_means_dip() -> None:
    """Means of fifteen alike dip as each does; of a mixed ensemble by something between, known the better the more."""
    for place in (0.0, 12.0):
        alike = shapes_of_samples(alone(np.tile(bumps(place), (40, 1))), 0, 15, seed=0)
        np.testing.assert_allclose(alike, shape(X, bumps(place), 6.0), atol=1e-12)
    # two thirds of the packings have one peak and the others two, so that means of fifteen have either
    whole = np.stack([bumps(4.0), bumps(4.0), bumps(11.0)])
    shapes = [shapes_of_samples(alone(np.tile(whole, (n, 1))), 0, 15, seed=0) for n in (5, 60)]
    assert 0.1 < np.mean(shapes[1] > 0.0) < 0.9
    few, many = (np.ptp(np.quantile(np.mean(one > 0.0, axis=1), [0.025, 0.975])) for one in shapes)
    assert many < 0.7 * few


def test_a_crossover_is_seen_in_samples_of_an_ensemble_that_has_one() -> None:
    force = np.array([1.0, 2.0, 4.0])
    path = np.stack([bumps(0.0), bumps(4.0), bumps(12.0)])
    for responses, expected in ((path, 1.0), (path[[0, 0, 0]], 0.0), (path[[2, 2, 2]], 0.0)):
        alike = Ensemble(force, np.tile(responses, (20, 1, 1)), X, 6.0, 10)
        np.testing.assert_array_equal(seen_in_samples(alike, 5, seed=0, draws=3, samples=4), expected)
    # half of the packings never split, and three of five must be at rest at the last force
    mixed = np.stack([path, path[[0, 0, 0]]] * 10)
    few = seen_in_samples(Ensemble(force, mixed, X, 6.0, 10), 5, seed=0, draws=20)
    assert 0.0 < few.mean() <= 1.0
    mixed[:12, 2] = np.nan
    fewer = seen_in_samples(Ensemble(force, mixed, X, 6.0, 10), 5, seed=0, draws=20)
    assert fewer.mean() < few.mean()


def test_one_peak_beside_the_middle_is_one() -> None:
    """Made symmetric it would be two; two peaks of different height are two."""
    both = np.concatenate([-X[:0:-1], X])
    one = np.exp(-(((both - 12.0) / 6.0) ** 2))
    assert shape(X, folded(one), 6.0) > 0.5
    assert shape_of_single(X, one, 6.0) < 0.01
    two = one + 0.5 * one[::-1]
    assert shape_of_single(X, two, 6.0) == pytest.approx(0.5, abs=0.05)
    symmetric = one + one[::-1]
    assert shape_of_single(X, symmetric, 6.0) == pytest.approx(float(shape(X, folded(symmetric), 6.0)))


def test_crossing_counts_draws_beyond_the_path() -> None:
    """Where the crossover lies at the end of the path, some draws have none, and the interval is open."""
    whole = make_ensemble(3.0, 12)
    ensemble = replace(whole, force=whole.force[:2], response=whole.response[:, :2])
    found = cross(ensemble, number=5, draws=200, seed=0)
    assert 0.0 < np.mean(found.draws == np.inf) < 1.0
    assert found.interval[-1] == np.inf
    assert np.all(np.diff(found.shape_interval, axis=1) >= 0.0)


def test_linear_end() -> None:
    force = np.array([1.0, 2.0, 3.0, 4.0])
    assert linear_end(force, np.array([1.0, 1.02, 0.9, 1.0]), 0.05) == (2.0, 3.0)
    last, after = linear_end(force, np.array([1.0, 1.02, 0.99, np.nan]), 0.05)
    assert last == 3.0
    assert np.isnan(after)


def test_a_tolerance_moves_the_crossover() -> None:
    force, shapes = np.array([1.0, 2.0, 4.0]), np.array([-0.1, 0.1, 0.3])
    assert crossover(force, shapes)[0] == pytest.approx(2.0**0.5)
    assert crossover(force, shapes, 0.1)[0] == pytest.approx(2.0)
    assert crossover(force, shapes, 0.2)[0] == pytest.approx(2.0 * 2.0**0.5)
    assert crossover(force, shapes, 0.3) == (4.0, ABOVE)
    assert crossover(force, shapes + 0.15, 0.04) == (1.0, BELOW)


def test_cases_of_as_many_realizations_are_drawn_alike() -> None:
    """So the ratio of two crossovers that share their scatter has little of its own."""
    one = make_ensemble(1.5)
    twice = replace(one, force=2.0 * one.force)
    first, second = (cross(e, number=5, draws=100, seed=0).draws for e in (one, twice))
    known = np.isfinite(first) & np.isfinite(second)
    assert known.mean() > 0.9
    np.testing.assert_allclose(second[known] / first[known], 2.0)
    assert np.std(first[known]) > 0.01 * np.mean(first[known])
    assert not np.array_equal(weights(40, 5, 0), weights(40, 5, 1))
    assert (weights(40, 5, 0).sum(axis=1) == 40.0).all()


@pytest.mark.parametrize(
    ("values", "censored", "expected"),
    [
        ([1.0, 2.0, 3.0], [0, 0, 0], 2.0),
        ([3.0, 1.0, 2.0, 4.0], [0, 0, 0, 0], 2.0),
        ([1.0, 2.0, 3.0, 4.0, 5.0], [0, 1, 0, 0, 0], 4.0),  # what lies beyond 2 counts for what comes later
        ([1.0, 2.0, 2.0, 2.0], [0, 1, 1, 1], np.inf),
        ([-np.inf, -np.inf, 3.0], [0, 0, 0], -np.inf),
        ([2.0, 2.0], [1, 0], 2.0),  # at the same force the censored one outlasts the other
    ],
)
def test_the_median_counts_censored_values_as_long_as_they_last(values, censored, expected) -> None:
    once = np.ones((1, len(values)))
    assert censored_medians(np.array(values), np.array(censored, bool), once).tolist() == [expected]


def test_a_value_that_counts_several_times_is_as_many_values() -> None:
    rng = np.random.default_rng(0)
    values, censored = rng.integers(0, 6, 12).astype(float), rng.random(12) < 0.6
    drawn = weights(12, 200, 0)
    medians = censored_medians(values, censored, drawn)
    for count, median in zip(drawn.astype(int), medians, strict=True):
        there, beyond = np.repeat(values, count), np.repeat(censored, count)
        once = np.ones((1, len(there)))
        assert censored_medians(there, beyond, once).tolist() == [median]
    assert np.isinf(medians).any() and np.isfinite(medians).any()


def test_a_case_of_several_blocks_is_read_once_and_gravity_acts_at_once_where_nothing_else_is_said() -> None:
    once, twice = (
        survey.read(ROOT / "data" / "survey", ["lattice", *["delta_25"] * times])["ensembles"] for times in (1, 2)
    )
    xr.testing.assert_identical(twice, once)
    assert set(once["gravity_ramp"].values.tolist()) == {""} and survey.usual(once).sizes == once.sizes


def test_the_tolerance_is_the_bound_of_the_word() -> None:
    """So that the figure and the claims tell one peak from two alike; others are half and twice as large."""
    section = yaml.safe_load((ROOT / "params.yaml").read_text())["phase_diagram"]
    visible = bounds.THRESHOLDS["visible"]
    assert section["tolerance"] == visible
    assert {*bounds.varied(visible)} <= set(section["other_tolerances"])
