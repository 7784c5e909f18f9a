"""What every format yields: the columns of a table of disks and its box, and what the parsers of text share."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...errors import GranularError
from ...inputs import read_bytes
from ...state import FloatArray
from .content import foreign


class FormatError(GranularError, ValueError):
    """A file that is not of its format. ``place`` is where in the file, such as ``line 7``."""

    def __init__(self, rule: str, place: str = "") -> None:
        super().__init__(rule)
        self.place = place


def must(met: object, rule: str, place: str = "") -> None:
    """Raise FormatError unless a condition is ``met``."""
    if not met:
        raise FormatError(rule, place)


@dataclass(frozen=True)
class FileBox:
    """What a file says of the box, in its unit of length and its coordinates; None is what it does not say.

    The box of another program is not always what bounds the disks: it may follow them, or have no floor.
    """

    left: float | None = None  #: where it begins in x; known walls where ``periodic`` is False
    width: float | None = None
    floor: float | None = None  #: height of the floor
    periodic: bool | None = None  #: whether it is in x; None: ``left`` and ``width`` hold for periodic sides alone
    reason: str = "the file has no box"  #: why something is not known


#: Remark on a file of a program that knows the masses of its particles, and has not written them.
NO_MASSES = "has no masses; taken as those of one material, in proportion to the square of the radius"

#: Tables that have no box: walls and floor are where their coordinates are 0.
NO_BOX = FileBox(left=0.0, floor=0.0, periodic=None)


@dataclass(frozen=True)
class Table:
    """n disks in the unit of length and the coordinates of their file."""

    x: FloatArray  #: (n,)
    z: FloatArray  #: (n,) heights
    radius: FloatArray  #: (n,)
    places: Sequence[str]  #: (n,) where each disk stands in the file, such as "line 7"
    mass: FloatArray | None = None  #: (n,) in any unit; None where the file says nothing of masses
    box: FileBox = field(default=NO_BOX)
    remark: str = ""  #: what a reader should know where disks differ in size
    #: (n,) motion of the disks, nan where a cell is no number, and forces of walls on them
    columns: Mapping[str, FloatArray] | None = None
    ids: Sequence[int] | None = None  #: (n,) by which other files call the disks
    frame: str = ""  #: which frame of its file this is, such as "3 of 3, time step 200", where the format has frames
    unit: str = ""  #: of its lengths, such as mm, where the file says it
    notes: Sequence[str] = ()  #: what was taken where the file may mean something else


@dataclass(frozen=True)
class Mark:
    """The line by which our own tables say what their format has no place for, and by which a cut one is known."""

    disks: int
    width: float
    periodic: bool

    _PATTERN = re.compile(r"granular-response: (\d{1,20}) disks, width (\S+), sides (walls|periodic)\b")

    def __str__(self) -> str:
        sides = "periodic" if self.periodic else "walls"
        return f"granular-response: {self.disks} disks, width {self.width!r}, sides {sides}"

    @property
    def box(self) -> FileBox:
        return FileBox(0.0, self.width, 0.0, self.periodic)

    @classmethod
    def found(cls, line: str, place: str) -> Mark | None:
        """The mark in a line; None if it is another one."""
        match = cls._PATTERN.search(line)
        if match is None:
            rule = "is a damaged first line of a table of granular-response"
            must("granular-response" not in line.partition("#")[2], rule, place)
            return None
        width = number(match[2], "width", place)
        must(width > 0.0, f"width = {shown(match[2])}: must be greater than 0", place)
        return cls(int(match[1]), width, match[3] == "periodic")

    def check(self, disks: int, whole: bool) -> None:
        """Raise FormatError unless there are as many disks as it says, and the last line is ``whole``."""
        must(disks == self.disks, f"holds {disks} of the {self.disks} disks of its first line")
        must(whole, "is cut: its last line has no end")


#: What ends a line for Python beside \\n and \\r.
_OTHER_ENDS = tuple("\v\f\x1c\x1d\x1e\x85\u2028\u2029")


class Once:
    """Where each thing that a file says once stands in it."""

    def __init__(self) -> None:
        self._places: dict[str, str] = {}

    def add(self, what: str, place: str) -> None:
        """Note it. Raises FormatError, with both places, where it is said a second time."""
        if (first := self._places.setdefault(what, place)) != place:
            raise FormatError(f"{what}: is given twice, in {first} and here; must be given once", place)


def lines_of(path: Path) -> tuple[list[tuple[str, str]], bool]:
    """The lines of a text file, each after its place, and whether the last one has an end. OSError, UnicodeError.

    Raises FormatError for a file of another kind, and for what ends lines or pages elsewhere: in a comment it would
    take the row after it along.
    """
    data = read_bytes(path)
    if said := foreign(data):
        raise FormatError(said)
    text = data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    found = text.split("\n")[: -1 if text.endswith("\n") else None]
    lines = [(f"line {k}", line) for k, line in enumerate(found, start=1)]
    for place, line in lines:
        if len(line.splitlines()) > 1 or line[-1:] in _OTHER_ENDS:
            raise FormatError("has a line or page end of another kind within, must be one line", place)
    return lines, text.endswith("\n") or not text


def number(text: str, name: str, place: str) -> float:
    """A finite number. Raises FormatError with the name of its column."""
    try:  # 1_0 and digits of other scripts are Python's, and no table's
        value = math.nan if "_" in text or not text.isascii() else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        point = " with a decimal point, not a comma" if "," in text else ""
        raise FormatError(f"{name} = {shown(text)}: must be a finite number{point}", place)
    return value


def whole_number(text: str) -> int | None:
    """A whole number, 0 or greater, as other programs write it, with 64 bits; None for anything else."""
    return int(text) if text.isascii() and text.isdecimal() and len(text) <= 20 else None


def shown(text: str) -> str:
    """What stands in a cell, quoted and cut."""
    text = text.strip()
    return repr(text if len(text) <= 24 else text[:21] + "...")


def listed(names: Sequence[str]) -> str:
    """The first names of a header."""
    return ", ".join(shown(name)[1:-1] for name in names[:12]) + (", ..." if len(names) > 12 else "")


def numbers(cells: Sequence[str], names: Sequence[str], place: str) -> list[float]:
    """One number for each name. Raises FormatError for another count, too."""
    must(len(cells) == len(names), f"has {len(cells)} values, must have {' '.join(names)}", place)
    return [number(cell, name, place) for cell, name in zip(cells, names, strict=True)]


def bounds(low: float, high: float, axis: str, place: str) -> tuple[float, float]:
    """Where a box begins along an axis, and how far it reaches. Raises FormatError unless it is of some size."""
    rule = f"bounds of the box in {axis}: the upper one must be greater than the lower one"
    must(0.0 < high - low < math.inf, rule, place)
    return low, high - low


def upright(turned: Sequence[float], place: str) -> None:
    """Raise FormatError unless all these components of the box's edges are 0."""
    must(not any(turned), "the box must not be tilted or turned, its edges must lie along x, y and z", place)


