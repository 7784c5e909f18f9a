"""Moduli of a two-dimensional elastic solid with one vertical symmetry axis, in the notation of eq. (6).

The moduli relate the true (tensorial) strain to the stress::

    sigma_xx = a eps_xx + c eps_zz,   sigma_zz = c eps_xx + b eps_zz,   sigma_xz = d eps_xz,

so ``d`` is twice the shear modulus and the energy density is
``(a eps_xx^2 + b eps_zz^2) / 2 + c eps_xx eps_zz + d eps_xz^2``. Equation (6) as printed has half of
the last term; the values of eqs. (7)-(10) and the isotropic limit ``d = a - c`` need all of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..errors import check_positive, require

if TYPE_CHECKING:
    import xarray as xr

T = TypeVar("T", float, NDArray[np.float64], "xr.DataArray")


def peak_criterion(a: T, b: T, c: T, d: T) -> T:
    """``r = [a b - c (c + d)] / (b d)`` of numbers or arrays; see :attr:`Moduli.peak_criterion`."""
    return (a * b - c * (c + d)) / (b * d)


def bulk_and_shear(a: T, b: T, c: T, d: T) -> tuple[T, T]:
    """Bulk and shear modulus, numbers or arrays, of the isotropic solid with the same energy averaged over directions.

    >>> solid = Moduli.isotropic(0.25)
    >>> bulk, shear = bulk_and_shear(solid.a, solid.b, solid.c, solid.d)
    >>> round(bulk / shear, 12), round(solid.d / shear, 12)
    (1.666666666667, 2.0)
    """
    return 0.25 * (a + b + 2.0 * c), 0.125 * (a + b - 2.0 * c) + 0.25 * d


@dataclass(frozen=True)
class Moduli:
    """Elastic moduli ``a, b, c, d`` of eq. (6), in units of a spring stiffness (force per length).

    Raises ValueError unless the energy is positive for every strain: ``a, b, d > 0`` and ``a b > c^2``.
    """

    a: float  #: sigma_xx per eps_xx
    b: float  #: sigma_zz per eps_zz
    c: float  #: sigma_xx per eps_zz
    d: float  #: sigma_xz per eps_xz, twice the shear modulus

    def __post_init__(self) -> None:
        check_positive(a=self.a, b=self.b, d=self.d)
        require(self.a * self.b > self.c**2, f"modulus c = {self.c}: c^2 must be below a b = {self.a * self.b}")

    @classmethod
    def isotropic(cls, poisson_ratio: float, young_modulus: float = 1.0) -> Moduli:
        """Moduli of the isotropic solid with two-dimensional Poisson ratio in (-1, 1)."""
        require(-1.0 < poisson_ratio < 1.0, f"poisson_ratio = {poisson_ratio}: must be above -1 and below 1 (in 2D)")
        check_positive(young_modulus=young_modulus)
        a = young_modulus / (1.0 - poisson_ratio**2)
        return cls(a=a, b=a, c=poisson_ratio * a, d=young_modulus / (1.0 + poisson_ratio))

    @property
    def compliances(self) -> tuple[float, float, float, float]:
        """``a11, a12, a22, a66`` (1 = x, 2 = z): ``eps_xx = a11 sigma_xx + a12 sigma_zz`` and so on.

        ``a66`` is for the engineering shear strain ``2 eps_xz``, hence ``2 / d``.
        """
        determinant = self.a * self.b - self.c**2
        return self.b / determinant, -self.c / determinant, self.a / determinant, 2.0 / self.d

    @property
    def shape(self) -> tuple[float, float]:
        """The two ratios ``s = (2 a12 + a66) / a22`` and ``p = a11 / a22`` that fix the stress field.

        The stress function with horizontal wave number k varies as ``exp(m k z)`` with
        ``p m^4 - s m^2 + 1 = 0``; the isotropic solid has ``s = 2, p = 1``.
        """
        a11, a12, a22, a66 = self.compliances
        return (2.0 * a12 + a66) / a22, a11 / a22

    @property
    def poisson_ratio(self) -> float:
        """Horizontal strain per vertical one in uniaxial vertical stress, with the sign changed."""
        return self.c / self.a

    @property
    def peak_criterion(self) -> float:
        """``r = [a b - c (c + d)] / (b d)``: two peaks under a vertical point force iff r < 0 (Sec. V.C).

        In a half plane they lie at ``x / z = -sqrt(-r)`` and ``sqrt(-r)``. Isotropic: r = 1.
        """
        return peak_criterion(self.a, self.b, self.c, self.d)

    def matrix(self) -> NDArray[np.float64]:
        """(3, 3) stress ``(xx, zz, xz)`` per strain ``(eps_xx, eps_zz, eps_xz)``."""
        return np.array([[self.a, self.c, 0.0], [self.c, self.b, 0.0], [0.0, 0.0, self.d]])
