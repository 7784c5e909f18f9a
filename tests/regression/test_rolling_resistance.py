"""What rolling resistance changes, on a pile and a slab of 5 layers, from parameters through a file to a figure."""

import numpy as np
import pytest

from granular_response_paper.groups.rolling_resistance import draw, simulate


def test_rolling_resistance_lowers_the_friction_that_holds_a_pile(datasets):
    found = datasets["thresholds"].sel(layers=5)
    assert ((found["high"] - found["low"]) <= 0.1).all() and (found["moved"] < 0.5).all()
    assert (found["high"].sel(rolling_friction=0.1) < 0.5 * found["high"].sel(rolling_friction=0.0)).all()
    assert (found["balance"] < found["high"]).all()  # no pile stands where no forces balance
    weight = found["floor_force"].sum("floor_disk")
    assert weight.values == pytest.approx(1 + 4 + 7 + 10 + 13, abs=1e-8)  # the floor bears the pile


def test_balance_of_two_layers_in_closed_form():
    """One disk on four that touch in a row, without rolling resistance.

    It pushes each of the middle two with N outwards under 60 degrees and with T along the tangent. Below friction 1 the
    outer two bear nothing, so each middle one turns against the floor alone, F = T, which must hold it back:
    N cos 60 - T sin 60 <= F, so T / N >= cos 60 / (1 + sin 60) = tan 15.
    """
    steps = [simulate.balance(2, 0.0, 1.0, tolerance).balance for tolerance in (0.1, 0.001)]
    assert steps[0] <= steps[1] == pytest.approx(2.0 - np.sqrt(3.0), abs=0.001)


def test_only_rolling_resistance_hands_on_couples_between_equal_disks(datasets):
    slabs = datasets["slabs"].sel(friction=0.2)
    assert (slabs["couple_stress"].sel(rolling_friction=0.0) == 0.0).all()
    resisting = slabs.sel(rolling_friction=0.1)
    assert (resisting["couple_stress"] > 0.0).all()
    assert (resisting["moment_error"] < 1e-8).all()
    assert float(resisting["modulus"][0]) == pytest.approx(np.sqrt(3.0) / 4.0 * 0.8, rel=0.2)


def test_values_are_the_stored_ones(datasets, num_regression):
    slabs, names = datasets["slabs"].sel(friction=0.2), ("floor_response", "opening", "couple_stress")
    np.testing.assert_allclose(slabs["floor_response"].sum("floor_disk"), 1.0, atol=1e-9)
    found = {name: slabs[name].values.ravel() for name in names}
    num_regression.check(found, default_tolerance={"rtol": 1e-5, "atol": 1e-8})


def test_the_figure(datasets, looks_as_stored):
    drawn = draw.draw(datasets)
    assert list(drawn) == ["rolling_resistance"]
    looks_as_stored(drawn)
