"""The overview and the growing force."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.animation import FuncAnimation
from matplotlib.figure import Figure

from granular_response.observe.peaks import find_peaks, is_double_peaked
from granular_response.plot import style
from granular_response.plot.animation import FULL, Frames, animate
from granular_response.plot.chains import draw_chains, draw_key, draw_peaks, draw_response
from granular_response.plot.shown import Shown
from granular_response_paper.captions import WEIGHT, Caption, Datasets, of_group, of_scene, peaks, values

from .parameters import Parameters

#: Mean radii of slabs to each side of the load.
HALF_WIDTH = 30.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    frames = Frames(_slabs(datasets), half_width=HALF_WIDTH, figure=Figure())
    frames.draw(-1)
    return {"overview": _overview(_slabs(datasets)), "growing_force": frames.figure}


def animations(datasets: Datasets) -> dict[str, FuncAnimation]:
    return {"growing_force": animate(_slabs(datasets), half_width=HALF_WIDTH, figure=Figure())}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    forces, given = parameters.forces, of_scene(parameters.scene, friction=parameters.frictions)
    drawn = {"overview": {**given, "force": [forces[0], forces[-1]]}, "growing_force": {**given, "force": forces}}
    return of_group("overview", drawn, _findings(_slabs(datasets)))


def _findings(slabs: Datasets) -> dict[str, str]:
    """How many peaks the response has under the largest force, and from which force on two."""
    last, first = [], []
    for slab in slabs.values():
        x, force = slab["x"].values, np.atleast_1d(slab["total_force"].values)
        curves, inside = np.atleast_2d(slab["floor_response"].values), Shown.of(slab).interior
        two = [is_double_peaked(x, curve, interior=inside) for curve in curves]
        number = len(find_peaks(x, curves[-1], interior=inside))
        last.append(f"{peaks(number)} at µ = {float(slab['friction']):g}")
        begun = f"from {force[int(np.argmax(two))]:.3g} {WEIGHT}" if any(two) else "not"
        first.append(f"{begun} at µ = {float(slab['friction']):g}")
    return {
        "overview": f"Under the large force the response has {values(last)}; under the small one it is elastic."
        if all(_elastic_first(slab) for slab in slabs.values())
        else f"Under the large force the response has {values(last)}.",
        "growing_force": f"Two peaks appear: {', '.join(first)}.",
    }


def _elastic_first(slab: xr.Dataset) -> bool:
    """Whether the response to the smallest force is that to small loads, within 5 % of the peak."""
    first, elastic = np.atleast_2d(slab["floor_response"].values)[0], slab["elastic_response"].values
    return bool(np.abs(first - elastic).max() < 0.05 * elastic.max())


def _slabs(datasets: Datasets) -> dict[str, xr.Dataset]:
    """The slabs by their titles."""
    return {style.equals(style.FRICTION, float(slab["friction"])): slab for slab in datasets.values()}


def _overview(slabs: Datasets) -> Figure:
    """A column for each friction; for the smallest and the largest force the chains above the response."""
    figure, panels = style.figure(4, len(slabs), width=6.2, height=4.9, height_ratios=[1.1, 0.85, 1.1, 0.85])
    curves = np.stack([np.atleast_2d(slab["floor_response"].values)[[0, -1]] for slab in slabs.values()])
    limits = 0.0, 1.08 * float(curves.max())
    for k, (title, slab) in enumerate(slabs.items()):
        half = min(HALF_WIDTH, 0.5 * float(slab.attrs["width"]))
        x, elastic = slab["x"].values, slab["elastic_response"].values
        for row, force in enumerate(np.atleast_1d(slab["total_force"].values)[[0, -1]].tolist()):
            above, below = panels[2 * row : 2 * row + 2, k]
            draw_chains(above, Shown.of(slab, 1 if row == 0 else -1), largest=FULL * force, half_width=half)
            draw_response(below, x, curves[k, row], elastic, half_width=half, limits=limits)
            below.tick_params(labelleft=k == 0, labelbottom=row == 1)
            draw_peaks(below, Shown.of(slab), curves[k, row])
            if k == 0:
                name = style.equals(style.F_EXT, force, style.WEIGHT)
                above.text(0.0, 0.98, name, transform=above.transAxes, va="top")
                below.set_ylabel(style.RESPONSE.replace(" ", "\n", 1))
        panels[0, k].set_title(title, pad=2.0)
        panels[3, k].set_xlabel(style.POSITION)
    draw_key(panels[3, -1], "small load")
    return figure
