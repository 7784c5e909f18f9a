"""Forces and torques on chosen disks, and which disk is meant."""

from __future__ import annotations

from typing import Annotated, ClassVar, Final, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from ..errors import require
from .base import Description, Finite, Vector, allowed
from .errors import NotAllowed, SceneError, must, show, show_key
from .packing import Packing

TOP_CENTRE: Final = "top-centre"

#: A disk covers another if it stands more than this above the horizontal from it. In a triangular lattice the
#: neighbours stand at 0 and 60 degrees, so halfway between them.
COVERING_SLOPE = float(np.tan(np.pi / 6.0))

RowName = Annotated[
    Literal["top", "bottom"] | Annotated[int, Field(strict=True, ge=0)],
    allowed("must be top, bottom or the number of a row, 0 at the bottom"),
]


class RowSelector(Description):
    """A disk by its row in the lattice and its place there.

    Examples
    --------
    >>> gr.Load(disk=gr.Row(row="top", offset=-4), force=(0.0, -1.0)).disk.offset
    -4
    """

    row: RowName = Field(description="top, bottom, or the number of the row, 0 at the bottom.")
    offset: Annotated[int, Field(strict=True), allowed("must be a whole number")] = Field(
        default=0,
        description="Places to the right of the middle disk of the row (of the left one of the two in the middle).",
    )


class TopSelector(Description):
    """The disk on top nearest to a place, in any packing; ``top-centre`` is that at ``x = 0``.

    Examples
    --------
    >>> gr.Load(disk=gr.At(x=-10.0), force=(0.0, -1.0)).disk.x
    -10.0
    """

    x: Finite = Field(
        description="Distance from the middle of the packing, to the right, in its initial equilibrium. Of two equally "
        "near disks the one with the lower index.",
        json_schema_extra={"unit": "mean radius"},
    )


Selector = Annotated[
    Literal["top-centre"] | Annotated[int, Field(strict=True, ge=0)] | RowSelector | TopSelector,
    BeforeValidator(lambda value: TOP_CENTRE if isinstance(value, str) and value == "top-center" else value),
    allowed(
        "must be top-centre, the index of a disk, {x: number}, or {row: top | bottom | number, offset: whole number}"
    ),
]
Displacement = Annotated[
    tuple[Finite | None, Finite | None],
    allowed("must be two finite numbers [x, z], null for a direction that is left free"),
]


class Load(Description):
    """A force (mg) and a torque (mg × mean radius) on one disk, or a prescribed displacement (mean radii) of it.

    A displaced disk is held at its displacement, and the force that this takes is part of the result. The force acts
    along directions that are free, the torque on the rotation.

    Examples
    --------
    >>> gr.Load(disk="top-centre", force=(0.0, -4.0))
    Load(disk='top-centre', force=(0.0, -4.0))
    >>> pressed = gr.Load(disk="top-centre", displacement=(None, -0.01))
    """

    sparse: ClassVar[tuple[str, ...]] = ("displacement",)

    disk: Selector = Field(
        description="The loaded disk: the topmost one nearest the middle in the initial equilibrium (top-centre), an "
        "index, {x: distance from the middle}, or a place in a row."
    )
    force: Vector = Field(
        default=(0.0, 0.0),
        description="Force; z points up. Required without displacement or torque; must be 0 in directions that "
        "displacement prescribes.",
    )
    displacement: Displacement | None = Field(
        default=None,
        description="Prescribed displacement from the initial equilibrium in place of a force; null leaves a direction "
        "free.",
    )
    torque: Finite = Field(default=0.0, description="Torque, counter-clockwise.")

    @model_validator(mode="after")
    def _check_displacement(self) -> Load:
        if self.displacement is None:
            rule = "must be given, or displacement or torque"
            must(self.model_fields_set & {"force", "torque"}, rule, key=("force",), value=None)
            return self
        rule = "must hold a direction at least"
        must(self.displacement != (None, None), rule, key=("displacement",), value=list(self.displacement))
        for name, force, held in zip("xz", self.force, self.displacement, strict=True):
            rule = f"must be 0 along {name}, where displacement holds the disk"
            must(held is None or force == 0.0, rule, key=("force",), value=list(self.force))
        return self


