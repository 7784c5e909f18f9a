"""The force loops against one pair after the other, and single contacts by hand."""

import numpy as np
import pytest
from reference_loop import Material

from granular_response.contact import CUT, LITERAL, RULES, UNLOADING, coulomb
from granular_response.contact.law import frictional, frictionless, normal_force
from granular_response.contact.rolling import Rolling
from granular_response.kernels.forces import SCRATCH, add_pair_forces, add_wall_forces
from granular_response.kernels.model import Motion, Pairs, Rolls, Walls


@pytest.mark.parametrize(("overlap", "bears"), [(1e-3, True), (-1e-3, False)])
def test_a_contact_acts_along_its_normal_and_across_it_and_forgets_where_it_is_open(overlap, bears):
    material = Material()
    ft, spring = coulomb.tangential(1e-4, 0.02, 3.0, material.law, CUT, 1e-3)
    expected = (0.6 * 3.0 - 0.8 * ft, 0.8 * 3.0 + 0.6 * ft, ft, spring) if bears else (0.0, 0.0, 0.0, 0.0)
    found = frictional(overlap, 0.6, 0.8, 3.0, 0.02, 1e-4, material.law, CUT, 1e-3)
    assert found == pytest.approx(expected, rel=1e-15) and ft != 0.0
    assert frictionless(overlap, 0.6, 0.8, 3.0) == pytest.approx((1.8 * bears, 2.4 * bears), rel=1e-15)


ROUGHNESS = pytest.mark.parametrize(
    ("friction", "rule", "rolls"),
    [(0.0, CUT, False), (0.3, CUT, False), (0.3, CUT, True), (0.3, LITERAL, False), (0.3, UNLOADING, False)],
)


@ROUGHNESS
@pytest.mark.parametrize("shifts", [(1,), (3,), (7, 8), (9, 40), (1, 40, 2)])
@pytest.mark.parametrize("count", [5, 8, 64, 65, 151])
def test_runs_add_to_each_disk_as_first_and_then_as_second(count, shifts, friction, rule, rolls):
    """From the end of each run, however many are taken at once."""
    start = 1
    runs = np.array([[start, start + shift, count, count * r] for r, shift in enumerate(shifts)])
    order = [(i + k, j + k, s + k) for i, j, _, s in runs for k in reversed(range(count))]
    agrees_to_the_bit(runs, order, start + count + max(shifts) + 1, friction, rule, rolls)


@ROUGHNESS
@pytest.mark.parametrize("count", [3, 8, 29])
def test_single_pairs_add_in_their_order(count, friction, rule, rolls):
    rng = np.random.default_rng(count)
    pairs = sorted({tuple(sorted(rng.choice(9, 2, replace=False).tolist())) for _ in range(4 * count)})[:count]
    order = [(i, j, s) for s, (i, j) in enumerate(pairs)]
    runs = np.array([[i, j, 1, s] for i, j, s in order])
    agrees_to_the_bit(runs, order, 9, friction, rule, rolls)


def agrees_to_the_bit(runs, order, n, friction, rule, rolls):
    """The kernel against one pair after the other, ``order`` of first disk, second disk and slot."""
    slots = len(order)
    rng = np.random.default_rng(slots + n)
    material, dt, rough = Material(mu=friction), 5e-4, friction > 0
    q, v, f = (rng.normal(0, size, 3 * n) for size in (0.1, 0.1, 1.0))
    rim, reach = rng.normal(0, 0.1, n), rng.uniform(1.5, 2.5, slots)
    dx, dz, spring = rng.normal(0, 2, slots), rng.normal(0, 2, slots), rng.normal(0, 1e-3, slots)
    expected, springs = f.copy(), spring.copy()
    rolling = Rolls(rng.uniform(0.4, 0.6, slots), rng.normal(0, 1e-3, slots), Rolling(500.0, 10.0, 0.05), np.zeros(n))
    couple, turned = np.zeros(n), rolling.spring.copy()
    for i, j, s in order:
        x, z, du, dw = dx[s] + (q[i] - q[j]), dz[s] + (q[n + i] - q[n + j]), v[i] - v[j], v[n + i] - v[n + j]
        distance = np.sqrt(x * x + z * z)
        overlap, nx, nz = reach[s] - distance, x * (1.0 / distance), z * (1.0 / distance)
        fn = normal_force(overlap, None, du * nx + dw * nz, material.law)
        if rough:
            slip = dw * nx - du * nz - (rim[i] + rim[j])
            px, pz, pt, springs[s] = frictional(overlap, nx, nz, fn, slip, spring[s], material.law, rule, dt)
            expected[2 * n + i] += pt
            expected[2 * n + j] += pt
        else:
            px, pz = frictionless(overlap, nx, nz, fn)
        if rolls:
            slip = rolling.arm[s] * (v[2 * n + i] - v[2 * n + j])
            force, new = coulomb.tangential(turned[s], slip, fn, rolling.law, CUT, dt)
            turned[s] = new if overlap > 0.0 else 0.0
            couple[i] += rolling.arm[s] * force if overlap > 0.0 else 0.0
            couple[j] -= rolling.arm[s] * force if overlap > 0.0 else 0.0
        expected[i] += px
        expected[j] -= px
        expected[n + i] += pz
        expected[n + j] -= pz
    pairs = Pairs(
        runs, dx, dz, reach, None, spring if rough else None, rolling if rolls else None, np.zeros(SCRATCH),
        material.law,
    )  # fmt: skip
    add_pair_forces(pairs.spring, pairs.rolls, pairs, Motion(n, q, v, rim if rough else None, f, rule, dt))
    assert np.array_equal(f, expected)
    assert np.array_equal(spring, springs)
    assert np.array_equal(rolling.couple, couple)
    assert np.array_equal(rolling.spring, turned) and (not rolls or 0 < (turned == 0.0).sum() < slots)


WALLS = {"floor": (0.0, 1.0), "left": (1.0, 0.0), "right": (-1.0, 0.0)}


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
@pytest.mark.parametrize("wall", WALLS)
def test_wall_by_hand(wall, rule):
    """Overlap 0.01, approach 0.3, slip along t and spin: one disk against each wall."""
    nx, nz = WALLS[wall]
    material = Material(1000.0, 10.0, 800.0, 5.0, 0.5)
    along, spin, dt = 0.1, 0.05, 1e-3
    v = np.array([-0.3 * nx - along * nz, -0.3 * nz + along * nx, spin])
    q = np.array([-0.01 * nx, -0.01 * nz, 0.0])
    f, spring = np.zeros(3), np.array([1e-4])
    walls = Walls(np.array([0]), np.array([[nx, nz]]), np.zeros(1), None, spring, None, material.law)
    add_wall_forces(spring, walls, Motion(1, q, v, np.array([1.0 * spin]), f, rule, dt))
    fn = 10.0 + 3.0
    slip = along - spin
    ft = -(800.0 * (1e-4 + slip * dt) + 5.0 * slip)
    assert abs(ft) < 0.5 * fn
    assert spring[0] == pytest.approx(1e-4 + slip * dt)
    assert f == pytest.approx([fn * nx - ft * nz, fn * nz + ft * nx, ft])
