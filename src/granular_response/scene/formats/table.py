"""What every format yields: the columns of a table of disks, and what the parsers of text share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import GranularError
from ...state import FloatArray


class FormatError(GranularError, ValueError):
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
    periodic: bool | None = None  #: whether that box is in x; None where the file does not say


def number(text: str, name: str, place: str) -> float:
    """A finite number. Raises FormatError with the name of its column."""
    try:
        value = math.nan if "_" in text else float(text)  # 1_0 is Python's, and no table's
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FormatError(f"{name} = {shown(text)}: must be a finite number", place)
    return value


def shown(text: str) -> str:
    """What stands in a cell, quoted and cut."""
    text = text.strip()
    return repr(text if len(text) <= 24 else text[:21] + "...")


def numbers(cells: Sequence[str], names: Sequence[str], place: str) -> list[float]:
    """One number for each name."""
    return [number(cell, name, place) for cell, name in zip(cells, names, strict=True)]


def by_id(ids: Sequence[str], places: Sequence[str]) -> list[int]:
    """The order of disks by their ids, as LAMMPS writes them in any order.

    Raises FormatError for an id that is no whole number or that two disks have.
    """
    first: dict[int, int] = {}
    for k, (text, place) in enumerate(zip(ids, places, strict=True)):
        if not (text.isdecimal() and len(text) <= 20):  # LAMMPS has 64 bits
            raise FormatError(f"id = {shown(text)}: must be a whole number", place)
        if (known := first.setdefault(int(text), k)) != k:
            raise FormatError(f"id = {int(text)}: must differ from that of {places[known]}", place)
    return [first[value] for value in sorted(first)]


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
