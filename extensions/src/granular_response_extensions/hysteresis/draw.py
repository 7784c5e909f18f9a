"""Loops of load and displacement, and what they leave on the floor."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene, values
from granular_response_paper.panels import different, family, note, titles, zero

from .parameters import Parameters

#: How far from the load floor forces are shown (radii).
REACH = 30.0
#: How points of the second loading are drawn.
DOTS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 2.6}


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"hysteresis_loops": _loops(datasets["curves"], datasets["floor"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    curves = datasets["curves"]
    cases, _ = looped(curves["polydispersity"].values, curves["friction"].values)
    lattices = [parameters.cases[case] for case in cases]
    said = of_scene(parameters.base, friction=None, polydispersity=None)
    given = said | {"friction": [case.friction for case in lattices], "force": lattices[0].forces[-1]}
    return of_group("hysteresis", {"hysteresis_loops": given}, {"hysteresis_loops": _finding(curves.isel(case=cases))})


def _finding(curves: xr.Dataset) -> str:
    """How far apart loading and unloading are at half of the largest load, of the displacement under the largest."""
    said = []
    for case in range(curves.sizes["case"]):
        x, load = (curves[name].isel(case=case).values for name in ("displacement", "load"))
        half = 0.5 * np.nanmax(load[0])
        at = []
        for branch, upwards in ((0, 1), (1, -1)):
            known = np.isfinite(x[branch]) & np.isfinite(load[branch])
            at.append(float(np.interp(half, load[branch][known][::upwards], x[branch][known][::upwards])))
        up, down = at
        apart = 100.0 * abs(down - up) / float(np.nanmax(x[0]))
        said.append(f"{apart:.2g} %" if apart > 0.01 else "nothing")
        said[-1] += f" at µ = {float(curves['friction'][case]):g}"
    return f"At half of the load unloading is off loading by {values(said)} (of the largest displacement)."


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
