"""The shape of a response, the crossover of a path, and their statistics on hand-made ensembles."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from claims_data import dataset
from places import ROOT

from granular_response.plot import style
from granular_response.store import files as store
from granular_response.studies import linear_end
from granular_response_paper.claims import bounds
from granular_response_paper.ensembles import AT_REST, COLLAPSED, NOT_REACHED
from granular_response_paper.groups.phase_diagram import draw as figures
from granular_response_paper.groups.phase_diagram.parameters import Parameters
from granular_response_paper.groups.phase_diagram.simulate import read_ensemble, simulate
from granular_response_paper.survey import datasets as survey
from granular_response_paper.survey.crossover import (
    ABOVE,
    BELOW,
    FOUND,
    Ensemble,
    censored_medians,
    cross,
    crossover,
    folded,
    grown,
    lean,
    passed,
    seen_in_samples,
    shape,
    shape_of_single,
    shapes_of_samples,
    singles,
    weights,
)

X = np.arange(0.0, 30.5, 0.5)


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


def test_mean_leaves_out_what_is_not_at_rest() -> None:
    ensemble = make_ensemble(1.0, 4)
    ensemble.response[1, 3] = np.nan
    np.testing.assert_allclose(ensemble.mean()[3], ensemble.response[[0, 2, 3], 3].mean(axis=0))
    strict = replace(ensemble, least=4)
    assert np.isnan(strict.mean()[3]).all()
    assert np.isfinite(strict.mean()[:3]).all()


def test_weights_count_a_realization_as_often_as_it_is_drawn() -> None:
    ensemble = make_ensemble(1.0, 3)
    weighted = ensemble.means(np.array([[2.0, 0.0, 1.0]]))[0]
    np.testing.assert_allclose(weighted, ensemble.response[[0, 0, 2]].mean(axis=0))


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


def test_read_ensemble_smooths_both_sides() -> None:
    at = np.array([-4.0, 0.0, 4.0])
    source = xr.Dataset(
        {
            "force": (("case", "step"), [[1.0, 2.0, np.nan]]),
            "x": (("case", "realization", "slot"), [[[*at, np.nan], [*at, np.nan]]]),
            "floor_response": (
                ("case", "realization", "step", "slot"),
                [[[[0.0, 0.0, 1.0, np.nan]] * 3, [[1.0, 0.0, 0.0, np.nan]] * 3]],
            ),
            "outcome": (("case", "realization", "step"), [[[AT_REST] * 3, [AT_REST, COLLAPSED, 3]]]),
        },
        coords={"realizations": (("case",), [2])},
    )
    ensemble = read_ensemble(source, 0, X, 2.0, Parameters.model_construct(least_part=0.5, tolerance=0.0))
    np.testing.assert_array_equal(ensemble.force, [1.0, 2.0])
    assert ensemble.least == 1
    np.testing.assert_allclose(ensemble.response[0, 0], ensemble.response[1, 0, ::-1])  # mirror images
    assert ensemble.response.shape[-1] == 2 * len(X) - 1
    symmetric = folded(ensemble.response)
    np.testing.assert_allclose(symmetric[0, 0], symmetric[1, 0])
    assert X[np.argmax(symmetric[0, 0])] == 4.0
    np.testing.assert_allclose(symmetric[0, 0].max(), 0.5 * ensemble.response[0, 0].max(), rtol=1e-5)
    assert np.isnan(symmetric[1, 1]).all()
    np.testing.assert_allclose(lean(ensemble.response[0, 0]), 1.0, rtol=1e-6)
    np.testing.assert_allclose(lean(ensemble.response[:, 0].mean(axis=0)), 0.0, atol=1e-15)


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


def test_single_realizations_and_their_mean() -> None:
    """Two mirror images: each leans, their mean does not; one collapses before its crossover and is censored."""
    one = np.exp(-(((np.concatenate([-X[:0:-1], X]) - 12.0) / 6.0) ** 2))
    side = one + 0.5 * one[::-1]
    middle = bumps(0.0)
    single = np.concatenate([middle[:0:-1], middle])
    response = np.array([[single, side], [single, side[::-1]], [single, np.full(side.size, np.nan)]])
    found = singles(Ensemble(np.array([1.0, 4.0]), response, X, 6.0, 2), draws=50, seed=0)
    assert found.middle(1.0, 4.0).kind == FOUND and 1.0 < found.median < 4.0  # two of three reach it
    np.testing.assert_allclose(found.asymmetry[:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(found.asymmetry[:2, 1], 0.5, atol=0.02)
    # the mean's two bumps are three quarters as high as the larger one of a realization
    np.testing.assert_allclose(found.difference[:2, 1], 1.0 / 3.0, atol=0.05)
    assert np.isnan(found.difference[2, 1])
    means = shape(X, folded(response[:2].mean(axis=0)), 6.0)
    np.testing.assert_allclose(found.largest_step, means[1] - means[0])
    np.testing.assert_allclose(found.spread[0], 0.0, atol=1e-8)
    assert found.spread[1] > 0.05


SIZES = {"lattice": (0.0, 0.2, 1), "few": (0.1, 0.2, 8), "many": (0.1, 0.5, 10)}


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Blocks of slabs whose two peaks part from one as the force grows, at two frictions, and a lattice."""
    disks = np.arange(-60.0, 61.0, 2.0)
    folder = tmp_path_factory.mktemp("survey")
    rng = np.random.default_rng(2)
    for block, (delta, mu, count) in SIZES.items():
        force = np.array([1.0, 2.0, 4.0, 8.0, 16.0])[: 4 if block != "many" else 5]
        shift = rng.normal(0.0, 1.0, (count, force.size)) if count > 1 else 0.0
        away = np.maximum(0.0, 4.0 + 3.0 * np.log2(force) - (3.0 if mu > 0.2 else 0.0) + shift)
        sides = (disks + side * np.broadcast_to(away, (1, count, force.size))[..., None] for side in (-1.0, 1.0))
        response = sum(np.exp(-((x / 6.0) ** 2)) for x in sides)
        response /= response.sum(axis=-1, keepdims=True)
        outcome = np.zeros((1, count, force.size), np.int8)
        if block == "few":  # one collapses under the largest force
            outcome[0, 0, -1], response[0, 0, -1] = COLLAPSED, np.nan
        cases = {"polydispersity": delta, "friction": mu, "wall_friction": mu, "lattice_constant": "touching-largest"}
        cases |= {"gravity_ramp": ""} if block != "few" else {}  # as blocks that do not say it
        cases = {name: ("case", [value]) for name, value in (cases | {"realizations": count}).items()}
        ensembles = dataset(
            cases,
            force=(("case", "step"), force[None]),
            x=(("case", "realization", "slot"), np.tile(disks, (1, count, 1))),
            floor_response=(("case", "realization", "step", "slot"), response),
            outcome=(("case", "realization", "step"), outcome),
        )
        several = rng.normal(0.0, 0.01, (1, count))
        contacts = {"coordination_number_with_walls": 4.0, "horizontal_contacts": 0.9, "oblique_contacts": 1.8}
        if delta:  # three of the four missing contacts are horizontal
            contacts = {"coordination_number_with_walls": 4.2, "horizontal_contacts": 0.6, "oblique_contacts": 1.7}
        packings = dataset(
            cases, **{name: (("case", "realization"), value + several) for name, value in contacts.items()}
        )
        store.write(folder / f"{block}.nc", {"ensembles": ensembles, "packings": packings})
    return folder


