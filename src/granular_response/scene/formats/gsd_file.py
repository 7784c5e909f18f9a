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


#: Chunks of a frame by name.
_Chunks = dict[str, NDArray]


def _frames(data: bytes) -> tuple[_Chunks, _Chunks, int]:
    """The chunks of the last frame and of the first one, and how many frames there are."""
    if len(data) < _HEADER.size or _HEADER.unpack_from(data)[0] != _MAGIC:
        raise FormatError(foreign(data) or "is not a GSD file with particles: it does not begin as one")
    _, index_at, index_size, names_at, names_size, _, _ = _HEADER.unpack_from(data)
    lists = [(0, _HEADER.size), (index_at, index_size * _ENTRY.itemsize), (names_at, names_size * _NAME_BYTES)]
    must(all(at + size <= len(data) for at, size in lists), _DAMAGED)
    raw, listed = (data[at : at + size] for at, size in lists[1:])
    names = [name.decode("ascii", "replace") for name in listed.split(b"\0") if name]
    index = np.frombuffer(raw, _ENTRY)
    used = int(np.argmin(index["at"] > 0)) if (index["at"] <= 0).any() else len(index)
    must(not index[used:].tobytes().strip(b"\0"), f"{_DAMAGED}: its index goes on after its end")
    index = index[:used]
    must(len(index), "is not a GSD file with particles: it has no frame")
    last = int(index["frame"].max())
    _check(index, names, last, lists, len(data))
    found: dict[int, _Chunks] = {0: {}, last: {}}
    for frame, rows, at, columns, name, kind, _ in index[np.isin(index["frame"], [0, last])].tolist():
        number = np.dtype(_KINDS[kind - 1])
        values = np.frombuffer(data[at : at + rows * columns * number.itemsize], number)
        found[frame][names[name]] = values.reshape(rows, columns)
    return found[last], found[0], last + 1


def _check(index: NDArray, names: list[str], last: int, regions: list[tuple[int, int]], size: int) -> None:
    """Raise FormatError unless frames are numbered one by one, and each chunk has a name and a place of its own."""
    frame, name, kind = index["frame"], index["name"], index["kind"]
    if frame[0] != 0 or (np.diff(frame.astype(np.int64)) < 0).any() or len(np.unique(frame)) != last + 1:
        raise FormatError(f"{_DAMAGED}: its frames are not numbered one by one")
    rule = f"{_DAMAGED}: its list of names"
    must(len(set(names)) >= len(names) and name.max() < len(names), rule)
    rule = f"{_DAMAGED}: a chunk is given twice in a frame"
    must(len(np.unique(np.stack([frame, name.astype(np.uint64)]), axis=1).T) >= len(frame), rule)
    known = all(one in _NAMES or one.partition("/")[0] in _GROUPS for one in names)
    must(known, f"{_DAMAGED}: its list of names has one that the format does not have")
    if not ((kind >= 1) & (kind <= len(_KINDS))).all():
        raise FormatError(f"{_DAMAGED}: a chunk has values of an unknown kind, code {int(kind.max())}")
    sizes = np.array([np.dtype(one).itemsize for one in _KINDS])[kind - 1]
    rows, columns, at = (index[one].tolist() for one in ("rows", "columns", "at"))
    regions = [*regions, *((a, r * c * s) for a, r, c, s in zip(at, rows, columns, sizes.tolist(), strict=True))]
    ends = sorted((start, start + length) for start, length in regions if length)
    rule = f"{_DAMAGED}: two of its parts stand in the same place"
    must(not any(end > start for (_, end), (start, _) in pairwise(ends)), rule)
    must(ends[-1][1] == size, f"{_DAMAGED}: its parts end at byte {ends[-1][1]}, it has {size}")


def read(path: Path) -> Table:
    """The particles as disks."""
    last, first, count = _frames(read_bytes(path))

    def values(name: str, default: float | None, shape: tuple[int, ...]) -> FloatArray:
        """A chunk of that shape as numbers; ``default`` is what the format takes for a missing one, None: an error."""
        kinds = "u" if name == "particles/N" else "f" if name.startswith(("particles/", "configuration/")) else "uif"
        size, found = math.prod(shape), last.get(name, first.get(name))
        if found is not None:
            must(found.dtype.kind in kinds, f"chunk {name}: has values of another kind, {found.dtype}")
            if found.size == size:
                return found.astype(float).reshape(shape)
            must(name not in last, f"chunk {name}: has {found.size} values, must have {size}")
        must(default is not None, f"is not a GSD file with particles: chunk {name} is missing")
        return np.full(shape, default)

    number = float(values("particles/N", 0.0, ()))
    must(0 < number < 2**31, "has no particles")
    n = int(number)
    for name, columns in _OF_PARTICLES.items():
        chunk = last.get(f"particles/{name}", np.empty((n, columns)))
        rule = f"chunk particles/{name}: has {chunk.size} values, must have {n * columns}"
        must(chunk.shape == (n, columns), rule)
    x, y, z = values("particles/position", None, (n, 3)).T
    diameter, mass = (values(f"particles/{name}", 1.0, (n,)) for name in ("diameter", "mass"))
    edges = values("configuration/box", None, (6,))
    must(np.isfinite(edges).all() and edges[0] > 0.0, "the box must be of some size")
    must(not edges[3:].any(), "the box must not be tilted")
    box = FileBox(-0.5 * float(edges[0]), float(edges[0]), reason=_REASON)
    if {"log/origin", "log/box_width", "log/periodic"} <= {*first, *last}:
        left, floor, _ = values("log/origin", None, (3,)).tolist()
        own, periodic = (float(values(f"log/{name}", None, ())) for name in ("box_width", "periodic"))
        rule = "log entries origin, box_width, periodic: must be places, a width and 0 or 1"
        must(np.isfinite([left, floor, own]).all() and own > 0.0 and periodic in (0.0, 1.0), rule)
        box = FileBox(left, own, floor, bool(periodic))
    places, up = [f"particle {k}" for k in range(n)], y if upward(y, z) == "y" else z
    return Table(x, up, 0.5 * diameter, places, mass, box, frame=f"{count} of {count}")
