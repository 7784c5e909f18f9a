"""Moduli of packings against their coordination, measured and predicted responses, and maps of r under load."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import network, style
from granular_response.theory.moduli import bulk_and_shear
from granular_response_extensions.panels import materials
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import banded, outer, titles, zero

from .parameters import Parameters

#: Names in keys of how disks follow a strain.
FOLLOWING = {"affine": "affine", "free": "relaxed"}
#: Part of a loaded slab that is shown, to both sides of the load (radii).
REACH = 20.0
#: Ends of the colours of r: -1/3 is the least, without horizontal contacts and friction; 1 is isotropic.
RANGE = -0.5, 1.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    packings = datasets["packings"]
    return {
        "moduli_packings": _moduli(packings),
        "moduli_response": _responses(packings),
        "moduli_loaded": _maps(datasets["slabs"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    packing = f"slabs with periodic sides, {parameters.disks_per_layer} disks in a row for each layer"
    said = of_scene(parameters.base, friction=None, wall_friction=None, polydispersity=None, packing=packing)
    loaded = of_scene(parameters.lattice, friction=[slab.friction for slab in parameters.loaded.slabs])
    most, surveyed = 0, Counter[int]()
    for case in parameters.cases:
        surveyed.update(dict(zip(case.layers, case.further, strict=True)))
        most = max(most, *map(sum, zip(case.realizations, case.further, strict=True)))
    stored = [f"{count} packings of {layers} layers" for layers, count in sorted(surveyed.items()) if count]
    return of_group(
        "moduli",
        {"moduli_packings": said, "moduli_response": said, "moduli_loaded": loaded},
        p=parameters,
        most=most,
        survey=f" Of these, {' and '.join(stored)} come from the survey." if stored else "",
    )


def _mean_and_spread(values: xr.DataArray) -> tuple[np.ndarray, np.ndarray]:
    """Over realizations; no spread of fewer than two."""
    count = values.notnull().sum("realization")
    return values.mean("realization").values, values.std("realization", ddof=1).where(count > 1, 0.0).values


def _moduli(data: xr.Dataset) -> Figure:
    """(a) bulk and (b) shear modulus against coordination, affine and relaxed; (c) horizontal over vertical."""
    figure, (panels,) = style.figure(1, 3, height=3.2)
    a, b, c, d = (data["moduli"].sel(modulus=name) for name in "abcd")
    bulk, shear = bulk_and_shear(a, b, c, d)
    shown = {
        r"bulk modulus $(a + b + 2c)\,/\,4k_N$": bulk,
        r"shear modulus $(a + b - 2c + 2d)\,/\,8k_N$": shear,
        r"$a\,/\,b$, horizontal over vertical": a / b,
    }
    # a colour for each material: those of one polydispersity lie close together
    cases = [
        (name, look | {"color": style.line(case)["color"], "markersize": 4.5})
        for case, (name, look) in enumerate(materials(data["polydispersity"], data["friction"]))
    ]
    for axes, (label, modulus) in zip(panels, shown.items(), strict=True):
        for case, (_, look) in enumerate(cases):
            across, beside = _mean_and_spread(data["coordination"].isel(case=case))
            look = look | {"markeredgewidth": 0.8, "capsize": 2, "linewidth": 0.7}
            for following, filled in (("affine", False), ("free", True)):
                mean, spread = _mean_and_spread(modulus.isel(case=case).sel(following=following))
                face = look["color"] if filled else "white"
                axes.errorbar(across, mean, spread, beside, markerfacecolor=face, markeredgecolor=look["color"], **look)
        axes.set(xlabel="coordination number $z$", ylabel=label, ylim=(0.0, None))
    panels[2].axhline(1.0, color=style.FAINT, linewidth=0.6, zorder=0)
    titles(panels)
    keys = [Line2D([], [], **look | {"linestyle": "none"}) for _, look in cases]
    plain: dict[str, Any] = {"linestyle": "none", "marker": "o", "color": style.BLACK, "markersize": 4.5}
    keys += [Line2D([], [], markerfacecolor="white", **plain), Line2D([], [], **plain)]
    names = [*(name for name, _ in cases), *FOLLOWING.values()]
    figure.legend(keys, names, loc="outside lower center", ncols=4)
    return figure


def _responses(data: xr.Dataset) -> Figure:
    """Mean response of the largest packings of each case over that of the slabs of their moduli."""
    cases = materials(data["polydispersity"], data["friction"])
    rows = -(-len(cases) // 3)
    figure, panels = style.figure(rows, 3, height=0.5 + 1.9 * rows, sharex=True, sharey=True)
    place, texts = data["place"].values, []
    for case, ((name, _), axes) in enumerate(zip(cases, panels.flat, strict=False)):
        one = data.isel(case=case, size=int(np.nanargmax(data["layers"].values[case])), smoothing=0)
        mean, spread = _mean_and_spread(one["response"])
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
    """r and sliding contacts of each slab at the force to be shown: the first at it or above, or the last one."""
    figure, (panels,) = style.figure(1, slabs.sizes["slab"], height=2.2, sharey=True)
    texts = []
    for k, axes in enumerate(panels):
        slab = slabs.isel(slab=k, step=np.isfinite(slabs["force"].values[k]))
        above = np.flatnonzero(slab["force"].values >= float(slab["shown"]))
        one = slab.isel(step=above[0] if above.size else -1)
        filled = _map(axes, one)
        friction = style.equals(style.FRICTION, float(one["friction"]))
        texts.append(f"{friction}, {style.equals(style.F_EXT, float(one['force']), style.WEIGHT)}")
    panels[0].set_ylabel(style.HEIGHT)
    figure.colorbar(filled, ax=panels, label="$r$", ticks=(-0.5, 0, 0.5, 1), pad=0.01, shrink=0.7, aspect=12)
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