def by_id(ids: Sequence[str], places: Sequence[str]) -> dict[int, int]:
    """Where the disk of each id stands, in the order of ids; LAMMPS writes them in any order.

    Raises FormatError for an id that is no whole number or that two disks have.
    """
    first: dict[int, int] = {}
    for k, (text, place) in enumerate(zip(ids, places, strict=True)):
        value = whole_number(text)
        if value is None:
            raise FormatError(f"id = {shown(text)}: must be a whole number", place)
        if (known := first.setdefault(value, k)) != k:
            raise FormatError(f"id = {value}: must differ from that of {places[known]}", place)
    return dict(sorted(first.items()))


#: How far, relative to the largest, numbers that other programs print may differ and still be the same.
PRINTED = 1e-5


def agree(names: Sequence[str], one: FloatArray, other: FloatArray, places: Sequence[str], period: float = 0.0) -> None:
    """Raise FormatError, with both names, unless two columns say the same, up to printing and whole periods."""
    apart = one - other
    if period:
        apart = apart - period * np.round(apart / period)
    wrong = ~(np.abs(apart) <= PRINTED * max(float(np.abs(one).max()), float(np.abs(other).max()), period))
    if wrong.any():
        k = int(np.argmax(wrong))
        pair = " and ".join(f"{shown(name)[1:-1]}" for name in names)
        raise FormatError(f"columns {pair} contradict each other; must agree, or be one of the two", places[k])


def radii(columns: dict[str, FloatArray], places: Sequence[str]) -> FloatArray:
    """Radii from columns ``radius`` and ``diameter``, of which there is one at least; two must agree."""
    if "diameter" not in columns:
        return columns["radius"]
    half = 0.5 * columns["diameter"]
    if "radius" not in columns:
        return half
    agree(("radius", "diameter"), columns["radius"], half, places)
    return columns["radius"]


def upward(y: FloatArray, z: FloatArray) -> str:
    """The axis of disks in one plane that points up: y or z, whichever differs, or is not 0.

    Raises FormatError where both differ.
    """
    flat_y, flat_z = np.ptp(y) == 0.0, np.ptp(z) == 0.0
    must(flat_y or flat_z, "disks must lie in one plane, y or z must be the same for all")
    return "z" if flat_y and not (flat_z and z[0] == 0.0) else "y"
