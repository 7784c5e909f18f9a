"""Floor response: the excess force on the floor per applied force (Secs. II.A, III.C and VI).

Forces are in mean disk weights, lengths in mean radii.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import check_positive, require
from ..state import FLOOR, Box, FloatArray, State

#: Widths of the Gaussian beyond which images across periodic sides are left out.
CUTOFF = 7.0


def floor_disks(states: Sequence[State], bottom_row: ArrayLike = ()) -> NDArray[np.intp]:
    """(k,) indices of the floor disks, ordered by their ``x`` in the first state.

    A floor disk belongs to ``bottom_row`` (disk indices, from the packing) or touches the floor in any of ``states``;
    give every state that is to be compared, so that no floor force is left out. Raises ``ValueError`` without a state.
    """
    require(states, "states: none given; at least one state is needed to find the floor disks")
    touching = [s.walls.first[(s.walls.second == FLOOR) & s.walls.touching] for s in states]
    disks = np.unique(np.concatenate([np.asarray(bottom_row, dtype=np.intp), *touching])).astype(np.intp)
    return disks[np.argsort(states[0].position[disks, 0], kind="stable")]


def floor_force(state: State, disks: NDArray[np.intp]) -> FloatArray:
    """(k,) vertical force of the floor on each of ``disks``, positive upwards.

    Vertical (friction) forces of the side walls do not count, nor do floor contacts of disks not in
    ``disks``. A disk that does not reach the floor has zero.
    """
    on_floor = state.walls.second == FLOOR
    vertical = np.zeros(state.position.shape[0])
    np.add.at(vertical, state.walls.first[on_floor], state.wall_force()[on_floor, 1])
    return vertical[disks]


def floor_response(rest: State, loaded: State, disks: NDArray[np.intp], total_force: float) -> FloatArray:
    """(k,) vertical floor force that the load adds on each disk, per ``total_force``.

    ``total_force`` is the sum of the magnitudes of the applied forces. Over all floor disks the response to
    vertical loads sums to 1 when the side walls carry no weight. Raises ``ValueError`` unless
    ``total_force`` is positive and finite.
    """
    check_positive(total_force=total_force)
    return (floor_force(loaded, disks) - floor_force(rest, disks)) / total_force


def sensor_forces(state: State, edges: ArrayLike) -> FloatArray:
    """(k,) vertical force of the floor between successive ``edges`` (k + 1,), distances from the left end of the box.

    Positive upwards; each disk presses at the place of its centre. What lies outside the edges does not count.
    """
    on_floor = state.walls.second == FLOOR
    x = state.position[state.walls.first[on_floor], 0]
    x = np.mod(x, state.box.width) if state.box.periodic else x
    return np.histogram(x, np.asarray(edges, dtype=float), weights=state.wall_force()[on_floor, 1])[0]


def smoothed_response(
    x_eval: ArrayLike, x_disk: ArrayLike, response: ArrayLike, width: float, period: float | None = None
) -> FloatArray:
    """Gaussian coarse graining of a floor response along x (Sec. VI).

    The kernel is ``exp(-(x/width)^2) / (width sqrt(pi))``, so the result is the vertical stress on the
    floor per applied force, in 1/mean radius; its integral over x is the sum of the response. ``x_disk`` is
    (k,), ``response`` (..., k), ``x_eval`` (e,); returns (..., e). Within about ``width`` of a side wall part
    of the kernel lies outside the box. With a ``period`` of x all images of the disks count. Raises ``ValueError``
    unless ``width`` is positive.
    """
    check_positive(width=width)
    x, at, given = (np.asarray(values, dtype=float) for values in (x_eval, x_disk, response))
    if period is not None:
        x, at = np.mod(x, period), np.mod(at, period)
        copies = np.arange(-(reach := math.ceil(CUTOFF * width / period)), reach + 1)
        at, given = np.add.outer(copies * period, at).ravel(), np.tile(given, len(copies))
    distance = (x[:, None] - at) / width
    kernel = np.exp(-(distance**2)) / (width * np.sqrt(np.pi))
    return given @ kernel.T


def wall_margin(width: float) -> float:
    """Distance from the side walls within which no peak is looked for: ten radii, less in a narrow slab."""
    return min(10.0, 0.2 * width)


def interior_mask(x: ArrayLike, width: float, margin: float = 10.0, *, left_wall: float = 0.0) -> NDArray[np.bool_]:
    """Whether each ``x`` is at least ``margin`` away from both side walls; same shape as ``x``.

    ``left_wall`` is the position of the left wall in the coordinate of ``x`` (for x measured from the loaded
    disk: minus the distance of that disk from the wall); the right wall is ``width`` further on.
    Raises ``ValueError`` if nothing can be in the interior.
    """
    rule = f"margin: {margin} given; it must be at least 0 and less than half the width {width}"
    require(0.0 <= margin < width / 2.0, rule)
    distance = np.asarray(x, dtype=float) - left_wall
    return (distance >= margin) & (distance <= width - margin)


def origin_of(position: FloatArray, disks: NDArray[np.intp], x: FloatArray, box: Box) -> float:
    """Where the places ``x`` (k,) of floor ``disks`` are counted from, from the left end of the box (mean radii).

    That is the loaded disk, or the middle of the box. ``position`` (n, 2) of all disks at rest.
    """
    origin = float(position[disks[0], 0] - x[0])
    return origin % box.width if box.periodic else origin
