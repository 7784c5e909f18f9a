"""Moduli of small packings and the slabs that they predict, from parameters through a file."""

import numpy as np
import pytest

from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import response_of_layers
from granular_response_extensions.moduli.claims import CLAIMS
from granular_response_extensions.moduli.simulate import lattices, response, sizes
from granular_response_paper.claims.claim import Data
from granular_response_paper.claims.verdict import judge


def test_lattices_have_the_moduli_of_the_closed_form(datasets):
    ideal = datasets["lattice"]
    for rotations in ideal["rotations"].values:
        measured = ideal["moduli"].sel(following=rotations)
        # gravity presses the lattice together by some 1e-3 of a radius, and the rows of closed contacts as much
        assert measured.values == pytest.approx(ideal["closed_form"].sel(rotations=rotations).values, abs=3e-3)
    assert ideal["turn"].values == pytest.approx(ideal["turn_closed_form"].values, abs=1e-3)


def test_lattices_turn_later_the_larger_and_before_the_slab_of_their_moduli(datasets):
    small, large = datasets["lattice"]["turn_response"].values
    assert small < large < float(datasets["lattice"]["turn_closed_form"].sel(body="smooth floor", rotations="free"))


def test_packings_that_relax_are_softer(datasets):
    moduli = datasets["packings"]["moduli"].isel(case=0)
    affine, free = (moduli.sel(following=name, modulus=["a", "b", "d"]).values for name in ("affine", "free"))
    there = np.isfinite(affine)
    assert there.any() and (affine[there] > free[there]).all()


def test_the_prediction_is_the_elastic_slab_between_walls():
    solid = lattice.moduli(Springs.uniform(1.0, 0.5), "free")
    layers, period = 10, 60.0
    height = np.sqrt(3.0) * layers
    given = np.array([solid.a, solid.b, solid.c, solid.d])
    found = response.prediction(given, height, period, "rough", np.array([2.0, 3.0]))
    x = np.arange(-0.5 * period + 1.0, 0.5 * period, 2.0)
    shares = response_of_layers(x, layers=layers, moduli=solid, floor="rough", width=period)
    around = np.concatenate([x - period, x, x + period])
    smooth = response.smoothed_response(response.PLACES * height, around, np.tile(shares, 3), 3.0) * height
    assert found[1] == pytest.approx(smooth, abs=0.02)  # shares stand for the pressure on two radii
    assert np.isnan(response.prediction(-given, height, period, "rough", np.array([3.0]))).all()


def test_the_nearest_isotropic_solid_is_isotropic_and_leaves_one_that_is():
    solid = Moduli.isotropic(0.3)
    given = np.array([solid.a, solid.b, solid.c, solid.d])
    assert response.nearest_isotropic(given) == pytest.approx(given)
    a, b, c, d = response.nearest_isotropic(np.array([1.0, 2.0, 0.3, 0.8]))
    assert a == b and d == pytest.approx(a - c)


def test_the_layers_of_a_power_law_are_found():
    layers = np.array([8.0, 16.0, 32.0])
    values = 2.0 / layers[:, None] * np.array([0.9, 1.0, 1.1, 1.0])
    found = sizes.needed(layers, values, np.array([0.1, 0.01]), 400, 0)
    assert found[:, 0] == pytest.approx([20.0, 200.0])
    assert (found[:, 1] < found[:, 0]).all() and (found[:, 0] < found[:, 2]).all()
    assert np.isinf(sizes.needed(layers, 0.1 * layers[:, None] * np.ones(3), np.array([0.1]), 10, 0)).all()
    assert np.isnan(sizes.needed(layers, values[:, :2], np.array([0.1]), 10, 0)).all()


def test_a_limit_in_the_number_of_layers_is_found():
    layers = np.array([11.0, 21.0, 15.0])
    assert lattices.at_infinity(layers, 0.3 - 0.2 / layers) == pytest.approx([0.3, 0.3])
    curved = lattices.at_infinity(layers, 0.3 - 0.2 / layers + 0.5 / layers**2)
    assert curved[1] == pytest.approx(0.3) and abs(curved[0] - 0.3) < 2e-3
    assert np.isnan(lattices.at_infinity(layers[:2], layers[:2])[1])


def test_a_root_is_found_between_points():
    y = np.array([-3.0, -2.0, -1.0, 0.5, 2.0])
    x = 0.25 + 0.01 * y + 1e-3 * y**2
    assert lattices.root(x, y) == pytest.approx(0.25)
    assert np.isnan(lattices.root(x, x))


def test_claims_are_judged(datasets):
    for claim in CLAIMS:
        entry = judge(claim, Data({"moduli": datasets}))
        assert len(entry.tests) == 2  # of the case with friction and the one without
        assert ["friction 0," in test.case for test in entry.tests].count(True) == 1
