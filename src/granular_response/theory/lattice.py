"""Moduli of the triangular lattice with normal and tangential springs (Sec. V.C, Fig. 11).

Bonds have length 2R; the horizontal ones have stiffnesses ``k1n`` and ``k1t``, the oblique ones (at 60
degrees) ``k2n`` and ``k2t``. In eq. (5) a tangential spring sees the displacement of the disk centres
only. In a packing it sees the rotation of the disks as well, so each function says which it means:

``rotations="suppressed"``
    eq. (5), and so eqs. (7)-(10).
``rotations="free"``
    every disk turns until it feels no torque. Only d changes: ``4 k1t + 2 k2t`` in eq. (10) becomes
    ``18 k1t k2t / (k1t + 2 k2t)``. Nothing changes if k1t = k2t; without horizontal springs the
    tangential ones no longer resist shear at all, and the root of r moves from 0.2915 to 3/11.

Stiffness has the units of the springs, in which the unit cell's ``R^2 / A = 1 / (2 sqrt 3)`` is already
included; moduli do not depend on R.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..errors import require
from .moduli import Moduli
from .moduli import peak_criterion as criterion

Rotations = Literal["suppressed", "free"]

#: R^2 / A with the area A = 2 sqrt(3) R^2 of a unit cell.
_R2_PER_AREA = 1.0 / (2.0 * math.sqrt(3.0))


@dataclass(frozen=True)
class Springs:
    """Stiffnesses of the horizontal (1) and oblique (2) bonds, normal (n) and tangential (t); Fig. 11."""

    k1n: float
    k2n: float
    k1t: float = 0.0
    k2t: float = 0.0

    def __post_init__(self) -> None:
        for name in ("k1n", "k2n", "k1t", "k2t"):
            value = getattr(self, name)
            rule = f"spring stiffness {name} = {value}: must be finite and not negative"
            require(np.isfinite(value) and value >= 0.0, rule)
        require(self.k2n != 0.0, "spring stiffness k2n = 0.0: must be positive, or no layer carries the next")

    @classmethod
    def uniform(cls, normal: float, tangential: float) -> Springs:
        """The same two springs at every contact, as in a monodisperse packing."""
        return cls(k1n=normal, k2n=normal, k1t=tangential, k2t=tangential)


def _check_rotations(rotations: str) -> None:
    require(rotations in ("suppressed", "free"), f"rotations = {rotations!r}: must be 'suppressed' or 'free'")


def moduli(springs: Springs, rotations: Rotations = "suppressed") -> Moduli:
    """Moduli of eqs. (7)-(10), or with free rotations (see the module's text).

    Raises ValueError if the lattice resists some strain not at all (the isostatic limit).

    Examples
    --------
    >>> gr.theory.lattice.moduli(gr.theory.lattice.Springs.uniform(1.0, 0.0)).a.round(3)  # 3 sqrt(3) / 4
    1.299
    """
    _check_rotations(rotations)
    k1n, k2n, k1t, k2t = springs.k1n, springs.k2n, springs.k1t, springs.k2t
    if rotations == "suppressed":
        tangential = 4.0 * k1t + 2.0 * k2t
    else:
        tangential = 18.0 * k1t * k2t / (k1t + 2.0 * k2t) if k1t > 0.0 and k2t > 0.0 else 0.0
    half = 0.5 * _R2_PER_AREA
    return Moduli(
        a=half * (8.0 * k1n + k2n + 3.0 * k2t),
        b=half * (9.0 * k2n + 3.0 * k2t),
        c=half * (3.0 * k2n - 3.0 * k2t),
        d=half * (6.0 * k2n + tangential),
    )


def peak_criterion(beta: float, rotations: Rotations = "suppressed") -> float:
    """r of Sec. V.C without horizontal springs (``k1n = k1t = 0``), at ``beta = k2t / k2n``.

    With suppressed rotations this is the paper's ``(beta^2 + 10 beta - 3) / (beta + 3)^2``. ``beta = 0``
    is the isostatic limit, where eq. (6) has a soft mode but r is still defined.
    """
    _check_rotations(rotations)
    require(beta >= 0.0, f"beta = {beta}: must not be negative")
    a, b, c = 1.0 + 3.0 * beta, 9.0 + 3.0 * beta, 3.0 - 3.0 * beta
    d = 6.0 + (2.0 * beta if rotations == "suppressed" else 0.0)
    return criterion(a, b, c, d)


def peak_criterion_root(rotations: Rotations = "suppressed") -> float:
    """``k2t / k2n`` below which the lattice without horizontal springs responds with two peaks.

    Found numerically to rounding; in closed form ``2 sqrt(7) - 5 = 0.2915`` with suppressed rotations
    (the paper's number) and ``3 / 11 = 0.2727`` with free ones.
    """
    from scipy.optimize import brentq  # a tenth of a second at the start of every process

    return float(brentq(peak_criterion, 0.0, 1.0, args=(rotations,), xtol=1e-15, rtol=1e-15))


def poisson_ratio(normal: float, tangential: float) -> float:
    """Two-dimensional Poisson ratio ``(k_N - k_T) / (3 k_N + k_T)`` of the lattice with equal bonds.

    That lattice is isotropic, and turning the rotations on or off makes no difference to it.
    """
    rule = f"normal = {normal}, tangential = {tangential}: must be above 0, and at least 0"
    require(normal > 0.0 and tangential >= 0.0, rule)
    return (normal - tangential) / (3.0 * normal + tangential)
