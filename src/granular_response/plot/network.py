"""Pictures of packings: disks, rotation marks, contacts and force chains, drawn from plain arrays.

Positions and radii are in mean radii, forces in mean disk weights. Everything takes the arrays of a
``State`` or of the dataset it was stored in: positions (n, 2), radii (n,), pairs of disk indices (m,), forces
(m, 2). All drawing is in data coordinates except line widths, which are in points.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.patches import FancyArrowPatch
from numpy.typing import ArrayLike

from ..observe.teardrop import connected
from ..state import FLOOR, OPEN, SLIDING, Box, FloatArray
from . import style

#: Points; a thinner line is lost in print.
THINNEST = 0.4


def draw_disks(
    axes: Axes,
    position: ArrayLike,
    radius: ArrayLike,
    *,
    values: FloatArray | None = None,
    facecolor: Any = "none",
    edgecolor: Any = style.FAINT,
    linewidth: float = 0.4,
    **collection: Any,
) -> EllipseCollection:
    """Draw n disks at ``position`` (n, 2) of ``radius`` (n,) or one radius for all.

    With ``values`` (n,) they are filled by value: pass ``cmap`` and ``norm`` or ``clim``, and hand the
    returned collection to ``colorbar``.
    """
    centre = np.asarray(position, float)
    diameter = 2.0 * np.broadcast_to(radius, len(centre))
    collection |= {"facecolor": facecolor} if values is None else {"array": values}
    disks = EllipseCollection(
        diameter,
        diameter,
        np.zeros(len(centre)),
        units="xy",
        offsets=centre,
        offset_transform=axes.transData,
        edgecolor=edgecolor,
        linewidth=linewidth,
        **collection,
    )
    axes.add_collection(disks, autolim=False)
    include(axes, np.concatenate([centre - 0.5 * diameter[:, None], centre + 0.5 * diameter[:, None]]))
    return disks


def draw_rotations(
    axes: Axes, position: FloatArray, radius: ArrayLike, angle: ArrayLike, **lines: Any
) -> LineCollection:
    """Mark the rotation of each disk by a diameter that was vertical at ``angle`` (n,) zero (Fig. 2)."""
    arm = np.stack([-np.sin(angle), np.cos(angle)], axis=1) * 0.8 * np.reshape(radius, (-1, 1))
    return _segments(axes, position - arm, position + arm, {"color": style.MUTED, "linewidth": 0.4, **lines})


def draw_contacts(
    axes: Axes, position: FloatArray, first: np.ndarray, second: np.ndarray, *, box: Box | None = None, **lines: Any
) -> LineCollection:
    """Connect the centres of the pairs ``first``, ``second`` (m,): thin black lines unless said otherwise.

    With a periodic ``box``, a pair across its sides is half a line at each.
    """
    start, end = position[first], position[second]
    if box is not None and box.periodic:
        half = 0.5 * box.separation(end, start)
        start, end = np.concatenate([start, end]), np.concatenate([start + half, end - half])
    return _segments(axes, start, end, {"color": style.BLACK, "linewidth": 0.35, **lines})


#: How each kind of contact of :func:`draw_contact_changes` is drawn, and its name in a legend.
CONTACT_LINES: dict[str, dict[str, Any]] = {
    # a thinner line falls between two rows of pixels of a PNG file and is grey there
    "unchanged": {"color": style.BLACK, "linewidth": 0.9, "zorder": 2},
    "sliding": {"color": style.SLIDING, "linewidth": 2.0, "zorder": 3},
    "closed": {"color": style.CLOSED, "linewidth": 2.4, "zorder": 4},
    "opened": {"color": style.OPENED, "linewidth": 3.8, "zorder": 5},
    "opened elsewhere": {"color": style.OPENED_ELSEWHERE, "linewidth": 3.8, "zorder": 4.5},
}


#: Those of contacts that are told apart by their status alone.
KINDS = ("unchanged", "sliding", "closed", "opened")


def draw_contact_changes(
    axes: Axes,
    position: FloatArray,
    first: np.ndarray,
    second: np.ndarray,
    *,
    touching_before: np.ndarray,
    touching: np.ndarray,
    sliding: np.ndarray,
    region: np.ndarray | bool = True,
    box: Box | None = None,
    **lines: Any,
) -> dict[str, LineCollection]:
    """What a load changes in the contact network (Figs. 4, 8, 9); the masks are over candidate pairs, (m,).

    ``opened`` touched before and does not now (thick; pale outside of a ``region``), ``closed`` the reverse,
    ``sliding`` touches and slides now, ``unchanged`` touches before and after without sliding (thin black). Kinds that
    do not occur are left out of the returned collections, which are labelled for a legend.
    """
    drawn = {}
    for name, mask in _changes(touching_before, touching, sliding, region).items():
        if mask.any():
            look = {**CONTACT_LINES[name], "label": name, **lines}
            drawn[name] = draw_contacts(axes, position, first[mask], second[mask], box=box, **look)
    return drawn


def _changes(
    touched: np.ndarray, touches: np.ndarray, slides: np.ndarray | bool = False, inside: np.ndarray | bool = True
) -> dict[str, np.ndarray]:
    """(m,) masks of what became of contacts."""
    return {
        "unchanged": touched & touches & np.logical_not(slides),
        "sliding": touched & touches & slides,
        "closed": ~touched & touches,
        "opened": touched & ~touches & inside,
        "opened elsewhere": touched & ~touches & np.logical_not(inside),
    }


def draw_state_changes(
    axes: Axes, rest: xr.Dataset, loaded: xr.Dataset, sliding: np.ndarray | None = None
) -> dict[str, LineCollection]:
    """Figs. 4, 8, 9 and 16: the central third of a slab, what a load changes in its contacts, the load and the floor.

    ``rest`` and ``loaded`` are states of a study's dataset, ``sliding`` (m,) marks contacts, by default by their
    status. Opened contacts that are not connected with those below the load are pale. Contacts with the floor are lines
    down to it. Returns what :func:`draw_contact_changes` does.
    """
    sliding = loaded["contact_status"].values == SLIDING if sliding is None else sliding
    position, disk = loaded["position"].values, int(rest["loaded_disk"])
    radius, width = float(rest["radius"].values[disk]), float(rest["width"])
    first, second = rest["contact_disk"].values, rest["contact_partner"].values
    x, z = position[disk]
    left, right = x - width / 6.0, x + width / 6.0
    # lines that cross the edges of the picture are cut there
    inside = np.abs(position[:, 0] - x) <= width / 6.0 + 2.0
    before, now = rest["contact_status"].values != OPEN, loaded["contact_status"].values != OPEN
    start = rest["position"].values
    region = connected(0.5 * (start[first] + start[second]), before & ~now, start[disk], Box(width))
    shown = inside[first] & inside[second]
    drawn = draw_contact_changes(
        axes,
        position,
        first[shown],
        second[shown],
        touching_before=before[shown],
        touching=now[shown],
        sliding=sliding[shown],
        region=region[shown],
    )
    on_floor = rest["wall_index"].values == FLOOR
    centre = position[rest["wall_disk"].values[on_floor]]
    before, now = (state["wall_status"].values[on_floor] != OPEN for state in (rest, loaded))
    for name, mask in _changes(before, now).items():
        _segments(axes, centre[mask], centre[mask] * (1.0, 0.0), CONTACT_LINES[name])
    draw_loaded_disk(axes, (x, z), radius)
    draw_load(axes, (x, z + radius), length=3.5)
    draw_box(axes, Box(width), float(position[:, 1].max()), between=(left, right))
    axes.set(xlim=(left, right), ylim=(-0.6, float(z) + radius + 4.0))
    style.no_axes(axes)
    return drawn


def pair_points(
    position: FloatArray, radius: ArrayLike, first: np.ndarray, second: np.ndarray, *, box: Box | None = None
) -> FloatArray:
    """(m, 2) contact points: on the line of centres, dividing the overlap (or gap) evenly.

    With a periodic ``box``, that of a pair across its sides lies beside the first disk.
    """
    start, end, size = position[first], position[second], np.broadcast_to(radius, len(position))
    between = end - start if box is None else box.separation(end, start)
    distance = np.linalg.norm(between, axis=1)
    from_first = 0.5 * (distance + size[first] - size[second])
    return start + between * (from_first / distance)[:, None]


#: How forces are drawn that press what touches together more (or at all), and less: colour and order.
FORCE_LINES: dict[str, dict[str, Any]] = {
    "force increased": {"color": style.INCREASED, "zorder": 4},
    "force decreased": {"color": style.DECREASED, "zorder": 3},
}


def draw_forces(
    axes: Axes,
    point: FloatArray,
    force: FloatArray,
    normal: FloatArray,
    *,
    length_per_force: float,
    width_per_force: float,
    smallest: float = 0.0,
    **lines: Any,
) -> dict[str, LineCollection]:
    """Draw each force (m, 2) as a line along it, centred at its contact ``point`` (m, 2) (Figs. 2, 13, 17, 18).

    Colours are those of :data:`FORCE_LINES`; a force along its ``normal`` (m, 2), that of the contact, presses
    together. Length (radii) and width (points) are both proportional to the magnitude, the width down to
    :data:`THINNEST`. Forces below ``smallest`` are left out, which keeps the files of large packings small. Kinds
    without a line are left out of the returned collections.
    """
    magnitude = np.linalg.norm(force, axis=1)
    pushes = np.sum(force * normal, axis=1) >= 0.0
    drawn = {}
    for (name, look), kind in zip(FORCE_LINES.items(), (pushes, ~pushes), strict=True):
        shown = kind & (magnitude > smallest)
        if shown.any():
            half = 0.5 * length_per_force * force[shown]
            widths = np.maximum(width_per_force * magnitude[shown], THINNEST)
            keywords = {"capstyle": "butt", **look, **lines, "linewidths": widths}
            drawn[name] = _segments(axes, point[shown] - half, point[shown] + half, keywords)
    return drawn


#: How a magnitude, per largest one, becomes a length and a width.
SCALES: dict[str, Callable[[FloatArray], FloatArray]] = {
    "linear": lambda part: part,
    "sqrt": np.sqrt,
    # the part of all forces that are not larger; where the load acts, a few forces are larger than all others together
    "percentile": lambda part: np.searchsorted(np.sort(part), part, side="right") / max(len(part), 1),
}


def rescaled(force: FloatArray, scale: Literal["linear", "sqrt", "percentile"], *, largest: float) -> FloatArray:
    """Forces (m, 2) in their directions with magnitudes in place of which stands 1 for ``largest``, 0 for none.

    ``sqrt`` and ``percentile`` let small forces be seen beside large ones: of a point load, the chains beyond its
    first rows.
    """
    magnitude = np.linalg.norm(force, axis=1)
    # forces that are rounding only stay without length on every scale
    seen = magnitude > 1e-9 * largest
    size = np.zeros(len(force))
    size[seen] = SCALES[scale](magnitude[seen] / largest)
    return force * (size / np.where(seen, magnitude, 1.0))[:, None]


def draw_load(axes: Axes, at: ArrayLike, direction: ArrayLike = (0.0, -1.0), *, length: float = 4.0) -> None:
    """An arrow of ``length`` radii that ends at ``at`` and shows where, and which way, a force is applied."""
    tip, along = np.asarray(at, dtype=float), np.asarray(direction, dtype=float)
    tail = tip - length * (along / np.linalg.norm(along))
    axes.annotate(
        "",
        xy=tuple(tip.tolist()),
        xytext=tuple(tail.tolist()),
        arrowprops={"arrowstyle": "-|>", "color": style.LOAD, "linewidth": 1.2, "shrinkA": 0.0, "shrinkB": 0.0},
        annotation_clip=False,
        zorder=10,
    )
    include(axes, np.stack([tail, tip]))


def draw_loaded_disk(axes: Axes, at: ArrayLike, radius: ArrayLike) -> None:
    """Outline the disk that carries a load, or several."""
    draw_disks(axes, np.reshape(at, (-1, 2)), radius, edgecolor=style.LOAD, linewidth=0.9, zorder=6)


def draw_torque(axes: Axes, at: ArrayLike, torque: float, *, radius: float = 1.7) -> None:
    """An arc with an arrow over a disk at ``at``, the way that ``torque`` turns it; nothing for zero."""
    if not torque:
        return
    start, end = np.radians(20.0), np.radians(150.0)
    if torque < 0.0:
        start, end = end, start
    x, z = np.asarray(at, dtype=float)
    ends = [(x + radius * np.cos(a), z + radius * np.sin(a)) for a in (start, end)]
    axes.add_patch(
        FancyArrowPatch(
            *ends,
            # a circle through both ends: the bulge over half the chord is tan(angle / 4)
            connectionstyle=f"arc3,rad={-2.0 * np.tan((start - end) / 4.0) * 0.5:.4f}",
            arrowstyle="-|>",
            mutation_scale=8.0,
            color=style.LOAD,
            linewidth=1.2,
            shrinkA=0.0,
            shrinkB=0.0,
            zorder=11,
        )
    )


def draw_box(
    axes: Axes, box: Box, height: float, *, between: tuple[float, float] | None = None, shift: float = 0.0, **lines: Any
) -> LineCollection:
    """The floor and the sides up to ``height``, dashed where they are periodic; only what lies ``between`` two x.

    ``shift`` is added to x where the picture counts it from another place.
    """
    left, right = between or (0.0, box.width)
    start, end, dashes = [(max(left, 0.0), 0.0)], [(min(right, box.width), 0.0)], ["-"]
    for x in (0.0, box.width):
        if left <= x <= right:
            start.append((x, 0.0))
            end.append((x, height))
            dashes.append("--" if box.periodic else "-")
    look = {"color": style.MUTED, "linewidth": 0.8, "linestyles": dashes, "capstyle": "butt", **lines}
    offset = np.array([shift, 0.0])
    return _segments(axes, np.array(start) + offset, np.array(end) + offset, look)


def _segments(axes: Axes, start: FloatArray, end: FloatArray, keywords: dict[str, Any]) -> LineCollection:
    drawn = LineCollection(list(np.stack([start, end], axis=1)), **keywords)
    axes.add_collection(drawn, autolim=False)
    include(axes, np.concatenate([start, end]))
    return drawn


def include(axes: Axes, points: FloatArray) -> None:
    """Make room for points (n, 2), as far as limits are not set.

    Limits are found when they are asked for, not here: that looks through all that is drawn each time.
    """
    if len(points):
        axes.update_datalim(points)
        axes.autoscale(enable=None)  # type: ignore[arg-type]  # its type leaves out what its text allows
