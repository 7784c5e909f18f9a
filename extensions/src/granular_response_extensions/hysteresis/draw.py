"""Loops of load and displacement, what they leave on the floor, what they lose, and which range ends first."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import different, family, material, note, titles, zero

from .parameters import Parameters

#: How far from the load floor forces are shown (radii).
REACH = 30.0
#: Least part that is drawn on the logarithmic axes: what is below it is rounding, or none.
LEAST = 1e-4
#: How points of the second loading are drawn.
DOTS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 2.6}
#: What the events are called, their markers and their colours.
NAMES = {
    "first_opening": ("first contact opens", "v", style.VERMILION),
    "linear_range": ("end of the linear range", "o", style.BLACK),
    "reversible_range": ("end of the reversible range", "s", style.PURPLE),
}


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {
        "hysteresis_loops": _loops(datasets["curves"], datasets["floor"]),
        "hysteresis_ranges": _ranges(datasets["loops"], datasets["events"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    curves = datasets["curves"]
    cases, one = looped(curves["polydispersity"].values, curves["friction"].values)
    lattices = [parameters.cases[case] for case in cases]
    further = max(case.surveyed for case in parameters.cases)
    said = of_scene(parameters.base, friction=None, polydispersity=None)
    return of_group(
        "hysteresis",
        {
            "hysteresis_loops": said
            | {"friction": [case.friction for case in lattices], "force": lattices[0].forces[-1]},
            "hysteresis_ranges": said | {"friction": sorted({case.friction for case in parameters.cases})},
        },
        friction=parameters.cases[one].friction,
        part=f"{100.0 * parameters.left:g} %",
        most=max(case.realizations + case.surveyed for case in parameters.cases),
        survey=f", {further} of them of the survey" if further else "",
    )


def looped(polydispersity: np.ndarray, friction: np.ndarray) -> tuple[list[int], int]:
    """Cases whose loops are drawn, the lattices, and the one whose floor forces are: a lattice, least friction.

    Where there are no lattices, all cases count.
    """
    lattices = np.flatnonzero(polydispersity == polydispersity.min())
    rubbing = lattices[friction[lattices] > 0.0]
    return lattices.tolist(), int(rubbing[np.argmin(friction[rubbing])] if rubbing.size else lattices[0])


def _loops(curves: xr.Dataset, floor: xr.Dataset) -> Figure:
    """(a) loops of the lattices, (b) the floor under one of them."""
    figure, ((loops, below),) = style.figure(1, 2, height=2.9)
    friction = curves["friction"].values
    cases, one = looped(curves["polydispersity"].values, friction)
    colours = dict(family(different(friction[cases]), of="friction"))
    for k, case in enumerate(cases):
        look = {"color": colours[friction[case]]["color"], "linestyle": "-", "linewidth": 1.0}
        x, load = (curves[name].isel(case=case).values for name in ("displacement", "load"))
        for branch in range(len(x)):
            again = DOTS | {"marker": style.MARKERS[k]} if branch == 2 else {}
            loops.plot(1e3 * x[branch], load[branch], **look | again)
        end, text = (1e3 * np.nanmax(x[0]), np.nanmax(load[0])), style.equals(style.FRICTION, friction[case])
        note(loops, text, end, (3, 0), va="center")
    loops.set(xlabel=rf"displacement of the loaded disk$\,/\,10^{{-3}}{style.RADIUS}$", ylabel=style.FORCE)
    loops.set_xlim(0.0, 1.16e3 * float(np.nanmax(curves["displacement"].values[cases])))
    loops.set_ylim(bottom=0.0)
    handles = [Line2D([], [], color=style.MUTED, **look) for look in ({"linewidth": 1.0}, DOTS)]
    loops.legend(handles, ["loading, unloading", "loading again"], loc="lower right")
    x, added = floor["x"].isel(case=one).values, floor["added"].isel(case=one).values
    near = np.abs(x) <= REACH
    for branch, label in enumerate(("loaded", "unloaded", "loaded again")):
        below.plot(x[near], added[branch, near], label=label, **style.line(branch) | (DOTS if branch == 2 else {}))
    zero(below)
    below.set(xlabel=style.POSITION, ylabel=rf"incremental floor force$\,/\,{style.WEIGHT}$")
    below.legend(loc="upper right")
    under = style.equals(style.F_EXT, float(curves["load"].isel(case=one).max()), style.WEIGHT)
    titles((loops, below), ("lattices", f"the floor, {style.equals(style.FRICTION, friction[one])}, {under}"))
    return figure


def _ranges(loops: xr.Dataset, events: xr.Dataset) -> Figure:
    """(a) what is left, (b), (c) what the first and the second loop lose, by force; (d) where ranges end."""
    figure, panels = style.figure(2, 3, height=5.2, sharex="row", sharey="row")
    grid = panels[0, 0].get_gridspec()
    for axes in panels[1]:
        axes.remove()
    ends, drawn = figure.add_subplot(grid[1, :]), panels[0]
    delta, friction = loops["polydispersity"].values, loops["friction"].values
    lost = ((loops[f"slid{again}"] + loops[f"crossed{again}"]) / loops["work"] for again in ("", "_again"))
    parts = (loops["floor_left"], *lost)
    spreads, colours = different(delta), dict(family(different(friction), of="friction"))
    for case in np.flatnonzero(friction > 0.0):
        dash = style.LINE_STYLES[spreads.index(delta[case])]
        look = colours[friction[case]] | {"linestyle": dash, "label": material(delta[case], friction[case])}
        force = loops["force"].isel(case=case).values
        for axes, part in zip(drawn, parts, strict=True):
            value = part.isel(case=case).mean("realization").values
            axes.plot(force, np.where(value > LEAST, value, np.nan), **look)
            below = force[value <= LEAST]
            caret = DOTS | {"marker": "v", "markersize": 4.0, "color": look["color"]}
            axes.plot(below, np.full(below.shape, 1.2 * LEAST), **caret)
    drawn[0].axhline(events.attrs["left"], color=style.MUTED, linewidth=0.7, linestyle=(0, (4, 2)))
    for axes in drawn:
        axes.set(xscale="log", yscale="log", ylim=(LEAST, 1.0), xlabel=style.FORCE)
        axes.xaxis.set_minor_formatter("")
    drawn[0].set_ylabel("relative to the load")
    _ends(ends, events, delta, friction)
    figure.legend(*drawn[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, handlelength=3.0)
    names = ("residual floor forces", "dissipated, first loop", "dissipated, second loop", "ends of ranges")
    titles((*drawn, ends), names)
    return figure


def _ends(axes: Axes, events: xr.Dataset, delta: np.ndarray, friction: np.ndarray) -> None:
    """A row for each case: medians over the realizations, from the smallest to the largest of them."""
    last = float(events["low"].max())
    first = min(float(events["high"].fillna(np.inf).min()), 3.0 * last)
    for index, (name, (text, marker, colour)) in enumerate(NAMES.items()):
        symbol = DOTS | {"color": colour, "marker": marker, "markersize": 4.0}
        for case in range(events.sizes["case"]):
            one = events.sel(event=name).isel(case=case)
            one = one.isel(realization=np.isfinite(one["low"].values))
            if not one.sizes["realization"]:
                continue
            low, reached = one["low"].values, np.isfinite(one["high"].values)
            middle, row = 0.5 * (low + np.where(reached, one["high"].values, low)), case + 0.22 * (index - 1)
            axes.plot([middle.min(), middle.max()], [row, row], color=colour, linewidth=0.9, linestyle="-")
            axes.plot([np.median(middle)], [row], markerfacecolor=colour if reached.all() else "white", **symbol)
            if not reached.all():
                axes.annotate(
                    "", (1.0, row), (middle.max(), row), xycoords=("axes fraction", "data"), textcoords="data",
                    arrowprops={"arrowstyle": "->", "color": colour, "linewidth": 0.9},
                )  # fmt: skip
        axes.plot([], [], label=text, **symbol)
    axes.legend(loc="upper left")
    names = list(map(material, delta, friction))
    axes.set(xlabel=style.FORCE, ylim=(len(names) - 0.4, -0.6))
    if last > 0.0:
        axes.set(xscale="log", xlim=(max(0.5 * first, 2e-3 * last), 3.0 * last))
    axes.xaxis.set_minor_formatter("")
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", length=0.0, which="both")
