"""The force loops against an independent loop over pairs, and the balance of momentum."""

import numpy as np
import pytest
from reference_loop import Material, forces

from granular_response.contact import CUT, LITERAL, RULES, UNLOADING, coulomb
from granular_response.contact.law import frictional, frictionless, normal_force
from granular_response.contact.rolling import Rolling
from granular_response.kernels import neighbours
from granular_response.kernels.forces import SCRATCH, add_pair_forces, add_wall_forces
from granular_response.kernels.model import Motion, Pairs, Rolls, Walls
from granular_response.scene import SlabPacking
from granular_response.solvers.close_pairs import close_pairs


def run_kernel(position, velocity, spin, radius, first, second, springs, material, dt, rule=CUT, **runs_options):
    """The kernel on given pairs: forces (n, 2), torques (n,), springs of the pairs, springs of all slots, slots."""
    n = len(radius)
    runs, slot = neighbours.make_runs(np.asarray(first), np.asarray(second), n, **runs_options)
    i, j = neighbours.run_pairs(runs)
    friction = material.mu > 0
    # reference positions a little off, so that displacements count
    reference = position + 0.01 * np.sin(np.arange(2 * n)).reshape(n, 2)
    q = np.concatenate([(position - reference).T.ravel(), np.zeros(n)])
    v = np.concatenate([velocity.T.ravel(), spin])
    d = (reference[i] - reference[j]).T
    slots = len(i)
    spring = np.zeros(slots)
    spring[slot] = springs
    out = np.zeros(3 * n if friction else 2 * n)
    size = len(out)
    pairs = Pairs(
        runs, np.ascontiguousarray(d[0]), np.ascontiguousarray(d[1]), radius[i] + radius[j], None,
        spring if friction else None, None, np.zeros(SCRATCH), material.law,
    )  # fmt: skip
    rim = radius * spin if friction else None
    add_pair_forces(pairs.spring, None, pairs, Motion(n, q[:size], v[:size], rim, out, rule, dt))
    force = out[: 2 * n].reshape(2, n).T
    torque = -radius * out[2 * n :] if friction else np.zeros(n)
    return force, torque, spring[slot], spring, slot


def lattice(rng, disks_per_row=61, layers=3):
    packing = SlabPacking(kind="slab", layers=layers, disks_per_row=disks_per_row).build()
    pairs = packing.neighbour_pairs()
    return packing.position + rng.normal(0, 0.02, (packing.n, 2)), packing.radius, pairs[:, 0], pairs[:, 1]


def random_packing(rng):
    n = 80
    position = rng.uniform(0, 14, (n, 2))
    # no two centres coincide nearly, where a normal means nothing
    keep = [0]
    for k in range(1, n):
        if np.linalg.norm(position[keep] - position[k], axis=1).min() > 0.8:
            keep.append(k)
    position = position[keep]
    radius = rng.uniform(0.5, 1.2, len(keep))
    return position, radius, *close_pairs(position, radius, 0.6)


PACKINGS = {"lattice": lattice, "random": random_packing}
RUNS = {
    "as used": {},
    "single pairs": {"shortest_run": 10**9},
    "long gaps": {"shortest_run": 1, "longest_gap": 50},
}


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("packing", PACKINGS)
def test_loops_agree_with_plain_python(packing, runs, friction, rule):
    rng = np.random.default_rng(7)
    position, radius, first, second = PACKINGS[packing](rng)
    n = len(radius)
    velocity, spin = rng.normal(0, 0.1, (n, 2)), rng.normal(0, 0.1, n)
    material = Material(mu=friction)
    springs = rng.normal(0, 3e-3, len(first)) if friction else np.zeros(len(first))
    pairs = list(zip(first.tolist(), second.tolist(), strict=True))
    dt = 5e-4
    expected = forces(position, velocity, spin, radius, pairs, springs, material, dt, list(RULES)[rule])
    closed = sum(np.linalg.norm(position[i] - position[j]) < radius[i] + radius[j] for i, j in pairs)
    assert 20 < closed < len(pairs)
    force, torque, new, _, _ = run_kernel(
        position, velocity, spin, radius, first, second, springs, material, dt, rule, **RUNS[runs]
    )
    assert force == pytest.approx(expected[0], abs=1e-10)
    assert torque == pytest.approx(expected[1], abs=1e-10)
    assert new == pytest.approx(expected[2], abs=1e-13)
    # momentum: internal forces add up to nothing
    assert force.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


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