def test_blocks_of_different_size_become_one(stored) -> None:
    found = survey.read(stored, list(SIZES))
    ensembles = found["ensembles"]
    assert dict(ensembles.sizes) == {"case": 3, "realization": 10, "step": 5, "slot": 61}
    assert ensembles["realizations"].values.tolist() == [1, 8, 10]
    for case, (block, (_, _, count)) in enumerate(SIZES.items()):
        alone = store.read(stored / f"{block}.nc")["ensembles"].isel(case=0)
        steps = alone.sizes["step"]
        response = ensembles["floor_response"].values[case, :count, :steps]
        np.testing.assert_array_equal(response, alone["floor_response"].values)
        assert np.isnan(ensembles["floor_response"].values[case, count:]).all()
        assert (ensembles["outcome"].values[case, count:] == NOT_REACHED).all()
        assert np.isnan(ensembles["force"].values[case, steps:]).all()
    assert found["packings"]["coordination_number_with_walls"].shape == (3, 10)
    assert ensembles["gravity_ramp"].values.tolist() == ["", "", ""]
    twice = survey.read(stored, [*SIZES, "few"])["ensembles"]  # the first of two cases that are prepared alike
    assert twice.sizes["case"] == 3 and survey.usual(twice).sizes["case"] == 3


def parameters(stored, **changes) -> Parameters:
    given = {
        "draws": 50, "numbers": [5], "seed": 0, "least_part": 0.5,
        "spacing": 0.5, "reach": 30.0, "widths": [3.0, 6.0],
        "tolerance": 0.01, "other_tolerances": [0.0, 0.05], "survey": str(stored), "blocks": list(SIZES),
        "linear_range": "few", "linear_width": 3.0, "compared": [{"polydispersity": 0.1, "force": 4.0}],
    }  # fmt: skip
    return Parameters(**given | changes)


