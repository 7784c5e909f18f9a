"""Between reduced units and those of a laboratory."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Final, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError, describe, suggestion

Value = TypeVar("Value", float, NDArray[np.float64])

#: Powers of length, mass and time in each quantity.
_DIMENSIONS: Final = {
    "length": (1, 0, 0),
    "mass": (0, 1, 0),
    "time": (0, 0, 1),
    "velocity": (1, 0, -1),
    "acceleration": (1, 0, -2),
    "force": (1, 1, -2),
    "torque": (2, 1, -2),
    "energy": (2, 1, -2),
    "stiffness": (0, 1, -2),
    "damping": (0, 1, -1),
    "inertia": (2, 1, 0),
    "stress": (0, 1, -2),
}


@dataclass(frozen=True)
class LaboratoryUnits:
    """The reduced units of disks of one radius, in SI units; defaults are those of Sec. III.B.

    Length is the radius, mass that of one disk (pi R^2 W rho), and time sqrt(R/g). For a polydisperse
    packing ``radius`` is the mean radius; the mean mass is then larger by the variance of the relative
    radius (0.7 % at polydispersity 0.25), which this leaves out.

    A ``stress`` is two-dimensional, force per length (N/m); a ``pressure`` is a stress over the thickness
    (Pa).
    """

    radius: float = 3.75e-3  #: m
    thickness: float = 6.6e-3  #: m, of the disks along their axis
    density: float = 1150.0  #: kg/m3
    gravity: float = 9.8  #: m/s2

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
            if not number or not (0.0 < value < math.inf):
                raise SceneError(describe((item.name,), value, "must be a finite number greater than 0"))

    @property
    def mass(self) -> float:
        """Mass of a disk in kg."""
        return math.pi * self.radius**2 * self.thickness * self.density

    @property
    def time(self) -> float:
        """Unit of time in s."""
        return math.sqrt(self.radius / self.gravity)

    def unit(self, quantity: str) -> float:
        """One reduced unit of ``quantity`` in SI units.

        Quantities are length, mass, time, velocity, acceleration, force, torque, energy, stiffness, damping,
        inertia, stress and pressure; another name is a SceneError.
        """
        if quantity == "pressure":
            return self.unit("stress") / self.thickness
        if quantity not in _DIMENSIONS:
            names = [*_DIMENSIONS, "pressure"]
            rule = f"must be {' or '.join(names)}{suggestion(quantity, names)}"
            raise SceneError(describe(("quantity",), quantity, rule))
        length, mass, time = _DIMENSIONS[quantity]
        return float(self.radius**length * self.mass**mass * self.time**time)

    @overload
    def to_reduced(self, quantity: str, value: Value) -> Value: ...
    @overload
    def to_reduced(self, quantity: str, value: Sequence[float]) -> NDArray[np.float64]: ...

    def to_reduced(self, quantity, value):
        """``value`` in SI units as a multiple of the reduced unit; scalars, lists or arrays of any shape."""
        return _listed(value) / self.unit(quantity)

    @overload
    def to_laboratory(self, quantity: str, value: Value) -> Value: ...
    @overload
    def to_laboratory(self, quantity: str, value: Sequence[float]) -> NDArray[np.float64]: ...

    def to_laboratory(self, quantity, value):
        """``value`` in reduced units as SI units; scalars, lists or arrays of any shape."""
        return _listed(value) * self.unit(quantity)


def _listed(value):
    """Lists and tuples as arrays; all else, labelled arrays too, as it is."""
    return np.asarray(value, float) if isinstance(value, (list, tuple)) else value
