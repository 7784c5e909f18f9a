"""The shape of a response, the crossover of a path, and their statistics on hand-made ensembles."""

import numpy as np
import pytest
import xarray as xr

from granular_response.paper.ensembles import AT_REST, COLLAPSED
from granular_response.paper.groups.phase_diagram import draw as figures
from granular_response.paper.groups.phase_diagram.parameters import Parameters
from granular_response.paper.groups.phase_diagram.simulate import (
    ABOVE,
    BELOW,
    FOUND,
    Ensemble,
    agreement,
    bootstrap,
    cross,
    crossover,
    read_ensemble,
    shape,
    simulate,
)
from granular_response.paper.groups.polydisperse_averages.ensemble.averages import linear_end
from granular_response.plot import style
from granular_response.store import files as store

X = np.arange(0.0, 30.5, 0.5)


def bumps(distance: float) -> np.ndarray:
    """Two bumps, one on each side, as a symmetric response."""
    return np.exp(-(((X - distance) / 6.0) ** 2)) + np.exp(-(((X + distance) / 6.0) ** 2))


def test_shape_tells_one_peak_from_two() -> None:
    assert shape(X, bumps(0.0), 6.0) < 0.0
    assert shape(X, bumps(12.0), 6.0) > 0.5
    # the largest response is the scale
    np.testing.assert_allclose(shape(X, 7.0 * bumps(12.0), 6.0), shape(X, bumps(12.0), 6.0))


def test_shape_of_many() -> None:
    both = np.stack([bumps(0.0), bumps(12.0)])
    np.testing.assert_allclose(shape(X, both, 6.0), [shape(X, bumps(0.0), 6.0), shape(X, bumps(12.0), 6.0)])


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


def make_ensemble(spread: float, size: int = 40) -> Ensemble:
    """Responses whose bumps part in proportion to the logarithm of the force, with scatter."""
    force = np.array([1.0, 2.0, 4.0, 8.0])
    rng = np.random.default_rng(1)
    scatter = rng.normal(0.0, spread, size)
    response = np.stack([[bumps(max(0.0, 3.0 + 2.0 * np.log2(f) + s)) for f in force] for s in scatter])
    return Ensemble(force, response)


def test_bootstrap_interval_narrows_with_the_scatter_and_holds_the_crossover() -> None:
    widths = []
    for spread in (2.0, 0.2):
        ensemble = make_ensemble(spread)
        value, kind = crossover(ensemble.force, shape(X, ensemble.mean(), 6.0))
        assert kind == FOUND
        drawn = [crossover(ensemble.force, row) for row in bootstrap(ensemble, X, 6.0, draws=300, seed=0)]
        found = [force for force, kind in drawn if kind == FOUND]
        low, high = np.quantile(found, [0.025, 0.975])
        assert low <= value <= high
        widths.append(high - low)
    assert widths[1] < 0.3 * widths[0]
    assert widths[1] > 0.0


