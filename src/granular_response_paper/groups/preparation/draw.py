"""When a growing force does what, against friction, for each way to prepare the slab."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import outer, titles

from .parameters import Parameters

#: Events in the order of the panels, with what they are called there.
PANELS = {
    "first_opening": "first opening",
    "linear_range": "1 % departure from linearity",
    "reaches_floor": "open region at the floor",
    "crossover": "onset of two peaks",
    "third_peak": "third peak",
    "loss_of_symmetry_path": "loss of symmetry",
}
#: Part of the distance between two frictions that the preparations of one take.
SPREAD = 0.72


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """One figure, ``preparation``, from the brackets of the events."""
    events = datasets["events"]
    slabs = sorted(set(zip(events["wall_friction"].values.tolist(), events["friction"].values.tolist(), strict=True)))
    ways = list(dict.fromkeys(events["way"].values.tolist()))
    figure, axes = style.figure(2, 3, width="double", height=4.6, sharex=True, sharey=True)
    titles(axes.flat, PANELS.values())
    for panel, name in zip(axes.flat, PANELS, strict=True):
        _event(panel, events.isel(event=np.flatnonzero(events["name"].values == name)), slabs, ways)
        panel.set_yscale("log")
        panel.yaxis.set_major_formatter("{x:g}")
        panel.set_xlim(-0.6, len(slabs) - 0.4)
    for panel in axes[-1]:
        panel.set_xticks(range(len(slabs)), [f"{mu:g}\nrough" if wall else f"{mu:g}" for wall, mu in slabs])
        panel.tick_params(axis="x", which="both", length=0)
    outer(axes, f"${style.FRICTION}$", style.FORCE)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=min(4, len(ways)))
    return {"preparation": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    frictions = sorted({part.friction for part in parameters.parts})
    said = of_scene(parameters.scene, force=parameters.forces, friction=frictions, wall_friction=None)
    return of_group("preparation", {"preparation": said})


def _event(panel: Axes, events: xr.Dataset, slabs: list[tuple[float, float]], ways: list[str]) -> None:
    """Brackets of one event: a bar from end to end, its mark in the middle; an arrow where it does not come."""
    for k in range(1, len(slabs)):
        panel.axvline(k - 0.5, color=style.FAINT, linewidth=0.4, zorder=0)
    offsets = (np.arange(len(ways)) - 0.5 * (len(ways) - 1)) * SPREAD / max(len(ways) - 1, 1)
    for index, (way, offset) in enumerate(zip(ways, offsets.tolist(), strict=True)):
        mine = events.isel(event=np.flatnonzero(events["way"].values == way))
        walls, friction = mine["wall_friction"].values.tolist(), mine["friction"].values.tolist()
        place = np.array([slabs.index(slab) + offset for slab in zip(walls, friction, strict=True)])
        low, high = mine["low"].values, mine["high"].values
        colour = style.COLOURS[index % len(style.COLOURS)]
        come = np.isfinite(high)
        # an event at the first force of all has no lower end: its bar ends there
        floor = np.where(low > 0.0, low, high)
        panel.vlines(place[come], floor[come], high[come], linewidth=1.0, color=colour)
        panel.plot(
            place[come],
            np.sqrt(floor * high)[come],
            linestyle="none",
            marker=style.MARKERS[index % len(style.MARKERS)],
            markersize=3.4,
            label=way,
            color=colour,
        )
        panel.plot(place[~come], low[~come], linestyle="none", marker=r"$\uparrow$", markersize=5.0, color=colour)
