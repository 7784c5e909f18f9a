"""What rolling resistance changes, on a pile and a slab of 5 layers, from parameters through a file to a figure."""

import numpy as np
import pytest

from granular_response_paper.groups.rolling import draw


def test_rolling_resistance_lowers_the_friction_that_holds_a_pile(datasets):
    found = datasets["thresholds"].sel(layers=5)
    assert ((found["high"] - found["low"]) <= 0.1).all() and (found["moved"] < 0.5).all()
    without, resisting = (float(found["high"].sel(rolling_friction=mu)) for mu in (0.0, 0.1))
    assert resisting < 0.5 * without
    weight = found["floor_force"].sum("floor_disk")
    assert weight.values == pytest.approx(1 + 4 + 7 + 10 + 13, abs=1e-8)  # the floor bears the pile


def test_walls_support_a_pile_that_stands_without_them(datasets):
    piles = datasets["piles"].sel(layers=5)
    assert (piles["moved"] < 0.5).all()
    forces = piles["floor_force"].values
    np.testing.assert_allclose(forces, forces[:, ::-1], atol=1e-6)  # piles are symmetric
    assert np.abs(forces[2] - forces[1]).max() < 0.1 * forces[1].max()


def test_only_rolling_resistance_hands_on_couples_between_equal_disks(datasets):
    couples = datasets["slabs"]["couple_stress"].sel(friction=0.2)
    assert (couples.sel(rolling_friction=0.0) == 0.0).all() and (couples.sel(rolling_friction=0.1) > 0.0).any()


def test_the_response_of_the_slab(datasets, num_regression):
    slabs = datasets["slabs"].sel(friction=0.2)
    np.testing.assert_allclose(slabs["elastic_response"].sum("floor_disk"), 1.0, atol=1e-9)
    names = ("elastic_response", "floor_response", "opening")
    num_regression.check(
        {name: slabs[name].values.ravel() for name in names}, default_tolerance={"rtol": 1e-5, "atol": 1e-8}
    )


def test_the_figure(datasets, looks_as_stored):
    drawn = draw.draw(datasets)
    assert list(drawn) == ["rolling"]
    looks_as_stored(drawn)