def test_bootstrap_is_reproducible() -> None:
    ensemble = make_ensemble(1.0)
    first, again, other = (bootstrap(ensemble, X, 6.0, draws=20, seed=seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_bootstrap_of_one_realization_has_no_scatter() -> None:
    ensemble = make_ensemble(1.0, 1)
    drawn = bootstrap(ensemble, X, 6.0, draws=5, seed=0)
    np.testing.assert_allclose(drawn, np.tile(shape(X, ensemble.response[0], 6.0), (5, 1)))


def test_mean_leaves_out_what_is_not_at_rest() -> None:
    ensemble = make_ensemble(1.0, 4)
    ensemble.response[1, 3] = np.nan
    np.testing.assert_allclose(ensemble.mean()[3], ensemble.response[[0, 2, 3], 3].mean(axis=0))
    strict = Ensemble(ensemble.force, ensemble.response, 4)
    assert np.isnan(strict.mean()[3]).all()
    assert np.isfinite(strict.mean()[:3]).all()


def test_weights_count_a_realization_as_often_as_it_is_drawn() -> None:
    ensemble = make_ensemble(1.0, 3)
    weighted = ensemble.means(np.array([[2.0, 0.0, 1.0]]))[0]
    np.testing.assert_allclose(weighted, ensemble.response[[0, 0, 2]].mean(axis=0))


def test_agreement_is_certain_far_from_the_crossover() -> None:
    part = agreement(make_ensemble(1.5), X, 6.0, 5, draws=200, seed=0)
    assert part[0] == 1.0
    assert part[-1] == 1.0
    assert part.min() < 1.0


def test_crossing_counts_draws_beyond_the_path() -> None:
    """Where the crossover lies at the end of the path, some draws have none, and the interval is open."""
    whole = make_ensemble(3.0, 12)
    ensemble = Ensemble(whole.force[:2], whole.response[:, :2])
    found = cross(ensemble, X, 6.0, few=5, draws=200, seed=0)
    np.testing.assert_allclose(found.kinds.sum(), 1.0)
    assert 0.0 < found.kinds[ABOVE] < 1.0
    assert found.interval[-1] == np.inf
    assert np.all(np.diff(found.spread, axis=1) >= 0.0)


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
    ensemble = read_ensemble(source, 0, X, 2.0, 0.5)
    np.testing.assert_array_equal(ensemble.force, [1.0, 2.0])
    assert ensemble.least == 1
    np.testing.assert_allclose(ensemble.response[0, 0], ensemble.response[1, 0])  # mirror images
    assert X[np.argmax(ensemble.response[0, 0])] == 4.0
    assert np.isnan(ensemble.response[1, 1]).all()


def test_linear_end() -> None:
    force = np.array([1.0, 2.0, 3.0, 4.0])
    assert linear_end(force, np.array([1.0, 1.02, 0.9, 1.0]), 0.05) == (2.0, 3.0)
    last, after = linear_end(force, np.array([1.0, 1.02, 0.99, np.nan]), 0.05)
    assert last == 3.0
    assert np.isnan(after)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Ensembles of ten slabs whose two peaks part from one as the force grows, at two frictions, and a lattice."""
    disks = np.arange(-60.0, 61.0, 2.0)
    force = np.array([1.0, 2.0, 4.0, 8.0])
    size = 10
    rng = np.random.default_rng(2)
    response = np.full((3, size, 4, len(disks)), np.nan)
    for case, later, count in ((0, 0.0, 1), (1, 0.0, size), (2, 3.0, size)):
        for r in range(count):
            for k, f in enumerate(force):
                away = max(0.0, 4.0 + 3.0 * np.log2(f) - later + (rng.normal(0.0, 1.0) if count > 1 else 0.0))
                both = np.exp(-(((disks - away) / 6.0) ** 2)) + np.exp(-(((disks + away) / 6.0) ** 2))
                response[case, r, k] = both / both.sum()
    source = xr.Dataset(
        {
            "force": (("case", "step"), np.tile(force, (3, 1))),
            "x": (("case", "realization", "slot"), np.tile(disks, (3, size, 1))),
            "floor_response": (("case", "realization", "step", "slot"), response),
            "outcome": (("case", "realization", "step"), np.zeros((3, size, 4), np.int8)),
        },
        coords={
            "polydispersity": (("case",), [0.0, 0.1, 0.1]),
            "friction": (("case",), [0.2, 0.2, 0.5]),
            "lattice_constant": (("case",), ["touching-largest"] * 3),
            "realizations": (("case",), [1, size, size]),
        },
    )
    for variable in source.variables.values():
        variable.attrs.update(long_name="made by hand", units="1")
    path = tmp_path_factory.mktemp("data") / "polydisperse_averages.nc"
    store.write(path, {"ensembles": source})
    return path


def test_from_stored_ensembles_to_a_diagram(stored, tmp_path) -> None:
    parameters = {"draws": 50, "few": 5, "seed": 0, "least_part": 0.5, "spacing": 0.5, "reach": 30.0}
    described = Parameters(**parameters, widths=[3.0, 6.0], responses=str(stored))
    found = simulate(described)
    again = simulate(described, workers=2)
    for name, dataset in found.items():
        xr.testing.assert_identical(dataset, again[name])
    data = found["crossovers"]
    assert data["kind"].values[1].tolist() == [FOUND] * 3
    force, interval = data["force"].values[1], data["interval"].values[1]
    assert 1.7 < force[2] / force[1] < 2.3  # three radii later: twice the force
    np.testing.assert_allclose(interval[0], force[0])  # one packing has no scatter
    assert np.all(interval[1:, 0] < force[1:])
    assert np.all(force[1:] < interval[1:, -1])
    # more smoothing merges the peaks at larger forces
    assert np.all(data["force"].values[0] < force)
    store.write(tmp_path / "phase_diagram.nc", found)
    drawn = figures.draw(store.read(tmp_path / "phase_diagram.nc"))
    assert list(drawn) == ["fig22_phase_diagram", "five_realizations"]
    lattice, disordered = drawn["fig22_phase_diagram"].axes[2:]  # the row of the larger width
    for axes, expected in ((lattice, force[:1]), (disordered, force[1:])):
        marks = [line for line in axes.get_lines() if line.get_marker() == "o"]
        assert sorted(y for line in marks for y in line.get_ydata()) == pytest.approx(sorted(expected))
    for figure in drawn.values():
        assert style.render(figure, "png", dpi=40).startswith(b"\x89PNG")


@pytest.mark.parametrize(("key", "value", "named"), [("draws", 0, "draws = 0"), ("least_part", 0.0, "least_part = 0")])
def test_bad_parameter_is_named(key, value, named) -> None:
    parameters = {"draws": 10, "few": 5, "seed": 0, "least_part": 0.5, "spacing": 0.5, "reach": 30.0, "widths": [6.0]}
    with pytest.raises(ValueError, match=f"{named}.*: must be"):
        Parameters(**{**parameters, "responses": "nowhere.nc", key: value})
