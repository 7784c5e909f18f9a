"""Measured and predicted responses of packings, and maps of r under load."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response_extensions.panels import materials
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import banded, outer, titles, zero

from .parameters import Parameters

#: Part of a loaded slab that is shown, to both sides of the load (radii).
REACH = 20.0
#: Ends of the colours of r: -1/3 is the least, without horizontal contacts and friction; 1 is isotropic.
RANGE = -0.5, 1.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"moduli_response": _responses(datasets["packings"]), "moduli_loaded": _maps(datasets["slabs"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    packing = f"slabs with periodic sides, {parameters.disks_per_layer} disks in a row for each layer"
    varied = dict.fromkeys(("friction", "wall_friction", "polydispersity"))
    said = of_scene(parameters.base, width=parameters.width, packing=packing, **varied)
    loaded = of_scene(parameters.lattice, friction=[slab.friction for slab in parameters.loaded.slabs])
    surveyed = sum(case.further[int(np.argmax(case.layers))] for case in parameters.cases)
    return of_group(
        "moduli",
        {"moduli_response": said, "moduli_loaded": loaded},
        _findings(datasets),
        p=parameters,
        survey=f" {surveyed} packings come from the survey." if surveyed else "",
    )


def _findings(datasets: Datasets) -> dict[str, str]:
    """How far the response is off the slab with the measured moduli, and whether r is negative below the load."""
    data, slabs, off = datasets["packings"], datasets["slabs"], []
    for case in range(data.sizes["case"]):
        one = data.isel(case=case, size=int(np.nanargmax(data["layers"].values[case])), smoothing=0)
        off.append((float(one["difference"].sel(solid="free").mean("realization")), case))
    worst = max(off)[1]
    delta, mu = (float(data[name][worst]) for name in ("polydispersity", "friction"))
    negative = []
    for k in range(slabs.sizes["slab"]):
        one = _step(slabs, k)
        part = float(np.nanmean(one["criterion"].values < 0.0))
        negative.append(f"{100.0 * part:.2g} % at µ = {float(one['friction']):g}")
    return {
        "moduli_response": (
            f"Responses differ from elastic slabs with the measured moduli by {100.0 * min(off)[0]:.2g} to "
            f"{100.0 * max(off)[0]:.2g} % of the peak on average, most at δ = {delta:g}, µ = {mu:g}."
        ),
        "moduli_loaded": f"Part of the map in which r is negative: {', '.join(negative)}.",
    }


def _step(slabs: xr.Dataset, k: int) -> xr.Dataset:
    """A slab at the force to be shown: the first at it or above, or the last one."""
    slab = slabs.isel(slab=k, step=np.isfinite(slabs["force"].values[k]))
    above = np.flatnonzero(slab["force"].values >= float(slab["shown"]))
    return slab.isel(step=above[0] if above.size else -1)


def _responses(data: xr.Dataset) -> Figure:
    """Mean response of the largest packings of each case over that of the slabs of their moduli."""
    cases = materials(data["polydispersity"], data["friction"])
    rows = -(-len(cases) // 3)
    figure, panels = style.figure(rows, 3, height=0.5 + 1.9 * rows, sharex=True, sharey=True)
    place, texts = data["place"].values, []
    for case, ((name, _), axes) in enumerate(zip(cases, panels.flat, strict=False)):
        one = data.isel(case=case, size=int(np.nanargmax(data["layers"].values[case])), smoothing=0)
        mean = one["response"].mean("realization").values
        spread = one["response"].std("realization", ddof=1).fillna(0.0).values  # none of a single one
        banded(axes, place, mean, (mean - spread, mean + spread), style.line(0), label="packings")
        for solid, look, label in (
            ("free", {"color": style.BLACK, "linestyle": (0, (4, 2))}, "slab with the measured moduli"),
            ("isotropic", {"color": style.COLOURS[1], "linestyle": (0, (1.2, 1.2))}, "isotropic slab"),
        ):
            axes.plot(place, one["predicted"].sel(solid=solid).mean("realization"), label=label, **look)
        zero(axes)
        axes.set_xlim(place[0], place[-1])
        texts.append(f"{name}, {float(one['layers']):g} layers")
    titles(panels.flat, texts)
    outer(panels, style.SCALED_POSITION, style.PRESSURE)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _maps(slabs: xr.Dataset) -> Figure:
    """r and sliding contacts of each slab at the force to be shown."""
    figure, (panels,) = style.figure(1, slabs.sizes["slab"], height=2.2, sharey=True)
    texts = []
    for k, axes in enumerate(panels):
        one = _step(slabs, k)
        filled = _map(axes, one)
        friction = style.equals(style.FRICTION, float(one["friction"]))
        texts.append(f"{friction}, {style.equals(style.F_EXT, float(one['force']), style.WEIGHT)}")
    panels[0].set_ylabel(style.HEIGHT)
    label = "$r$; below 0:\ntwo peaks expected"
    figure.colorbar(filled, ax=panels, label=label, ticks=(-0.5, 0, 0.5, 1), pad=0.01, shrink=0.7, aspect=12)
    titles(panels, texts)
    return figure


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
