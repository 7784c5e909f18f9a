"""GSD files: the last frame. A missing chunk has the value that the format gives it: masses and diameters of 1.

The box of the format is periodic along every axis, and says nothing of walls. Our own files say theirs in the log
entries ``origin``, ``box_width`` and ``periodic``.

The layout is read here and not by the library of the format, which takes what a damaged file says as long as it can be
read: of 700 damaged files it read 180 and this reader 34, two of them as another packing and eight by asking for more
memory than there is. It is not needed to read a packing either.
"""

from __future__ import annotations

import math
import struct
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...inputs import read_bytes
from ...state import FloatArray
from .content import foreign
from .table import FileBox, FormatError, Table, must, upward

_REASON = "a GSD file does not say what bounds its particles"

#: Magic number, place and size of the index and of the list of names, versions of schema and format.
_HEADER = struct.Struct("<5Q2I")
_MAGIC = 0x65DF65DF65DF65DF
_ENTRY = np.dtype(
    [("frame", "<u8"), ("rows", "<u8"), ("at", "<i8"), ("columns", "<u4"), ("name", "<u2"), ("kind", "u1"), ("_", "u1")]
)
_NAME_BYTES = 64
_DAMAGED = "is not a whole GSD file: it is cut or damaged"
#: Columns of chunks with a row for each particle.
_OF_PARTICLES = {
    "position": 3, "orientation": 4, "velocity": 3, "angmom": 4, "moment_inertia": 3, "image": 3, "diameter": 1,
    "mass": 1, "charge": 1, "body": 1, "typeid": 1,
}  # fmt: skip
#: Kinds of values by their code, from 1 on. The last one is text, which logs have.
_KINDS = ("u1", "<u2", "<u4", "<u8", "i1", "<i2", "<i4", "<i8", "<f4", "<f8", "S1")
#: Other names that the format has, and beginnings of those that its users make.
_NAMES = {f"particles/{name}" for name in (*_OF_PARTICLES, "N", "types", "type_shapes")}
_NAMES |= {f"configuration/{name}" for name in ("step", "dimensions", "box")}
_GROUPS = ("bonds", "angles", "dihedrals", "impropers", "constraints", "pairs", "state", "log")


