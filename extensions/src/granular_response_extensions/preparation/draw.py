"""When a growing force does what, for each way to prepare the slab: by friction, and by the contacts at the limit."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import outer, titles

from .parameters import Parameters

#: Events in the order of the panels, with what they are called there.
PANELS = {
    "first_opening": "first opening",
    "linear_range": "1 % departure from linearity",
    "reaches_floor": "open region at the floor",
    "crossover": "onset of two peaks",
    "loss_of_symmetry_path": "loss of symmetry",
}
#: How each way to prepare is named and marked, by how gravity comes; ramps of several times share a colour.
WAYS = {
    "at-once": ("gravity switched on", style.BLUE, "o"),
    "slow": ("gravity ramped over", style.VERMILION, "sDsDs"),
    "frictionless": ("prepared frictionless", style.GREEN, "^"),
}
#: Of those whose dashpots are weaker or stronger than those of the first way.
WEAKER, STRONGER = "P", "X"


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"preparation": _onsets(datasets["events"])}


def _onsets(events: xr.Dataset) -> Figure:
    """A panel for each event, a row for each slab."""
    slabs = sorted(set(zip(events["wall_friction"].values.tolist(), events["friction"].values.tolist(), strict=True)))
    figure, panels = style.figure(2, 3, height=4.8, sharex=True, sharey=True)
    panels.flat[-1].set_axis_off()
    titles(panels.flat, PANELS.values())
    for axes, name in zip(panels.flat, PANELS, strict=False):
        _event(axes, events.isel(event=np.flatnonzero(events["name"].values == name)), slabs)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("")
        axes.set_ylim(len(slabs) - 0.5, -0.5)
    names = [f"${style.FRICTION} = {mu:g}$" + (", rough walls" if wall else "") for wall, mu in slabs]
    panels[0, 0].set_yticks(range(len(slabs)), names)
    outer(panels, style.FORCE, "")
    panels[0, -1].set_xlabel(style.FORCE)
    panels[0, -1].tick_params(labelbottom=True)
    handles = {
        text: handle for axes in panels.flat for handle, text in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    order = sorted(handles, key=_order)
    panels.flat[-1].legend([handles[text] for text in order], order, loc="center", fontsize=7.5)
    return figure


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    frictions = sorted({part.friction for part in parameters.parts})
    said = of_scene(parameters.scene, force=parameters.forces, friction=frictions, wall_friction=None)
    return of_group("preparation", {"preparation": said}, {"preparation": _finding(datasets["events"])})


def _finding(events: xr.Dataset) -> str:
    """By which factor the preparation shifts each event at most, in one slab."""
    said = []
    for name, text in PANELS.items():
        one = events.isel(event=(events["name"].values == name) & np.isfinite(events["high"].values))
        table = one[["wall_friction", "friction", "high"]].to_dataframe().groupby(["wall_friction", "friction"])["high"]
        if len(table):
            said.append(f"{text} {float(f'{(table.max() / table.min()).max():.2g}'):g}")
    return f"The preparation of a slab shifts onset forces by factors of up to: {', '.join(said)}."


def _event(axes: Axes, events: xr.Dataset, slabs: list[tuple[float, float]]) -> None:
    """A row for each slab: the onset force by every way to prepare it, and how far they lie apart."""
    usual = float(events["damping_ratio"][0])
    ramps = sorted(set(events["ramp_time"].values[events["gravity"].values == "slow"].tolist()))
    shades = style.ordered_colours(len(ramps) + 1, of="polydispersity")[1:]  # of one hue, dark: fast
    for row, (wall, friction) in enumerate(slabs):
        mine = events.isel(event=(events["wall_friction"].values == wall) & (events["friction"].values == friction))
        low, high = mine["low"].values, mine["high"].values
        come = np.isfinite(high)
        # an event at the first force of all has no lower end
        middle = np.where(come, np.sqrt(np.where(low > 0.0, low, high) * np.where(come, high, 1.0)), low)
        axes.plot([middle.min(), middle.max()], [row, row], color=style.FAINT, linewidth=2.0, linestyle="-", zorder=1)
        columns = (mine[name].values.tolist() for name in ("way", "gravity", "ramp_time", "damping_ratio"))
        for force, there, way, gravity, ramp, damping in zip(middle, come, *columns, strict=True):
            name, colour, markers = WAYS[gravity]
            marker = markers[0]
            if gravity == "slow":
                marker, name = markers[ramps.index(ramp) % len(markers)], rf"{name} ${ramp:g}\,{style.TIME_UNIT}$"
                colour = shades[ramps.index(ramp)]
            if damping != usual:
                marker, name, colour = STRONGER if damping > usual else WEAKER, way, style.BLACK
            look: dict[str, Any] = {"color": colour, "markersize": 4.0, "linestyle": "none"}
            if there:
                axes.plot(force, row, marker=marker, label=name, **look)
            else:
                axes.plot(force, row, marker=">", markerfacecolor="none", **look)


def _order(text: str) -> tuple[bool, float]:
    """Ramps of gravity by their time, before them the other ways."""
    found = re.search(r"over \$([\d.]+)", text)
    return (True, float(found[1])) if found else (False, 0.0)
