"""What figures of several groups repeat: which values are drawn, and how; titles of panels; names of packings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike

from granular_response.plot import network, style
from granular_response.state import WALL_NORMAL, FloatArray, foot_points

from .captions import letters


def among(stored: ArrayLike, wanted: Iterable[float]) -> list[float]:
    """The wanted values as far as they are stored; all that are stored if none is."""
    there = np.asarray(stored, dtype=float).tolist()
    return [value for value in wanted if value in there] or there


def family(
    values: Sequence[Any] | np.ndarray, *, of: str, marked: bool = True, dashed: bool = False
) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Each of some ordered values with the look of its curve: dark to light, with markers, dashes, or both.

    ``of`` is the quantity of ``style.RAMPS``: it has one ramp of colours in all figures.
    """
    for k, (value, colour) in enumerate(zip(values, style.ordered_colours(max(1, len(values)), of=of), strict=False)):
        look = style.marked_line(k) if marked else {}
        yield value, look | (style.line(k) if dashed else {}) | {"color": colour}


def titles(
    axes: Iterable[Axes], texts: Iterable[str] = repeat(""), *, stem: str = "",
    place: Literal["inside", "above"] = "above",
) -> None:  # fmt: skip
    """A letter and a text for each of ``axes``; letters are those of the picture ``stem``, by default from (a) on."""
    for panel, name, text in zip(axes, letters(stem), texts, strict=False):
        style.letter(panel, name, place=place, text=text)


def outer(grid: np.ndarray, x: str, y: str) -> None:
    """Labels below and to the left of a (rows, columns) grid of axes."""
    for axes in grid[-1]:
        axes.set_xlabel(x)
    for axes in grid[:, 0]:
        axes.set_ylabel(y)


def packing(polydispersity: float) -> str:
    """A name for titles and legends."""
    return style.equals(style.POLYDISPERSITY, polydispersity) if polydispersity else "lattice"


def material(polydispersity: float, friction: float) -> str:
    """A name for titles and legends."""
    return f"{packing(polydispersity)}, {style.equals(style.FRICTION, friction)}"


def contact_networks(
    rest: xr.Dataset, states: Sequence[xr.Dataset], names: Sequence[str], *, height: float, **key: Any
) -> Figure:
    """A panel for each state, in which the contacts differ from those at ``rest``, and one key below them."""
    figure, (panels,) = style.figure(1, len(states), height=height)
    handles: dict[str, LineCollection] = {}
    for axes, loaded in zip(panels, states, strict=True):
        handles |= network.draw_state_changes(axes, rest, loaded)
    titles(panels, names)
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles), **key)
    return figure


def added_forces(data: xr.Dataset) -> tuple[FloatArray, float]:
    """(state, m, 2) what a load adds at the contacts of pairs and walls, and the largest of these forces."""
    added = np.concatenate([data["contact_added_force"].values, data["wall_added_force"].values], axis=1)
    return added, float(np.linalg.norm(added, axis=-1).max())


def zero(*panels: Axes) -> None:
    """A faint line where there is no response, below everything."""
    for axes in panels:
        axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)


#: Width of the largest force of :func:`forces` in points, its length in mean radii, and the part of it below which
#: nothing is drawn.
WIDEST, LONGEST, LEAST = 4.5, 4.0, 0.01


@dataclass(frozen=True)
class ContactLines:
    """Contacts of a state as :func:`forces` draws them: those of pairs of disks, then those with walls."""

    point: FloatArray  #: (m, 2)
    normal: FloatArray  #: (m, 2), towards the first disk

    @classmethod
    def of(cls, data: xr.Dataset, position: FloatArray) -> ContactLines:
        """From the contacts and walls of a state's dataset."""
        radius, disk, wall = (data[name].values for name in ("radius", "wall_disk", "wall_index"))
        first, second = data["contact_disk"].values, data["contact_partner"].values
        pairs = network.pair_points(position, radius, first, second)
        return cls(
            np.concatenate([pairs, foot_points(position[disk], radius[disk], wall)]),
            np.concatenate([position[first] - position[second], WALL_NORMAL[wall.astype(int)]]),
        )