def resolve_disk(
    selector: str | int | RowSelector | TopSelector,
    packing: Packing,
    position: NDArray[np.float64],
    *,
    key: str = "disk",
) -> int:
    """Index of the disk that ``selector`` means.

    ``top-centre`` looks at ``position`` (n, 2), the centres at rest. A disk is on top if no disk that is
    closer to it horizontally than the sum of their radii stands above it at more than 30 degrees from the
    horizontal. Of the disks on top it is the one nearest to the middle between the walls, and of two
    equally near (within 1e-6) the one with the lower index. In a lattice with a long row at the top this is
    the middle disk of that row. A ``TopSelector`` means the disk on top nearest to its ``x`` from the middle.

    Raises SceneError for a disk or a row that the packing does not have, and an ``x`` beyond its sides; ``key`` is what
    the message calls the selector.
    """
    if selector == TOP_CENTRE:
        return _nearest_on_top(packing, packing.middle, np.asarray(position))
    if isinstance(selector, TopSelector):
        half = 0.5 * packing.width
        rule = f"must be from {-half:g} to {half:g}, the packing is {packing.width:g} wide"
        require(abs(selector.x) <= half, f"{key}.x = {show(selector.x)}: {rule}", SceneError)
        return _nearest_on_top(packing, packing.middle + selector.x, np.asarray(position))
    try:
        return check_disk(selector, packing.n, packing.row_count)
    except NotAllowed as problem:
        part = f".{show_key(problem.key)}" if problem.key else ""
        raise SceneError(f"{key}{part} = {show(problem.value)}: {problem.allowed}") from None


def check_disk(
    selector: str | int | RowSelector, n: int, row_count: NDArray[np.int64], at: tuple[str | int, ...] = ()
) -> int:
    """As ``resolve_disk``, for a selector that needs no positions, by the numbers of disks alone.

    Raises NotAllowed; the selector stands ``at`` this place.
    """
    if isinstance(selector, int):
        must(0 <= selector < n, f"must be from 0 to {n - 1}, the packing has {n} disks", key=at, value=selector)
        return int(selector)
    if not isinstance(selector, RowSelector):
        rule = "must be top-centre, the index of a disk, a TopSelector or a RowSelector"
        raise NotAllowed(rule, key=at, value=selector)
    rows, row = len(row_count), selector.row
    rule = "only slabs and piles have rows, must be top-centre, {x: number} or the index of a disk"
    must(rows, rule, key=(*at, "row"), value=row)
    row = {"top": rows - 1, "bottom": 0}[row] if isinstance(row, str) else row
    rule = f"must be top, bottom or from 0 to {rows - 1}, the packing has {rows} rows"
    must(row < rows, rule, key=(*at, "row"), value=row)
    middle = (int(row_count[row]) - 1) // 2
    last = int(row_count[row]) - 1 - middle
    rule = f"must be from {-middle} to {last}, row {row} has {row_count[row]} disks"
    must(-middle <= selector.offset <= last, rule, key=(*at, "offset"), value=selector.offset)
    return int(row_count[:row].sum()) + middle + selector.offset


def _nearest_on_top(packing: Packing, place: float, position: NDArray[np.float64]) -> int:
    radius, box, z = packing.radius, packing.box, position[:, 1]
    away, largest = np.abs(box.separation(position, np.array([place, 0.0]))[:, 0]), float(radius.max())
    reach = 4.0 * largest
    found: list[int] = []
    while not found:
        # Only disks near the place are looked at; the band grows in the odd case that none is on top.
        band, around = (np.flatnonzero(away <= reach + more) for more in (0.0, 2.0 * largest))
        for i in band[np.argsort(away[band], kind="stable")]:
            if found and away[i] > away[found[0]] + 1e-6:
                break
            dx, dz = np.abs(box.separation(position[around], position[i])[:, 0]), z[around] - z[i]
            if not np.any((dx < radius[around] + radius[i]) & (dz > 0.0) & (dz > COVERING_SLOPE * dx)):
                found.append(int(i))
        reach *= 2.0
    return min(found)
