"""What rolling resistance changes, on a pile and a slab of 5 layers, from parameters through a file."""

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response_extensions.rolling_resistance.simulate import balanced
from granular_response_extensions.rolling_resistance.simulate.couples import decay


def test_balance_of_two_layers_in_closed_form():
    """One disk on four that touch in a row, without rolling resistance.

    It pushes each of the middle two with N outwards under 60 degrees and with T along the tangent. Below friction 1 the
    outer two bear nothing, so each middle one turns against the floor alone, F = T, which must hold it back:
    N cos 60 - T sin 60 <= F, so T / N >= cos 60 / (1 + sin 60) = tan 15.
    """
    steps = [balanced(2, 0.0, 1.0, tolerance).balance for tolerance in (0.1, 0.001)]
    assert steps[0] <= steps[1] == pytest.approx(2.0 - np.sqrt(3.0), abs=0.001)


def test_couples_between_rows_in_closed_form(datasets):
    """Rows of a lattice whose contacts stick, under a torque of 1 on the top row: sums over each row are enough.

    A contact of two rows that turn by a and b hands on the couple ``k_R (a - b) / 4``, and each disk has two of them.
    No horizontal force crosses between rows, so these shift until it takes ``q (a + b)`` from each of its disks, with
    ``q = k_T k_N / (k_N + 3 k_T)``. Contacts along a row take ``4 k_T a`` from a disk.
    """
    k_t, k_r, layers = 0.8, 0.8, 5
    q, balance = k_t / (1.0 + 3.0 * k_t), 4.0 * k_t * np.eye(layers)
    for k in range(layers - 1):
        balance[k : k + 2, k : k + 2] += 0.5 * k_r * np.array([[1, -1], [-1, 1]]) + 2.0 * q
    turn = np.linalg.solve(balance, np.eye(layers)[0])
    couple = datasets["torques"]["couple"].sel(friction=0.2)
    assert (couple.sel(rolling_friction=0.0) == 0.0).all()
    found = couple.sel(rolling_friction=0.1).isel(torque=0)
    np.testing.assert_allclose(found, 0.5 * k_r * (turn[:-1] - turn[1:]), atol=1.5e-3)


def test_exponential_couples_give_the_length_of_their_solid():
    scene = Scene().updated({"contact.stiffness_ratio": 0.5, "contact.rolling_stiffness_ratio": 12.0})
    depth = np.arange(1.0, 20.0)
    solid = np.exp(-depth / np.sqrt(12.0 * (1.0 / 1.5 + 1.0) / 4.0))  # B (1 / G + 1 / G_c) / 4, over sqrt(3)/4 k_N
    left, length = decay(scene, depth, solid)
    assert left < 1e-12 and length == pytest.approx(0.5 * np.sqrt(12.0 / 1.5), rel=1e-6)
