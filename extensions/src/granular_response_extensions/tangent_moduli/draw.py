"""Maps of r and of sliding contacts, and the elastic slab with the measured moduli against the tangent stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import family, titles

from .parameters import Parameters

#: Part of the slab that is shown, to both sides of the load (radii).
REACH = 20.0
#: Ends of the colours of r: -1/3 is the least, without horizontal contacts and friction; 1 is isotropic.
RANGE = -0.5, 1.0


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``tangent_moduli`` from the dataset ``slabs``."""
    slabs = datasets["slabs"]
    figure, panels = style.figure(2, 3, width="double", height=4.6)
    maps, (responses, differences, reaches) = panels
    texts, highest = [], 0.0
    for k, look in family(range(slabs.sizes["slab"]), of="friction"):
        slab = slabs.isel(slab=k, step=np.isfinite(slabs["force"].values[k]))
        one, line = _shown(slab), {"color": look["color"]}
        if k < len(maps):
            filled = _map(maps[k], one)
            texts.append(f"{_friction(one)}, {style.equals(style.F_EXT, float(one['force']), style.WEIGHT)}")
        x = one["x"].values
        inside = np.abs(x) <= REACH
        predicted = one["predicted"].isel(width=0, loads=0).values
        highest = max(highest, predicted.max(), one["measured"].values.max())
        responses.plot(x[inside], one["measured"].values[inside], **line, label=_friction(slab), linestyle="-")
        responses.plot(x[inside], predicted[inside], **line, linestyle="--")
        force, crossover = slab["force"].values, float(slab["crossover"][1])
        for width, mark in ((0, {}), (-1, {"markerfacecolor": "white", "markeredgewidth": 0.9, "linestyle": ":"})):
            by = 100.0 * slab["difference"].isel(width=width).max("loads")
            differences.plot(force, by, **look | {"markersize": 4.0, "markeredgecolor": look["color"]} | mark)
        reaches.plot(force, slab["reach"].isel(width=0, loads=0), **look | {"markersize": 4.0})
        for axes in (differences, reaches):
            axes.axvline(crossover, **line, linestyle="--", linewidth=0.8)
    for axes in maps[len(texts) :]:
        axes.set_axis_off()
    maps[0].set_ylabel(style.HEIGHT)
    figure.colorbar(filled, ax=maps, label="$r$", ticks=(-0.5, 0, 0.5, 1), pad=0.01, aspect=12)
    responses.set(xlabel=style.POSITION, ylabel="floor force per added force", ylim=(0.0, 1.25 * highest))
    differences.set(ylabel="largest difference (%)", ylim=(0.0, None))
    reaches.set(ylabel="depth of $r < 0$ / height", ylim=(-0.03, 1.05))
    ticks = [1, 2, 5, 10, 20, 50]
    for axes in (differences, reaches):
        axes.set(xlabel=style.FORCE, xscale="log", xticks=ticks, xticklabels=ticks)
        axes.minorticks_off()
    responses.legend(fontsize=7, handlelength=1.2, loc="upper left", ncols=3, columnspacing=1.0, borderpad=0.2)
    titles([*maps[: len(texts)], *panels[1]], [*texts, "added force", "elastic slab", r"region of $r < 0$"])
    return {"tangent_moduli": figure}


def _shown(slab: xr.Dataset) -> xr.Dataset:
    """The step whose map is drawn: the first at the force to be shown or above it, or the last one."""
    above = np.flatnonzero(slab["force"].values >= float(slab["shown"]))
    return slab.isel(step=above[0] if above.size else -1)


def _friction(slab: xr.Dataset) -> str:
    return style.equals(style.FRICTION, float(slab["friction"]))


def _map(axes: Axes, one: xr.Dataset) -> PolyCollection:
    corners, sliding = one["corners"].values, one["sliding"].values
    look: dict[str, Any] = {"cmap": style.SIGNED, "norm": TwoSlopeNorm(0.0, *RANGE), "edgecolor": "face"}
    filled = PolyCollection(list(corners), array=one["criterion"].values, linewidth=0.1, **look)
    axes.add_collection(filled)
    axes.plot(*sliding.T, ".", color=style.BLACK, markersize=1.6)
    top = float(corners[..., 1].max())
    network.draw_load(axes, (0.0, top + 0.5))
    axes.set(xlim=(-REACH, REACH), ylim=(0.0, top + 6.0), aspect="equal", xlabel=style.POSITION)
    return filled


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    said = of_scene(parameters.base, friction=[slab.friction for slab in parameters.slabs])
    narrow, wide = parameters.widths[0], parameters.widths[-1]
    return of_group("tangent_moduli", {"tangent_moduli": said}, narrow=narrow, wide=wide)
