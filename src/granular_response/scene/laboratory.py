"""Between reduced units and those of a laboratory."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from ..errors import check_positive, require
from .base import UNITS, Description, unit_of
from .errors import SceneError, describe, show, suggestion
from .given import plain
from .material import KNOWN_LAWS
from .table import FilePacking

Value = TypeVar("Value", float, NDArray[np.float64])

#: By which the mean radius of a table may differ from that of the units, relatively: forces then differ by 2 %.
SAME_RADIUS = 0.01
#: Powers of length, mass and time in each quantity.
_DIMENSIONS: Final = {
    "length": (1, 0, 0),
    "mass": (0, 1, 0),
    "time": (0, 0, 1),
    "velocity": (1, 0, -1),
    "frequency": (0, 0, -1),
    "acceleration": (1, 0, -2),
    "force": (1, 1, -2),
    "torque": (2, 1, -2),
    "energy": (2, 1, -2),
    "stiffness": (0, 1, -2),
    "damping": (0, 1, -1),
    "inertia": (2, 1, 0),
    "stress": (0, 1, -2),
}
#: Names of the reduced units in results and tables.
LENGTH, MASS, TIME, FORCE = "mean_radius", "mean_mass", "reduced_time", "mean_weight"
#: What keys of a scene are, by their unit; lengths of own disks are in any unit.
_QUANTITIES: Final = {
    "mean radius": "length", "mg / mean radius": "stiffness", "mg": "force", "mg × mean radius": "energy",
    "sqrt(R/g)": "time", "sqrt(gR)": "velocity", "1 / sqrt(R/g)": "frequency",
}  # fmt: skip
_KEYS: Final = {key: _QUANTITIES[unit] for key, unit in UNITS.items() if unit in _QUANTITIES}
#: The same for the place of a loaded disk.
_PLACE: Final = {"x": "length"}


@dataclass(frozen=True)
class LaboratoryUnits:
    """The reduced units of disks of one radius, in SI units; defaults are those of Sec. III.B.

    Length is the radius, mass that of one disk (pi R^2 W rho), and time sqrt(R/g). For a polydisperse
    packing ``radius`` is the mean radius; the mean mass is then larger by the variance of the relative
    radius (0.7 % at polydispersity 0.25), which this leaves out.

    A ``stress`` is two-dimensional, force per length (N/m); a ``pressure`` is a stress over the thickness (Pa).

    Examples
    --------
    >>> units = gr.LaboratoryUnits(radius=3.75e-3, thickness=6.6e-3, density=1150.0)
    >>> round(units.to_laboratory("stiffness", 3000.0))  # N/m
    2629
    >>> round(units.to_reduced("force", 0.0493), 1)  # mean particle weights
    15.0
    """

    radius: float = 3.75e-3  #: m
    thickness: float = 6.6e-3  #: m, of the disks along their axis
    density: float = 1150.0  #: kg/m3
    gravity: float = 9.8  #: m/s2

    def __post_init__(self) -> None:
        check_positive(SceneError, **vars(self))

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

        Quantities are length, mass, time, velocity, frequency, acceleration, force, torque, energy, stiffness, damping,
        inertia, stress and pressure; another name is a SceneError.

        Examples
        --------
        >>> round(gr.LaboratoryUnits().unit("force"), 5)  # N
        0.00329
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
        """``value`` in SI units as a multiple of the reduced unit; scalars, lists or arrays of any shape.

        Examples
        --------
        >>> gr.LaboratoryUnits().to_reduced("length", [3.75e-3, 7.5e-3])
        array([1., 2.])
        """
        return _listed(value) / self.unit(quantity)

    @overload
    def to_laboratory(self, quantity: str, value: Value) -> Value: ...
    @overload
    def to_laboratory(self, quantity: str, value: Sequence[float]) -> NDArray[np.float64]: ...

    def to_laboratory(self, quantity, value):
        """``value`` in reduced units as SI units; scalars, lists or arrays of any shape.

        Examples
        --------
        >>> round(gr.LaboratoryUnits().to_laboratory("time", 20.0), 3)  # s
        0.391
        """
        return _listed(value) * self.unit(quantity)

    def reduced_scene(self, scene: Mapping[str, Any]) -> dict[str, Any]:
        """The data of a scene with its forces, displacements, stiffnesses, times, energies and motion in SI units.

        The keys are those of a scene file. Plain numbers stay, and columns of own disks, in any unit of length. A table
        that names its unit (``radius_mm``) must have the mean radius of these units, within 1 %; else a SceneError.
        Descriptions such as ``gr.Contact`` hold reduced numbers, so they are refused.

        Examples
        --------
        >>> units = gr.LaboratoryUnits()
        >>> data = {"contact": {"normal_stiffness": 2629.0}, "loads": [{"disk": "top-centre", "force": [0.0, -0.0493]}]}
        >>> scene = gr.Scene.from_dict(units.reduced_scene(data))
        >>> round(scene.contact.normal_stiffness), round(scene.loads[0].force[1], 1)
        (3000, -15.0)
        """

        def reduced(value: Any, quantity: str = "", keys: Mapping[str, str] = _KEYS) -> Any:
            if isinstance(value, Mapping):
                own = {key: _quantities(key, part, value) for key, part in value.items()}
                return {key: reduced(part, keys.get(key, ""), own[key]) for key, part in value.items()}
            if isinstance(value, Description) and keys.keys() & type(value).model_fields.keys():
                raise SceneError(f"a {type(value).__name__} holds reduced numbers, must be a mapping for those in SI")
            value = plain(value)
            if isinstance(value, list):
                return [reduced(part, quantity) for part in value]
            number = quantity and isinstance(value, (int, float)) and not isinstance(value, bool)
            return self.to_reduced(quantity, float(value)) if number else value

        require(isinstance(scene, Mapping), f"scene = {show(scene)}: must be a mapping with its keys", SceneError)
        self._check_radius(scene.get("packing"))
        return {key: reduced(part, keys=_quantities(key, part, scene)) for key, part in scene.items()}

    def _check_radius(self, packing: Any) -> None:
        """SceneError for a table with another mean radius; what is wrong with the table itself, a scene says."""
        mean, described = None, isinstance(packing, Mapping) and packing.get("kind") == "file"
        with contextlib.suppress(SceneError):
            packing = FilePacking(**packing) if described else packing
            mean = packing.mean_radius() if isinstance(packing, FilePacking) else None
        if mean is not None and not math.isclose(mean, self.radius, rel_tol=SAME_RADIUS):
            rule = f"must be within {SAME_RADIUS:.0%} of {mean:.4g}, the mean radius of {packing.path} in m"
            raise SceneError(describe(("radius",), self.radius, rule))


def _quantities(key: str, part: Any, whole: Mapping[str, Any]) -> Mapping[str, str]:
    """What the keys of a part of a scene are, by the unit that a law says of its parameters.

    The box of poured disks has no unit of its own, as that of a file has.
    """
    if key == "disk":
        return _PLACE
    if key == "parameters" and (law := KNOWN_LAWS.get(str(whole.get("law")))):
        units = {name: unit_of(name, info) for name, info in law.parameters.model_fields.items()}
        return {name: _QUANTITIES[unit] for name, unit in units.items() if unit in _QUANTITIES}
    poured = isinstance(part, Mapping) and part.get("kind") == "poured"
    return {**_KEYS, "width": "length"} if poured else _KEYS


def _listed(value):
    """Lists and tuples as arrays; all else, labelled arrays too, as it is."""
    return np.asarray(value, float) if isinstance(value, (list, tuple)) else value
