"""GSD files: the last frame. A missing chunk has the value that the format gives it: masses and diameters of 1.

The box of the format is periodic along every axis, and says nothing of walls. Our own files say theirs in the log
entries ``origin``, ``box_width`` and ``periodic``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...inputs import check_regular
from .table import FileBox, FormatError, Table, upward

_REASON = "a GSD file does not say what bounds its particles"


def read(path: Path) -> Table:
    """The particles as disks."""
    try:
        import gsd.hoomd
    except ModuleNotFoundError as error:
        raise FormatError(f"needs the package {error.name}, install granular-response[export]") from None
    check_regular(path)
    with path.open("rb"):  # a file that may not be read is the same error as of other formats
        pass
    try:
        with gsd.hoomd.open(str(path), "r") as file:
            frame = file[len(file) - 1]
        x, y, z = np.array(frame.particles.position, float).reshape(-1, 3).T
        diameter = np.array(frame.particles.diameter, float).ravel()
        mass = np.array(frame.particles.mass, float).ravel()
        box = np.array(frame.configuration.box, float).reshape(6)
    except Exception as error:  # the library raises nearly anything on a damaged file
        raise FormatError(f"is not a GSD file with particles: {' '.join(str(error).split())}") from None
    if not len(x) == len(diameter) == len(mass) > 0:
        raise FormatError("has no particles")
    if not np.isfinite(box).all() or box[0] <= 0.0:
        raise FormatError("the box must be of some size")
    if box[3:].any():
        raise FormatError("the box must not be tilted")
    places = [f"particle {k}" for k in range(len(x))]
    up = y if upward(y, z) == "y" else z
    return Table(x, up, 0.5 * diameter, places, mass, _file_box(frame.log, float(box[0])))


def _file_box(log: dict[str, Any], width: float) -> FileBox:
    if not {"origin", "box_width", "periodic"} <= set(log):
        return FileBox(-0.5 * width, width, reason=_REASON)
    try:
        (left, floor, _), (own,), (periodic,) = (
            np.array(log[name], float).ravel() for name in ("origin", "box_width", "periodic")
        )
    except (TypeError, ValueError):
        raise FormatError("log entries origin, box_width, periodic: must be 3, 1 and 1 numbers") from None
    if not np.isfinite([left, floor, own]).all() or own <= 0.0 or periodic not in (0.0, 1.0):
        raise FormatError("log entries origin, box_width, periodic: must be places, a width and 0 or 1")
    return FileBox(float(left), float(own), float(floor), bool(periodic))
