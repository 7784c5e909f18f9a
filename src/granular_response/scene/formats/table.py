"""What every format yields: the columns of a table of disks, and what the parsers of text share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...state import FloatArray


class FormatError(ValueError):
    """A file that is not of its format. ``place`` is where in the file, such as ``line 7``."""

    def __init__(self, rule: str, place: str = "") -> None:
        super().__init__(rule)
        self.place = place


@dataclass(frozen=True)
class Table:
    """n disks in the unit of length of their file, measured from the lower left corner of its box if it has one."""

    x: FloatArray  #: (n,)
    z: FloatArray  #: (n,) heights
    radius: FloatArray  #: (n,)
    places: Sequence[str]  #: (n,) where each disk stands in the file, such as "line 7"
    mass: FloatArray | None = None  #: (n,) in any unit; None where all disks are of one material
    width: float | None = None  #: of the file's box


def number(text: str, name: str, place: str) -> float:
    """A finite number. Raises FormatError with the name of its column."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        shown = text.strip()
        shown = repr(shown if len(shown) <= 24 else shown[:21] + "...")
        raise FormatError(f"{name} = {shown}: must be a finite number", place)
    return value


def numbers(cells: Sequence[str], names: Sequence[str], place: str) -> list[float]:
    """One number for each name."""
    return [number(cell, name, place) for cell, name in zip(cells, names, strict=True)]


def heights(y: FloatArray, z: FloatArray) -> FloatArray:
    """The coordinate of disks in one plane that points up: y or z, whichever differs, or is not 0.

    Raises FormatError where both differ.
    """
    if len(y) == 0:
        return z
    flat_y, flat_z = np.ptp(y) == 0.0, np.ptp(z) == 0.0
    if not flat_y and not flat_z:
        raise FormatError("disks must lie in one plane, y or z must be the same for all")
    return z if flat_y and not (flat_z and z[0] == 0.0) else y