class _Frames:
    """The chunks of a file by name, of the last frame or, where it has none, of the first."""

    def __init__(self, data: bytes) -> None:
        if len(data) < _HEADER.size or _HEADER.unpack_from(data)[0] != _MAGIC:
            if said := foreign(data):
                raise FormatError(said)
            raise FormatError("is not a GSD file with particles: it does not begin as one")
        _, index_at, index_size, names_at, names_size, _, _ = _HEADER.unpack_from(data)
        self._data = data
        names = self._bytes(names_at, names_size * _NAME_BYTES).split(b"\0")
        self._names = [name.decode("ascii", "replace") for name in names if name]
        index = np.frombuffer(self._bytes(index_at, index_size * _ENTRY.itemsize), _ENTRY)
        used = int(np.argmin(index["at"] > 0)) if (index["at"] <= 0).any() else len(index)
        must(not index[used:].tobytes().strip(b"\0"), f"{_DAMAGED}: its index goes on after its end")
        self._index = index[:used]
        must(len(self._index), "is not a GSD file with particles: it has no frame")
        self.last = int(self._index["frame"].max())
        lists = [(index_at, index_size * _ENTRY.itemsize), (names_at, names_size * _NAME_BYTES)]
        self._check_index([(0, _HEADER.size), *lists])

    def _check_index(self, regions: list[tuple[int, int]]) -> None:
        """Raise FormatError unless frames are numbered one by one, and each chunk has a name and a place of its own."""
        frame, name = self._index["frame"], self._index["name"]
        if frame[0] != 0 or (np.diff(frame.astype(np.int64)) < 0).any() or len(np.unique(frame)) != self.last + 1:
            raise FormatError(f"{_DAMAGED}: its frames are not numbered one by one")
        rule = f"{_DAMAGED}: its list of names"
        must(len(set(self._names)) >= len(self._names) and name.max() < len(self._names), rule)
        rule = f"{_DAMAGED}: a chunk is given twice in a frame"
        must(len(np.unique(np.stack([frame, name.astype(np.uint64)]), axis=1).T) >= len(frame), rule)
        for one in self._names:
            if one not in _NAMES and one.partition("/")[0] not in _GROUPS:
                raise FormatError(f"{_DAMAGED}: its list of names has one that the format does not have")
        kind = self._index["kind"]
        if not ((kind >= 1) & (kind <= len(_KINDS))).all():
            raise FormatError(f"{_DAMAGED}: a chunk has values of an unknown kind, code {int(kind.max())}")
        sizes = np.array([np.dtype(one).itemsize for one in _KINDS])[kind - 1]
        rows, columns, at = (self._index[one].tolist() for one in ("rows", "columns", "at"))
        regions += [(a, r * c * s) for a, r, c, s in zip(at, rows, columns, sizes.tolist(), strict=True)]
        regions = sorted((start, start + size) for start, size in regions if size)
        rule = f"{_DAMAGED}: two of its parts stand in the same place"
        must(not any(end > start for (_, end), (start, _) in pairwise(regions)), rule)
        if (end := regions[-1][1]) != len(self._data):
            raise FormatError(f"{_DAMAGED}: its parts end at byte {end}, it has {len(self._data)}")

    def _bytes(self, start: int, size: int) -> bytes:
        must(start + size <= len(self._data), _DAMAGED)
        return self._data[start : start + size]

    def _chunk(self, frame: int, name: str) -> NDArray | None:
        if name not in self._names:
            return None
        here = self._index[(self._index["frame"] == frame) & (self._index["name"] == self._names.index(name))]
        if not len(here):
            return None
        rows, columns, at, kind = (int(here[0][key]) for key in ("rows", "columns", "at", "kind"))
        number = np.dtype(_KINDS[kind - 1])
        return np.frombuffer(self._bytes(at, rows * columns * number.itemsize), number).reshape(rows, columns)

    def check(self, name: str, rows: int, columns: int) -> None:
        """Raise FormatError where the last frame has a chunk of another shape."""
        found = self._chunk(self.last, name)
        if found is not None and found.shape != (rows, columns):
            raise FormatError(f"chunk {name}: has {found.size} values, must have {rows * columns}")

    def has(self, name: str) -> bool:
        """Whether any frame that counts has the chunk."""
        return any(self._chunk(frame, name) is not None for frame in (self.last, 0))

    def values(self, name: str, default: float | None, shape: tuple[int, ...]) -> FloatArray:
        """A chunk of that shape as numbers; ``default`` is what the format takes for a missing one, None: an error."""
        kinds = "u" if name == "particles/N" else "f" if name.startswith(("particles/", "configuration/")) else "uif"
        for frame in (self.last, 0):
            if (found := self._chunk(frame, name)) is None:
                continue
            must(found.dtype.kind in kinds, f"chunk {name}: has values of another kind, {found.dtype}")
            if found.size == math.prod(shape):
                return found.astype(float).reshape(shape)
            if frame == self.last:
                raise FormatError(f"chunk {name}: has {found.size} values, must have {math.prod(shape)}")
        must(default is not None, f"is not a GSD file with particles: chunk {name} is missing")
        return np.full(shape, default)


def read(path: Path) -> Table:
    """The particles as disks."""
    frames = _Frames(read_bytes(path))
    count = float(frames.values("particles/N", 0.0, ()))
    must(0 < count < 2**31, "has no particles")
    n = int(count)
    for name, columns in _OF_PARTICLES.items():
        frames.check(f"particles/{name}", n, columns)
    x, y, z = frames.values("particles/position", None, (n, 3)).T
    diameter, mass = (frames.values(f"particles/{name}", 1.0, (n,)) for name in ("diameter", "mass"))
    box = frames.values("configuration/box", None, (6,))
    must(np.isfinite(box).all() and box[0] > 0.0, "the box must be of some size")
    must(not box[3:].any(), "the box must not be tilted")
    places = [f"particle {k}" for k in range(n)]
    up, which = y if upward(y, z) == "y" else z, f"{frames.last + 1} of {frames.last + 1}"
    return Table(x, up, 0.5 * diameter, places, mass, _file_box(frames, float(box[0])), frame=which)


def _file_box(frames: _Frames, width: float) -> FileBox:
    if not all(frames.has(f"log/{name}") for name in ("origin", "box_width", "periodic")):
        return FileBox(-0.5 * width, width, reason=_REASON)
    left, floor, _ = frames.values("log/origin", None, (3,)).tolist()
    own, periodic = (float(frames.values(f"log/{name}", None, ())) for name in ("box_width", "periodic"))
    rule = "log entries origin, box_width, periodic: must be places, a width and 0 or 1"
    must(np.isfinite([left, floor, own]).all() and own > 0.0 and periodic in (0.0, 1.0), rule)
    return FileBox(left, own, floor, bool(periodic))
