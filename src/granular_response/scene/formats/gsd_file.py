"""GSD files: the last frame, positions from the lower corner of the box.

The format has the origin in the middle of the box. Our own files have it in the lower left corner, as their log entry
``origin`` says, and their bonds are contacts.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .table import FormatError, Table, heights


def read(path: Path) -> Table:
    """The particles as disks."""
    try:
        import gsd.hoomd
    except ModuleNotFoundError as error:
        raise FormatError(f"needs the package {error.name}, install granular-response[export]") from None
    with path.open("rb"):  # a missing file is the same error as of other formats
        pass
    try:
        with gsd.hoomd.open(str(path), "r") as file:
            last = len(file) - 1
            frame = file[last]
            named = any(file.file.chunk_exists(frame=k, name="particles/mass") for k in (0, last))
            sized = any(file.file.chunk_exists(frame=k, name="particles/diameter") for k in (0, last))
    except Exception as error:  # the library raises nearly anything on a damaged file
        raise FormatError(f"is not a GSD file with particles: {error}") from None
    if not sized:
        raise FormatError("has no diameters")
    x, y, z = frame.particles.position.astype(float).T
    box = np.asarray(frame.configuration.box, float)
    if box[3:].any():
        raise FormatError("the box must not be tilted")
    radius = 0.5 * frame.particles.diameter.astype(float)
    mass = frame.particles.mass.astype(float) if named else None
    places = [f"particle {k}" for k in range(len(x))]
    up = heights(y, z)
    if "origin" in frame.log:
        one, two = frame.bonds.group.T
        apart = np.hypot(x[one] - x[two], up[one] - up[two])
        # Only across periodic sides do disks touch that are apart, here by more than the rounding of single precision.
        periodic = True if (apart > 1.1 * (radius[one] + radius[two])).any() else None
        return Table(x, up, radius, places, mass, width=float(frame.log["box_width"][0]), periodic=periodic)
    return Table(x + 0.5 * box[0], up + 0.5 * box[1 if up is y else 2], radius, places, mass, width=float(box[0]))
