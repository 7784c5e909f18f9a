"""Stress in an elastic slab on a rigid floor under a vertical point force on its top.

The slab fills ``0 <= z <= height`` and is isotropic or orthotropic (``Moduli``). Its floor is ``rough``
(no displacement) or ``smooth`` (no vertical displacement, no shear stress); its top is free but for the
force. Sideways it is unbounded, or ends at smooth rigid walls, where mirror images of the force turn the
Fourier integral over x into a cosine series.

For one wave number k, with ``q = k z``, the two displacements (times k) and the two stresses on a
horizontal plane obey ``dy/dq = A y`` with a constant 4 x 4 matrix A: the definition of
``sigma_xz`` and ``sigma_zz`` and the two force balances. A real Schur form splits y into a part that decays
upwards from the floor and one that decays downwards from the top. Neither part overflows, and the split
exists also where roots coincide, as they do in the isotropic solid, so one route serves every solid.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import schur

from ..errors import check_positive, require
from .moduli import Moduli

Floor = Literal["rough", "smooth"]
FloatArray = NDArray[np.float64]

#: Longest series, met only within about a thousandth of the height of the top; and the part summed at once.
_MOST_WAVE_NUMBERS = 400_000
_CHUNK = 1024


def _decay(generator: FloatArray, q: FloatArray) -> FloatArray:
    """(n, 2, 2) ``exp(generator q)`` of a 2 x 2 matrix whose eigenvalues have negative real parts.

    Exact also where the eigenvalues coincide, which the general matrix exponential resolves to ten digits only.
    """
    mean = 0.5 * np.trace(generator)
    deviator = generator - mean * np.eye(2)
    delta = np.sqrt(complex(-np.linalg.det(deviator)))  # the eigenvalues are mean +- delta
    small = np.abs(delta * q) < 1e-2
    even = 0.5 * (np.exp((mean + delta) * q) + np.exp((mean - delta) * q))
    odd = 0.5 * (np.exp((mean + delta) * q) - np.exp((mean - delta) * q)) / (delta if delta != 0.0 else 1.0)
    square = (delta * q) ** 2
    odd = np.where(small, np.exp(mean * q) * q * (1.0 + square / 6.0 * (1.0 + square / 20.0)), odd)
    return even.real[:, None, None] * np.eye(2) + odd.real[:, None, None] * deviator


@dataclass(frozen=True)
class Slab:
    """An elastic slab of ``height`` on a rigid ``floor``; lengths in any unit.

    ``width`` is the distance of smooth side walls at ``x = -width/2`` and ``width/2``; None is unbounded. The force
    pushes down at ``x = load_position``. Stresses are positive in tension, pressures in compression.
    """

    height: float
    moduli: Moduli
    floor: Floor = "rough"
    width: float | None = None
    load_position: float = 0.0

    def __post_init__(self) -> None:
        check_positive(height=self.height)
        require(self.floor in ("rough", "smooth"), f"floor = {self.floor!r}: must be 'rough' or 'smooth'")
        if self.width is not None:
            check_positive(width=self.width)
            rule = f"load_position = {self.load_position}: must be inside +-{0.5 * self.width}"
            require(abs(self.load_position) < 0.5 * self.width, rule)

    @cached_property
    def _modes(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Bases (4, 2) and generators (2, 2) of the decaying and the growing part of y(q).

        y = (k u_x, k u_z, sigma_xz, sigma_zz), amplitudes of sin, cos, sin, cos of k x.
        """
        a, b, c, d = self.moduli.a, self.moduli.b, self.moduli.c, self.moduli.d
        # Measuring stress in units of sqrt(b d) keeps the matrix of order one for any stiffness.
        unit = np.sqrt(b * d)
        matrix = np.array(
            [
                [0.0, 1.0, 2.0 * unit / d, 0.0],
                [-c / b, 0.0, 0.0, unit / b],
                [(a - c**2 / b) / unit, 0.0, 0.0, c / b],
                [0.0, 0.0, -1.0, 0.0],
            ]
        )
        down, v_down, _ = schur(matrix, sort="lhp")
        up, v_up, _ = schur(matrix, sort="rhp")
        return v_down[:, :2], down[:2, :2], v_up[:, :2], up[:2, :2]

    def transform(self, wave_number: ArrayLike, z: float = 0.0) -> FloatArray:
        """(3, n) amplitudes of sigma_xx, sigma_zz (of cos k x) and sigma_xz (of sin k x) at height ``z``.

        For the top pressure ``cos k x``. At k = 0 sigma_zz = -1, and sigma_xx = -c/b unless nothing keeps
        the slab from widening (smooth floor, no walls), when it is 0.
        """
        require(0.0 <= z <= self.height, f"z = {z}: must be between 0 and the height {self.height}")
        k = np.atleast_1d(np.asarray(wave_number, dtype=float))
        require(k.ndim == 1 and np.all(k >= 0.0), "wave_number: must be a number or a 1-d array, none negative")
        b, c = self.moduli.b, self.moduli.c
        v_down, down, v_up, up = self._modes
        through = k * self.height
        full = (k.size, 4, 2)
        at_floor = np.concatenate([np.broadcast_to(v_down, full), v_up @ _decay(-up, through)], axis=2)
        at_top = np.concatenate([v_down @ _decay(down, through), np.broadcast_to(v_up, full)], axis=2)
        held = [0, 1] if self.floor == "rough" else [1, 2]
        system = np.concatenate([at_floor[:, held], at_top[:, [2, 3]]], axis=1)
        load = np.tile(np.array([0.0, 0.0, 0.0, -1.0])[:, None], (k.size, 1, 1))
        # A smooth floor lets the slab slide, which k = 0 cannot tell from rest: its values are set below.
        uniform = k == 0.0
        system[uniform] = np.eye(4)
        weight = np.linalg.solve(system, load)
        y = v_down @ (_decay(down, k * z) @ weight[:, :2])
        y = (y + v_up @ (_decay(-up, k * (self.height - z)) @ weight[:, 2:]))[..., 0]
        unit = np.sqrt(self.moduli.b * self.moduli.d)
        lateral = (self.moduli.a - c**2 / b) / unit * y[:, 0] + c / b * y[:, 3]
        result = np.stack([lateral, y[:, 3], y[:, 2]])
        confined = self.floor == "rough" or self.width is not None
        result[:, uniform] = np.array([[-c / b if confined else 0.0], [-1.0], [0.0]])
        return result

    def stress(self, x: ArrayLike, z: float, force: float = 1.0, smoothing: float = 0.0) -> FloatArray:
        """(3, ...) sigma_xx, sigma_zz, sigma_xz at ``x`` (any shape) and height ``z`` above the floor, below the top.

        ``smoothing`` is the standard deviation of a Gaussian average over x (0: none). Sums as
        many wave numbers as rounding asks for; raises ValueError where that is hopeless (at the top, unless
        smoothed) or if ``x`` is outside the walls.
        """
        points = np.asarray(x, dtype=float)
        if self.width is None:
            return self._sum_unbounded(points, z, force, smoothing)
        half = 0.5 * self.width
        rule = f"x: must be between the walls at {-half} and {half}"
        require(not points.size or np.max(np.abs(points)) <= half * (1.0 + 1e-12), rule)
        # One period holds the slab and its mirror image beyond the right wall; measured from the left wall.
        k, amplitude = self._amplitudes(np.pi / self.width, z, smoothing)
        return force / self.width * self._series(points + half, self.load_position + half, k, amplitude)

    def floor_pressure(self, x: ArrayLike, force: float = 1.0) -> FloatArray:
        """Pressure on the floor at ``x`` (any shape), in force per length; integrates to ``force``."""
        return -self.stress(x, 0.0, force)[1]

    def floor_force(self, edges: ArrayLike, force: float = 1.0) -> FloatArray:
        """(n - 1,) force on each stretch of floor between n increasing ``edges``."""
        bounds = np.asarray(edges, dtype=float)
        rule = "edges: must be a 1-d array of at least two increasing positions"
        require(bounds.ndim == 1 and bounds.size >= 2 and np.all(np.diff(bounds) > 0.0), rule)
        # Gauss-Legendre in each stretch, short beside the height over which the pressure varies.
        pieces = int(np.ceil(np.max(np.diff(bounds)) / (0.25 * self.height)))
        fine = np.concatenate(
            [np.linspace(left, right, pieces, endpoint=False) for left, right in pairwise(bounds)] + [bounds[-1:]]
        )
        node, weight = np.polynomial.legendre.leggauss(8)
        half = 0.5 * np.diff(fine)
        x = fine[:-1, None] + half[:, None] * (1.0 + node)
        return ((self.floor_pressure(x, force) @ weight) * half).reshape(-1, pieces).sum(axis=1)

    def _amplitudes(self, step: float, z: float, smoothing: float) -> tuple[FloatArray, FloatArray]:
        """Wave numbers ``0, step, 2 step, ...`` and their amplitudes, until those fall below rounding."""
        rate = np.min(np.linalg.eigvals(self._modes[3]).real)  # the slowest decay, the same both ways
        reach = 45.0  # exp(-45) is below rounding with room for the algebraic factor of a double root
        limits = []
        if z < self.height:
            limits.append(reach / (rate * (self.height - z)))
        if smoothing > 0.0:
            limits.append(np.sqrt(2.0 * reach) / smoothing)
        count = int(np.ceil(min(limits, default=np.inf) / step)) if limits else 0
        rule = f"z = {z}: too near the force at the top for a series; go down or smooth"
        require(limits and count <= _MOST_WAVE_NUMBERS, rule)
        k = step * np.arange(count + 1, dtype=float)
        return k, self.transform(k, z) * np.exp(-0.5 * (k * smoothing) ** 2)

    @staticmethod
    def _series(x: FloatArray, load: float, k: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Cosine (sine for shear) series of a unit force per half period at ``load``, from a mirror at 0."""
        factor = np.where(k == 0.0, 1.0, 2.0) * np.cos(k * load)
        weighted = factor * amplitude
        points = x.reshape(-1, 1)
        total = np.zeros((3, points.size))
        for start in range(0, k.size, _CHUNK):  # bounds the memory of the table of cosines
            part = slice(start, start + _CHUNK)
            phase = points * k[part]
            total[:2] += weighted[:2, part] @ np.cos(phase).T
            total[2] += np.sin(phase) @ weighted[2, part]
        return total.reshape((3, *x.shape))

    def _sum_unbounded(self, x: FloatArray, z: float, force: float, smoothing: float) -> FloatArray:
        """The trapezoidal rule for the Fourier integral: a row of distant forces, moved apart until unfelt.

        The amplitudes are analytic in k, so the error falls exponentially with the period.
        """
        offset = x - self.load_position
        period = 2.0 * float(np.max(np.abs(offset), initial=0.0)) + 32.0 * self.height
        previous: FloatArray | None = None
        while True:
            k, amplitude = self._amplitudes(2.0 * np.pi / period, z, smoothing)
            total = force / period * self._series(offset, 0.0, k, amplitude)
            scale = abs(force) / self.height
            if previous is not None and np.max(np.abs(total - previous), initial=0.0) < 1e-12 * scale:
                return total
            previous, period = total, 2.0 * period


def response_of_layers(
    floor_x: ArrayLike,
    *,
    layers: int,
    moduli: Moduli,
    floor: Floor = "smooth",
    width: float | None = None,
    height: float | None = None,
) -> FloatArray:
    """(n,) share of the force that a slab of ``layers`` disk layers hands to each floor disk.

    The elastic slab stands in for a triangular packing of disks of radius 1. It has the packing's area per
    disk, so it is ``sqrt(3) layers`` high unless ``height`` is given. A floor disk at ``floor_x`` (1-d,
    relative to the loaded disk) gets the pressure on the diameter below it. ``width`` (radii) puts smooth
    walls at its ends with the loaded disk in the middle; the shares of a full row then add up to 1.

    To be compared with the ``floor_response`` of a packing to a small force. The two differ by a part that
    falls like 1 / layers: 0.4 % of the peak for 15 layers of equal bonds, several per cent without
    horizontal ones, and always more at the last disk beside a wall. Raises ValueError for fewer
    than one layer, a ``floor_x`` of another shape, or what ``Slab`` refuses.
    """
    require(layers >= 1, f"layers = {layers}: must be at least 1")
    slab = Slab(np.sqrt(3.0) * layers if height is None else height, moduli, floor, width)
    node, weight = np.polynomial.legendre.leggauss(8)
    x = np.asarray(floor_x, dtype=float)
    require(x.ndim == 1, f"floor_x: must be 1-d, not of shape {x.shape}")
    return slab.floor_pressure(x[:, None] + node) @ weight
