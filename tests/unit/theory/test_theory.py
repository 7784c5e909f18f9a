"""Elastic references: moduli of the spring lattice (eqs. 7 to 10), the half plane, the rays, and the slab.

Closed forms, totals, limits, boundary conditions and the balance of forces.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusals
from scipy.integrate import quad

from granular_response.theory import half_plane, lattice, rays
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab, response_of_layers

stiffness = st.floats(0.05, 5.0)
SETS = [
    Springs(1.0, 1.0),
    Springs(2.0, 1.0, 0.4, 0.0),
    Springs(0.7, 1.3, 0.2, 0.9),
    Springs.uniform(3000.0, 2400.0),
    Springs(0.0, 1.0, 0.0, 0.3),
]


def strained(springs: Springs, rotations: str) -> np.ndarray:
    """Stress per strain from three bonds: in a lattice with one disk a cell all disks move and turn alike."""
    along = np.array([[1.0, 0.0], [0.5, np.sqrt(0.75)], [-0.5, np.sqrt(0.75)]])
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    k = np.array([springs.k1n, springs.k2n, springs.k2n, springs.k1t, springs.k2t, springs.k2t])
    e, b = np.concatenate([along, across]), 2.0 * np.concatenate([along, along])
    stretch = np.stack([e[:, 0] * b[:, 0], e[:, 1] * b[:, 1], e[:, 0] * b[:, 1] + e[:, 1] * b[:, 0]], axis=1)
    relaxed = stretch
    arm = np.repeat([0.0, 2.0], 3)  # a turn of all disks stretches the springs along the tangent
    if rotations == "free" and k @ arm:  # until no disk feels a torque
        relaxed = stretch - np.outer(arm, (k * arm) @ stretch / (k @ arm**2))
    return (stretch * [1.0, 1.0, 0.5]).T @ (k[:, None] * relaxed) / (2.0 * np.sqrt(3.0))


@pytest.mark.parametrize("rotations", ["suppressed", "free"])
@pytest.mark.parametrize("springs", SETS)
def test_a_lattice_has_the_moduli_of_the_paper(springs: Springs, rotations) -> None:
    expected = lattice.moduli(springs, rotations).matrix()
    np.testing.assert_allclose(strained(springs, rotations), expected, rtol=0, atol=1e-13 * expected.max())
    lower = lattice.moduli(springs, "suppressed").matrix() - expected  # free rotations lower the shear modulus alone
    alike = rotations == "suppressed" or springs.k1t == springs.k2t
    assert abs(lower[2, 2]) < 1e-14 * expected[2, 2] if alike else lower[2, 2] > 0.0
    assert not lower[:2].any() and not lower[2, :2].any()


def test_r_without_horizontal_springs_is_the_papers_function() -> None:
    for beta in (0.0, 0.1, 0.5, 2.0):
        expected = (beta**2 + 10.0 * beta - 3.0) / (beta**2 + 6.0 * beta + 9.0)
        assert lattice.peak_criterion(beta) == pytest.approx(expected, abs=1e-14)
        if beta:
            moduli = lattice.moduli(Springs(0.0, 1.0, 0.0, beta))
            assert moduli.peak_criterion == pytest.approx(expected, abs=1e-14)


def test_roots_of_r() -> None:
    assert lattice.peak_criterion_root() == pytest.approx(2.0 * np.sqrt(7.0) - 5.0, abs=1e-14)
    assert round(lattice.peak_criterion_root(), 4) == 0.2915
    assert lattice.peak_criterion_root("free") == pytest.approx(3.0 / 11.0, abs=1e-14)


@given(k_n=stiffness, k_t=st.floats(0.0, 5.0))
def test_equal_bonds_are_isotropic(k_n: float, k_t: float) -> None:
    for rotations in ("suppressed", "free"):
        m = lattice.moduli(Springs.uniform(k_n, k_t), rotations)
        assert (m.b, m.d) == pytest.approx((m.a, m.a - m.c), abs=1e-12 * m.a)
        assert m.poisson_ratio == pytest.approx(lattice.poisson_ratio(k_n, k_t), abs=1e-12)
        assert m.shape == pytest.approx((2.0, 1.0), rel=1e-10)
        assert m.peak_criterion == pytest.approx(1.0, rel=1e-10)


@given(k1n=stiffness, k2n=stiffness, k1t=stiffness, k2t=stiffness)
def test_criterion_r_is_a_ratio_of_the_shape(k1n: float, k2n: float, k1t: float, k2t: float) -> None:
    m = lattice.moduli(Springs(k1n, k2n, k1t, k2t))
    s, p = m.shape
    assert m.peak_criterion == pytest.approx(s / (2.0 * p), rel=1e-9, abs=1e-12)


def test_isotropic_constructor_inverts() -> None:
    m = Moduli.isotropic(0.3, 2.5)
    a11, a12, a22, a66 = m.compliances
    assert (a11, a12, a22, a66) == pytest.approx((1 / 2.5, -0.3 / 2.5, 1 / 2.5, 2.6 / 2.5), rel=1e-14)
    np.testing.assert_allclose(
        m.matrix() @ np.array([[a11, a12, 0], [a12, a22, 0], [0, 0, a66 / 2]]), np.eye(3), atol=1e-14
    )


test_bad_springs_are_named = refusals(
    ValueError,
    (lambda: Moduli(1.0, 1.0, 1.0, 1.0), r"modulus c = 1\.0"),
    (lambda: Moduli.isotropic(1.0), r"poisson_ratio = 1\.0"),
    (lambda: Springs(-1.0, 1.0), r"k1n = -1\.0"),
    (lambda: Springs(1.0, 0.0), r"k2n = 0\.0: must be positive"),
    (lambda: lattice.moduli(Springs(0.0, 1.0)), r"modulus c"),
    (lambda: lattice.moduli(Springs(1.0, 1.0), "some"), r"rotations = 'some'"),
)


HALF_PLANES = [
    Moduli.isotropic(0.3),
    lattice.moduli(Springs(2.0, 1.0)),
    lattice.moduli(Springs(0.1, 1.0)),
    lattice.moduli(Springs(0.0, 1.0, 0.0, 0.1)),
]


@pytest.mark.parametrize("moduli", HALF_PLANES)
@pytest.mark.parametrize("depth", [0.5, 7.0])
def test_pressure_below_a_half_plane_integrates_to_the_force(moduli: Moduli, depth: float) -> None:
    right, _ = quad(lambda x: float(half_plane.pressure(x, depth, moduli, 15.0)), 0.0, np.inf, limit=400)
    assert 2.0 * right == pytest.approx(15.0, rel=1e-7)


def test_isotropic_limit_is_flamant() -> None:
    x, depth = np.linspace(-5.0, 5.0, 21), 2.0
    flamant = 2.0 * depth**3 / (np.pi * (x**2 + depth**2) ** 2)
    np.testing.assert_allclose(half_plane.pressure(x, depth, Moduli.isotropic(-0.2)), flamant, rtol=1e-12)


@pytest.mark.parametrize("moduli", HALF_PLANES)
def test_peaks_are_where_the_pressure_is_largest(moduli: Moduli) -> None:
    x = np.linspace(0.0, 2.0, 200_001)
    largest = x[np.argmax(half_plane.pressure(x, 1.0, moduli))]
    assert np.sqrt(max(0.0, -moduli.peak_criterion)) == pytest.approx(largest, abs=2e-5)


def test_rays_carry_the_force_and_widen_like_a_random_walk() -> None:
    x = np.linspace(-300.0, 300.0, 60_001)
    for depth in (40.0, 160.0):
        pressure = rays.pressure(x, depth, angle=np.pi / 6, diffusion_length=0.1, force=3.0)
        right = np.where(x > 0.0, pressure, 0.0)
        assert pressure.sum() * 0.01 == pytest.approx(3.0, rel=1e-10)
        np.testing.assert_allclose(pressure, pressure[::-1], rtol=1e-9, atol=1e-300)
        mean = (x * right).sum() / right.sum()
        variance = ((x - mean) ** 2 * right).sum() / right.sum()
        assert mean == pytest.approx(depth / np.sqrt(3.0), rel=1e-9)
        assert variance == pytest.approx(0.1 * depth, rel=1e-9)


ISOTROPIC = Moduli.isotropic(0.0526)
SOLIDS = [ISOTROPIC, Moduli.isotropic(-0.5), *(lattice.moduli(Springs(ratio, 1.0)) for ratio in (2.0, 0.1))]
WAVES = np.array([1e-3, 0.1, 0.7, 1.0, 3.0, 8.0, 25.0])
everything = pytest.mark.parametrize("moduli", SOLIDS)
floors = pytest.mark.parametrize("floor", ["rough", "smooth"])


@pytest.mark.parametrize("nu", [-0.4, 0.0, 0.0526, 1.0 / 3.0, 0.9])
def test_isotropic_transform_in_closed_form(nu: float) -> None:
    # Smooth: the upper half of a layer pressed on both faces (Filon). Rough: the layer on a rigid base, with
    # Kolosov's constant of the plane problem whose Poisson ratio is the two-dimensional one.
    q, kolosov = WAVES, (3.0 - nu) / (1.0 + nu)
    smooth = 2.0 * (np.sinh(q) + q * np.cosh(q)) / (np.sinh(2.0 * q) + 2.0 * q)
    half = 0.5 * (kolosov + 1.0)
    rough = half * (half * np.cosh(q) + q * np.sinh(q))
    rough /= kolosov * np.cosh(q) ** 2 + q**2 + 0.25 * (kolosov - 1.0) ** 2
    for floor, expected in (("smooth", smooth), ("rough", rough)):
        for height in (1.0, 27.0):
            slab = Slab(height, Moduli.isotropic(nu, 3000.0), floor)
            np.testing.assert_allclose(-slab.transform(q / height)[1], expected, rtol=1e-12)


@everything
@floors
def test_pressure_integrates_to_the_force(moduli: Moduli, floor: str) -> None:
    slab = Slab(2.0, moduli, floor)
    edges = np.linspace(-60.0, 60.0, 121)
    assert slab.floor_force(edges, force=5.0).sum() == pytest.approx(5.0, rel=1e-10)


def test_smooth_floor_pressure_knows_nothing_of_the_moduli_if_isotropic() -> None:
    x = np.linspace(-3.0, 3.0, 31)
    one = Slab(1.0, Moduli.isotropic(0.0, 1.0), "smooth").floor_pressure(x)
    other = Slab(1.0, Moduli.isotropic(0.8, 7.0), "smooth").floor_pressure(x)
    np.testing.assert_allclose(one, other, atol=1e-12)

    # The series against the Fourier integral itself.
    def integrand(q: float, position: float) -> float:
        transform = 2.0 * (np.sinh(q) + q * np.cosh(q)) / (np.sinh(2.0 * q) + 2.0 * q)
        return transform * np.cos(q * position) / np.pi

    direct = [quad(integrand, 1e-12, 60.0, args=(position,), limit=400)[0] for position in x[::5]]
    np.testing.assert_allclose(one[::5], direct, atol=1e-9)


@everything
@floors
def test_fields_balance_and_meet_the_boundaries(moduli: Moduli, floor: str) -> None:
    slab = Slab(1.0, moduli, floor)
    k, z, dz = WAVES[1:6], 0.4, 1e-4
    xx, zz, xz = slab.transform(k, z)
    above, below = slab.transform(k, z + dz), slab.transform(k, z - dz)
    slope = (above - below) / (2.0 * dz)
    # d sigma_xx/dx + d sigma_xz/dz = 0 and d sigma_xz/dx + d sigma_zz/dz = 0.
    np.testing.assert_allclose(slope[2], k * xx, rtol=2e-5, atol=1e-7)
    np.testing.assert_allclose(slope[1], -k * xz, rtol=2e-5, atol=1e-7)
    # Compatibility: eps_xx,zz + eps_zz,xx = 2 eps_xz,xz.
    a11, a12, a22, a66 = moduli.compliances
    second = (above - 2.0 * np.array([xx, zz, xz]) + below) / dz**2
    residual = a11 * second[0] + a12 * second[1] - k**2 * (a12 * xx + a22 * zz) - a66 * k * slope[2]
    np.testing.assert_allclose(residual / (k**2 * a22), 0.0, atol=1e-5)
    top, bottom = slab.transform(k, 1.0), slab.transform(k, 0.0)
    np.testing.assert_allclose(top[1:], [-np.ones(k.size), np.zeros(k.size)], atol=1e-11)
    if floor == "smooth":
        np.testing.assert_allclose(bottom[2], 0.0, atol=1e-12)
    else:
        np.testing.assert_allclose(a11 * bottom[0] + a12 * bottom[1], 0.0, atol=1e-11 * a11)  # eps_xx = 0


@everything
def test_far_above_the_floor_the_slab_is_a_half_plane(moduli: Moduli) -> None:
    x = np.linspace(-2.0, 2.0, 21)
    for height in (25.0, 80.0):
        error = -Slab(height, moduli).stress(x, height - 1.0)[1] - half_plane.pressure(x, 1.0, moduli)
        assert np.max(np.abs(error)) < 1.0 / height**2


def test_smooth_walls_are_mirrors() -> None:
    x = np.linspace(-2.0, 2.0, 17)
    open_slab = Slab(1.0, ISOTROPIC, "smooth")
    walled = Slab(1.0, ISOTROPIC, "smooth", width=4.0, load_position=0.7)
    images = [4.0 * 2 * n + 0.7 for n in range(-4, 5)] + [4.0 * (2 * n + 1) - 0.7 for n in range(-5, 5)]
    expected = sum(open_slab.stress(x - image, 0.0) for image in images)
    stress = walled.stress(x, 0.0)
    np.testing.assert_allclose(stress[1:], expected[1:], atol=1e-10)
    # Walls hold the width; the sum of unbounded slabs, each free to widen, lacks that uniform stress.
    excess = stress[0] - expected[0]
    np.testing.assert_allclose(excess, excess[0], atol=1e-10)
    assert excess[0] == pytest.approx(-ISOTROPIC.c / ISOTROPIC.b / 4.0, rel=1e-9)
    assert walled.floor_force(np.linspace(-2.0, 2.0, 9)).sum() == pytest.approx(1.0, rel=1e-12)


@floors
def test_smoothing_keeps_the_total_and_reaches_the_top(floor: str) -> None:
    slab = Slab(1.0, ISOTROPIC, floor)
    x = np.linspace(-20.0, 20.0, 4001)
    at_top = -slab.stress(x, 1.0, smoothing=0.2)[1]
    np.testing.assert_allclose(at_top, np.exp(-(x**2) / 0.08) / np.sqrt(0.08 * np.pi), atol=1e-9)
    assert -slab.stress(x, 0.5, smoothing=0.2)[1].sum() * 0.01 == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("width", [None, 61.0 * 2.0])
def test_shares_of_the_floor_disks(width: float | None) -> None:
    x = 2.0 * np.arange(-30, 31)
    share = response_of_layers(x, layers=15, moduli=ISOTROPIC, width=width)
    # Without walls the pressure far away is slightly negative, and cut off here.
    assert share.sum() == pytest.approx(1.0, abs=1e-10 if width else 2e-2)
    np.testing.assert_allclose(share, share[::-1], atol=1e-13)
    height = 15.0 * np.sqrt(3.0)
    # 0.9195 / height is the pressure under the force; a disk covers a length 2.
    assert share[30] == pytest.approx(0.9195 * 2.0 / height, rel=2e-3)


test_bad_slabs_are_named = refusals(
    ValueError,
    (lambda: Slab(0.0, ISOTROPIC), r"height = 0\.0"),
    (lambda: Slab(1.0, ISOTROPIC, width=-2.0), r"width = -2\.0"),
    (lambda: Slab(1.0, ISOTROPIC, width=2.0, load_position=1.5), r"load_position = 1\.5"),
    (lambda: Slab(1.0, ISOTROPIC).transform(0.0, 1.5), r"z = 1\.5: must be between 0"),
    (lambda: Slab(1.0, ISOTROPIC, width=2.0).stress(1.5, 0.0), "x: must be between the walls"),
    (lambda: Slab(1.0, ISOTROPIC).transform(-1.0), "wave_number: must be"),
    (lambda: response_of_layers([0.0], layers=0, moduli=ISOTROPIC), "layers = 0"),
    (lambda: Slab(1.0, ISOTROPIC).floor_force([1.0, 0.0]), r"edges"),
)
