"""Crossovers of slabs of 5 to 9 layers, through a file to the lines of the document."""

from itertools import product

import numpy as np
import pytest
import reduced

from granular_response_extensions.crossover_scaling.parameters import Parameters
from granular_response_extensions.crossover_scaling.simulate import series as study


@pytest.fixture(scope="module")
def parameters():
    return Parameters.model_validate(reduced.parameters("crossover_scaling"))


def of(datasets, series):
    slabs = datasets["slabs"]
    return slabs.isel(slab=np.flatnonzero(slabs["series"].values == series))


def opening_of_springs(layers, across, confinement):
    """Force at which the first horizontal contact of a lattice of springs opens: its own matrix, and no solver of ours.

    Springs of stiffness 1 between neighbours on the undeformed lattice, of 2 at the floor; periodic along x.
    """
    n = layers * across
    row, column = np.divmod(np.arange(n), across)

    def disk(r, c):
        return r * across + c % across

    right = [(k, disk(r, c + 1), 0.0) for k, (r, c) in enumerate(zip(row, column, strict=True))]
    up = [
        (k, disk(r + 1, c + shift + r % 2 - 1), np.pi / 3.0 * (2 - shift))
        for k, (r, c) in enumerate(zip(row, column, strict=True))
        if r < layers - 1
        for shift in (0, 1)
    ]
    matrix = np.zeros((2 * n, 2 * n))
    for i, j, angle in right + up:
        d = np.zeros(2 * n)
        d[[2 * i, 2 * i + 1]] = -np.cos(angle), -np.sin(angle)
        d[[2 * j, 2 * j + 1]] = np.cos(angle), np.sin(angle)
        matrix += np.outer(d, d)
    floor = 2 * np.arange(across) + 1
    matrix[floor, floor] += 2.0
    force = np.zeros(2 * n)
    force[2 * disk(layers - 1, across // 2) + 1] = -1.0
    moved = np.linalg.lstsq(matrix, force, rcond=None)[0]  # the smallest: nothing holds the whole along x
    stretch = np.array([moved[2 * j] - moved[2 * i] for i, j, _ in right])
    return confinement / stretch.max()


@pytest.mark.parametrize("at", [0, 1, 2])
def test_the_first_opening_is_that_of_a_lattice_of_springs(datasets, at):
    one = of(datasets, "constant confinement").isel(slab=at)
    expected = opening_of_springs(int(one["layers"]), int(one["disks_per_row"]), float(one["confinement"]))
    low, high = one["first_opening_bracket"].values
    assert 0.99 * low < expected < 1.01 * high


def test_powers_and_their_intervals_are_those_of_every_corner():
    at, middle = np.array([2.0, 4.0, 7.0, 9.0]), np.array([3.0, 13.0, 40.0, 70.0])
    low, high = 0.97 * middle, 1.03 * middle
    law = study.Power(at, low, high)

    def corners(points, what):
        ends = [list(pair) for pair in zip(low[points], high[points], strict=True)]
        fits = [np.polyfit(np.log(at[points]), np.log(values), 1) for values in product(*ends)]
        return [what(fit) for fit in fits]

    for found, what in (
        (law.exponent(), lambda fit: fit[0]),
        (law.at_size(1000.0), lambda fit: np.exp(np.polyval(fit, np.log(1000.0)))),
    ):
        every = corners(slice(None), what) + corners(slice(1, None), what)
        assert found[1:] == pytest.approx([min(every), max(every)])
        assert found[1] < found[0] < found[2]
    far = law.at_size(1000.0, 1.0)
    assert far[1] == pytest.approx(low[-1] * 1000.0 / 9.0)  # far below the fits
    assert far[2] == law.at_size(1000.0)[2]
    assert np.isnan(study.Power(at[:1], low[:1], high[:1]).exponent()).all()
    unseen = study.Power(at, low, np.array([*high[:3], np.nan]))
    assert unseen.exponent() == pytest.approx(study.Power(at[:3], low[:3], high[:3]).exponent())


def test_powers_of_the_continuum_are_known_where_there_is_one_scale(parameters):
    series = {one.name: one for one in parameters.series}
    known = {name: study.continuum(one) for name, one in series.items() if one.varied == "layers"}
    assert known == {"constant confinement": 1.0, "walls": 1.0, "friction": 2.0}
    assert study.continuum(series["friction"].model_copy(update={"confined": "constant"})) is None
