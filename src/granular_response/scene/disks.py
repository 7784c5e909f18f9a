"""A table of disks as a packing: what is allowed of its numbers, and the rescaling to reduced units."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..state import FloatArray
from ..state.box import FARTHEST
from .errors import Problem
from .formats import Table
from .packing import Packing, exact_mean

#: By which lengths of a file may be off, relatively: some formats have single precision.
ROUNDING = 1e-6
#: Least mass and radius of a disk as parts of the largest: what a smaller one does is lost in the rounding of others.
LEAST_MASS, LEAST_RADIUS = 1e-12, 1e-6


def packed(table: Table, left: float, floor: float, width: float, periodic: bool) -> Packing:
    """The disks above ``floor`` and right of ``left``, in a box of this ``width``, in mean radii and mean masses.

    Raises Problem with the key ``(column, disk)`` for a value that is not allowed, ``(disk,)`` for a disk in the place
    of another, ``("width",)`` for a box that is too wide.
    """
    radius, places = table.radius, table.places
    x, z = table.x - left, table.z - floor
    for name, values in (("x", x), ("z", z), ("radius", radius)):
        _check(name, values, np.isfinite(values), "must be a finite number")
    _check("radius", radius, radius > 0.0, "must be greater than 0")
    mass = (radius / radius.max()) ** 2 if table.mass is None else table.mass
    _check("mass", mass, np.isfinite(mass), "must be a finite number")
    mean = exact_mean(radius)
    far = FARTHEST * mean
    if width > far:
        raise Problem(f"must be at most {far:g}, 1e9 mean radii", key=("width",), value=width)
    if periodic:
        x = np.mod(x, width)
    half = 0.5 * width
    wide = half * (1.0 + ROUNDING)
    large, heavy = LEAST_RADIUS * radius.max(), LEAST_MASS * mass.max()
    reach = f"from {float((table.x - radius).min()):.6g} to {float((table.x + radius).max()):.6g}"
    between = (
        f"must be between the side walls {left:g} and {left + width:g}; the disks reach {reach}, packing.origin says "
        "where left wall and floor are"
    )
    for name, values, good, rule in (
        ("x", table.x, periodic | ((x > 0.0) & (x < width)), between),
        ("radius", radius, radius <= wide, f"must be at most {half:g}, half the width of the box"),
        ("radius", radius, radius >= large, f"must be at least {large:g}, a millionth of the largest"),
        ("z", table.z, z > 0.0, f"must be above the floor {floor:g}, which packing.origin says"),
        ("z", table.z, z <= far, f"must be at most {floor + far:g}, 1e9 mean radii"),
        ("mass", mass, mass > 0.0, "must be greater than 0"),
        ("mass", mass, mass >= heavy, f"must be at least {heavy:g}, 1e-12 of the largest"),
    ):
        _check(name, values, good, rule)
    order = np.lexsort((z, x))
    same = np.flatnonzero((np.diff(x[order]) == 0.0) & (np.diff(z[order]) == 0.0))
    if len(same):
        one, two = sorted(map(int, order[same[0] : same[0] + 2]))
        raise Problem(f"disk is in the same place as that of {places[one]}", key=(two,))
    position = np.ascontiguousarray(np.stack([x, z], axis=1) / mean)
    return Packing(
        position=position,
        given=position,
        radius=radius / mean,
        row=np.full(len(radius), -1, dtype=np.int32),
        width=float(width / mean),
        periodic=periodic,
        given_mass=None if table.mass is None else mass / exact_mean(mass),
        columns=table.columns,
        frame=table.frame,
    )


def _check(name: str, values: FloatArray, good: NDArray[np.bool_], rule: str) -> None:
    """Problem for the first of the ``values`` that is not ``good``."""
    if not np.all(good):
        bad = int(np.argmin(good))
        raise Problem(rule, key=(name, bad), value=float(values[bad]))