def test_from_stored_ensembles_to_a_diagram(stored, tmp_path) -> None:
    found = simulate(parameters(stored))
    again = simulate(parameters(stored))
    for name, one in found.items():
        xr.testing.assert_identical(one, again[name])
    data = found["crossovers"]
    assert data["kind"].values[1].tolist() == [FOUND] * 3
    force, interval = data["force"].values[1], data["interval"].values[1]
    assert 1.7 < force[2] / force[1] < 2.4  # three radii later: twice the force
    np.testing.assert_allclose(interval[0], force[0])  # one packing has no scatter
    assert np.all(interval[1:, 0] < force[1:])
    assert np.all(force[1:] < interval[1:, -1])
    np.testing.assert_allclose(data["limits"].values[1], [[1.0, 8.0], [1.0, 8.0], [1.0, 16.0]])
    # more smoothing merges the peaks at larger forces, and so does a larger tolerance
    assert np.all(data["force"].values[0] < force)
    others = found["definitions"]["force"].values[1]
    assert np.all(others[:, 0] < force) and np.all(force < others[:, 1])
    single = found["realizations"]
    assert single["collapse_force"].values[1, 0] == 8.0
    assert np.isnan(single["collapse_force"].values[1, 1:]).all()
    np.testing.assert_array_equal(found["medians"]["force"], single["median"])  # none beyond a path
    np.testing.assert_array_equal(found["linear_range"]["profile_change"].values[..., 0], 0.0)
    assert np.nanmin(found["linear_range"]["profile_change"].values[..., -1]) > 0.1
    side = found["starts"]
    assert side["friction"].values.tolist() == [0.2, 0.5]
    np.testing.assert_allclose(side["distance"], 2.0 / 0.95)
    np.testing.assert_allclose(side["contacts"], 4.2, atol=0.02)
    np.testing.assert_allclose(side["missing_horizontal"], 0.75, atol=0.02)
    np.testing.assert_array_equal(side["dip"].values[:, 0], found["shapes"]["shape"].values[:, 1, 2])
    store.write(tmp_path / "phase_diagram.nc", found)
    drawn = figures.draw(store.read(tmp_path / "phase_diagram.nc"))
    assert list(drawn) == ["fig22_phase_diagram", "initial_lattice"]
    (axes,) = drawn["fig22_phase_diagram"].axes
    marks = [line for line in axes.get_lines() if line.get_marker() in figures.MARKERS]
    found = [y for line in marks for y in line.get_ydata()]
    found += [float(text.get_text()[2:]) for text in axes.texts if text.get_text()[:1] in tuple("≤>")]
    assert sorted(found) == pytest.approx(sorted(force), rel=1e-3)
    for figure in drawn.values():
        assert style.render(figure, "png", dpi=40).startswith(b"\x89PNG")


def test_the_tolerance_is_the_bound_of_the_word() -> None:
    """So that the figure and the claims tell one peak from two alike; others are half and twice as large."""
    section = yaml.safe_load((ROOT / "params.yaml").read_text())["phase_diagram"]
    visible = bounds.THRESHOLDS["visible"]
    assert section["tolerance"] == visible
    assert {*bounds.varied(visible)} <= set(section["other_tolerances"])