def forces(
    axes: Axes, contacts: ContactLines, vector: FloatArray, largest: float, *, shown: np.ndarray | None = None,
    longest: float = LONGEST,
) -> None:  # fmt: skip
    """Forces as lines along them, as long and as wide as they are large, as in Figs. 2, 13 and 17 of the paper.

    ``vector`` (m, 2) is in units of choice; ``largest`` has the full width, and the length ``longest`` in mean radii.
    Of the contacts those ``shown`` (m,) are drawn, none where ``largest`` is 0. Lines are dark where the force presses
    together, pale where it takes compression away.
    """
    if not largest > 0.0:
        return
    here = slice(None) if shown is None else shown
    scale = {"length_per_force": longest / largest, "width_per_force": WIDEST / largest, "smallest": LEAST * largest}
    network.draw_forces(axes, contacts.point[here], vector[here], contacts.normal[here], **scale)


def force_key(
    axes: Axes, at: tuple[float, float], size: float, largest: float, unit: str, *, longest: float = LONGEST
) -> None:
    """A line that stands for a force of ``size`` in :func:`forces`, its middle at ``at`` (data), and its value."""
    if not largest > 0.0:
        return
    along = np.array([[1.0, 0.0]])
    forces(axes, ContactLines(np.array([at]), along), size * along, largest, longest=longest)
    end = at[0] + 0.5 * longest * size / largest, at[1]
    note(axes, f"${size:g}\\,{unit}$" if unit else f"${size:g}$", end, (5.0, 0.0), va="center", fontsize=8)


def note(axes: Axes, text: str, at: tuple[float, float], shift: tuple[float, float], **look: Any) -> None:
    """Write a text ``shift`` points from a place."""
    axes.annotate(text, at, shift, textcoords="offset points", **look)


def label_ends(axes: Axes, ends: Iterable[tuple[str, float, float, str]], *, gap: float = 9.0, **text: Any) -> None:
    """Write names beside the ends of curves, so far apart that all can be read; call it when the limits are set.

    ``ends`` are pairs of a name, the end of its curve (data), and its colour; ``gap`` is in points.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()
    at = sorted((axes.transData.transform((x, y))[1] * 72.0 / figure.dpi, *end) for end in ends for _, x, y, _ in [end])
    places: list[float] = []
    for height, *_ in at:
        places.append(max(height, places[-1] + gap) if places else height)
    shift = float(np.mean([place - height for place, (height, *_) in zip(places, at, strict=True)])) if at else 0.0
    look: dict[str, Any] = {"ha": "left", "va": "center", "fontsize": 8, "annotation_clip": False, "linespacing": 1.0}
    look |= {"path_effects": [withStroke(linewidth=1.5, foreground="white")], **text}
    beside, over = 6.0 if look["ha"] == "left" else 0.0, {"bottom": 3.0, "top": -3.0}.get(look["va"], 0.0)
    for place, (height, name, x, y, colour) in zip(places, at, strict=True):
        note(axes, name, (x, y), (beside, place - shift - height + over), color=colour, **look)


def grey_limit(axes: Axes, x: FloatArray, response: FloatArray) -> None:
    """The elastic response, or that to the smallest force, as a broad grey line behind all others."""
    axes.plot(x, response, color=style.FAINT, linestyle="-", linewidth=3.5, zorder=1, label="elastic")


def different(values: ArrayLike) -> list[Any]:
    """Each of some values once, in their order."""
    return np.unique(np.asarray(values)).tolist()


#: Dashes of lines to compare curves with.
DASHED, DOTTED = (0, (4, 2)), (0, (1, 1.5))


def banded(
    axes: Axes, x: ArrayLike, middle: ArrayLike, ends: tuple[ArrayLike, ArrayLike], look: dict[str, Any], *,
    alpha: float = 0.2, label: str = "",
) -> None:  # fmt: skip
    """A curve with a pale band of its colour between the two ``ends``."""
    axes.fill_between(x, *ends, color=look["color"], alpha=alpha, linewidth=0.0)
    axes.plot(x, middle, label=label, **look)
