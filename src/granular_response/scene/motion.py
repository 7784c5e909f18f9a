"""The motion with which the disks of a scene start."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ..state import FloatArray
from .base import Flag, Sparse, allowed
from .errors import SceneError, describe
from .formats.csv_table import MOTION
from .packing import Packing

COLUMN = "column"

Numbers = Annotated[
    Annotated[float, Field(strict=True)]
    | Annotated[tuple[Annotated[float, Field(strict=True)], ...], Field(min_length=1)]
    | Literal["column"],
    allowed("must be a finite number, a list of one for each disk, or column"),
]


class Motion(Sparse):
    """Velocities and spins with which disks start, for :func:`granular_response.motion`.

    A number is that of all disks, a list has one for each; ``column`` takes them from the file of the packing: the
    column of that name, without a unit, in a CSV table, the velocities of a LAMMPS data file, ``vx vy omegaz`` of a
    dump. Equilibria are found from rest, so ``solve`` refuses a scene with a motion.

    Examples
    --------
    >>> scene = gr.Scene(packing=gr.Slab(layers=1, disks_per_row=2), motion=gr.Motion(vx=[0.1, -0.1]), loads=[])
    >>> scene.motion.vx
    (0.1, -0.1)
    """

    sparse: ClassVar[tuple[str, ...]] = (*MOTION, "weightless")

    vx: Numbers = Field(default=0.0, description="Velocity to the right at the start.")
    vz: Numbers = Field(default=0.0, description="Velocity upwards at the start.")
    spin: Numbers = Field(
        default=0.0, description="Angular velocity at the start, counter-clockwise; needs friction of disks or walls."
    )
    weightless: Flag = Field(default=False, description="Whether the disks move without gravity.")

    @property
    def key(self) -> str:
        """The first key that is not its default; empty where the disks start at rest."""
        changed = [name for name, info in type(self).model_fields.items() if getattr(self, name) != info.default]
        return f"motion.{changed[0]}" if changed else ""

    def of(self, packing: Packing) -> FloatArray:
        """(n, 3) velocities and spins of the disks of a packing; SceneError where the numbers are not those of it."""
        found = np.zeros((packing.n, 3))
        for k, name in enumerate(MOTION):
            given = getattr(self, name)
            if given == COLUMN:
                columns = packing.columns or {}
                if name not in columns:
                    rule = f"must be numbers, the packing is from no file with a column {name} in reduced units"
                    raise SceneError(describe(("motion", name), given, rule))
                given = columns[name]
                if not np.isfinite(given).all():
                    bad = int(np.argmin(np.isfinite(given)))
                    rule = f"column {name}: must be a finite number for each disk, disk {bad} (counted from 0) has none"
                    raise SceneError(describe(("motion", name), COLUMN, rule))
            elif not isinstance(given, float) and len(given) != packing.n:
                rule = f"must have one number for each of the {packing.n} disks, has {len(given)}"
                raise SceneError(describe(("motion", name), list(given), rule))
            found[:, k] = given
        return found
