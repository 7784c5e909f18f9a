"""Force chains from centre to centre and the floor response below them, for pictures in which they are small."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.ticker import MaxNLocator

from ..observe.peaks import find_peaks
from ..state import OPEN, FloatArray
from . import network, style
from .shown import Shown

#: Points: the widest line, and what a line is left out below.
WIDEST, THINNEST = 3.0, 0.3


def draw_chains(axes: Axes, shown: Shown, *, largest: float, half_width: float) -> None:
    """The incremental force of each contact as a line from centre to centre, the contacts that it opens, the load.

    Widths go as the square root of the force and reach :data:`WIDEST` points at ``largest`` (mean disk weights); larger
    forces have that width. Dark lines press disks together, pale ones take compression away. What is within
    ``half_width`` of the loaded disk is drawn, without axes.
    """
    left, right = shown.origin - half_width, shown.origin + half_width
    near = (shown.position[:, 0] > left - 2.0) & (shown.position[:, 0] < right + 2.0)
    first, second = shown.pairs
    kept = near[first] & near[second]
    at_wall, index = shown.values("wall_disk"), shown.values("wall_index")
    pair, wall = shown.forces(added=True)
    look: dict[str, Any] = {"facecolor": style.DISKS, "edgecolor": "none", "zorder": 0}
    network.draw_disks(axes, shown.position[near], shown.radius[near], **look)
    along = np.sum(pair * shown.box.separation(shown.position[first], shown.position[second]), axis=1)
    foot = shown.box.on_wall(shown.position[at_wall], index)
    inward = np.sum(wall * (shown.position[at_wall] - foot), axis=1)
    width, wall_width = (
        WIDEST * np.sqrt(np.minimum(np.linalg.norm(force, axis=1) / (largest if largest > 0.0 else np.inf), 1.0))
        for force in (pair, wall)
    )
    for sign, colour, order in ((-1.0, style.DECREASED, 2), (1.0, style.INCREASED, 3)):
        look = {"color": colour, "capstyle": "round", "zorder": order}
        drawn = kept & (sign * along > 0.0) & (width > THINNEST)
        lines = (first[drawn], second[drawn])
        network.draw_contacts(axes, shown.position, *lines, box=shown.box, linewidth=width[drawn], **look)
        drawn = near[at_wall] & (sign * inward > 0.0) & (wall_width > THINNEST)
        ends = np.stack([shown.position[at_wall][drawn], foot[drawn]], axis=1)
        axes.add_collection(LineCollection(list(ends), linewidths=wall_width[drawn], **look), autolim=False)
    opened = kept & (shown.values("contact_status", 0) != OPEN) & (shown.values("contact_status") == OPEN)
    look = {"color": style.OPENED, "linewidth": 0.5 * WIDEST, "capstyle": "butt", "zorder": 4}
    network.draw_contacts(axes, shown.position, first[opened], second[opened], box=shown.box, **look)
    axes.axhline(0.0, color=style.MUTED, linewidth=1.0, linestyle="-", zorder=5)
    for disk, force, _ in shown.loads:
        if size := float(np.hypot(*force)):
            tip = shown.position[disk] - shown.radius[disk] * force / size
            network.draw_load(axes, tip, force, length=0.15 * shown.top)
    style.no_axes(axes)
    axes.set(xlim=(left, right), ylim=(-0.5, height(shown)))


def height(shown: Shown) -> float:
    """Up to where chains are drawn, with room for the arrow of a load: the same in all states of a result."""
    return 1.2 * Shown(shown.data, 0).top + 0.5


def draw_response(
    axes: Axes,
    x: FloatArray,
    response: FloatArray,
    reference: FloatArray,
    *,
    half_width: float,
    limits: tuple[float, float],
) -> None:
    """The floor response at ``x`` over a grey ``reference``, below chains of this ``half_width``."""
    axes.fill_between(x, reference, color=style.FAINT, linewidth=0.0)
    axes.plot(x, response, color=style.INCREASED, linewidth=1.8, linestyle="-")
    axes.set(xlim=(-half_width, half_width), ylim=limits)
    axes.xaxis.set_major_locator(MaxNLocator(5, prune="both"))
    axes.tick_params(top=False, right=False)
    axes.spines[["top", "right"]].set_visible(False)


def draw_peaks(axes: Axes, shown: Shown, response: FloatArray) -> None:
    """How many peaks a response has in the interior (:mod:`granular_response.observe.peaks`), in its upper left corner.

    Nothing where the floor disks have no order along x, or are too few for a peak.
    """
    try:
        number = len(find_peaks(shown.values("x"), response, interior=shown.interior))
    except ValueError:
        return
    text = f"{number} peak{'s' if number != 1 else ''}"
    axes.text(0.03, 0.95, text, transform=axes.transAxes, va="top", weight="bold", color=style.INCREASED)


def draw_key(axes: Axes, reference: str) -> None:
    """In the upper right corner of a response: what is thick in the chains above it, and the name of what is grey."""
    for k, (text, colour) in enumerate((("opened contacts", style.OPENED), (reference, style.MUTED))):
        axes.annotate(text, (1.0, 1.0), (-1.0, -2.0 - 10.0 * k), xycoords="axes fraction", textcoords="offset points",
                      ha="right", va="top", fontsize=8, color=colour)  # fmt: skip
