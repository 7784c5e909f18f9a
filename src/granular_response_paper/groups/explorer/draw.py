"""The response at x = 0 of the slabs that the page's explorer adds, as in Figs. 6 and 20."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group
from granular_response_paper.panels import materials, titles

from .parameters import Parameters


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``explorer``: a panel for ordered slabs, one for disordered ones."""
    figure, (panels,) = style.figure(1, 2, width="double", height=2.9)
    slabs = sorted(datasets.values(), key=lambda slab: (float(slab["polydispersity"]), float(slab["friction"])))
    looks = materials(*([float(slab[key]) for slab in slabs] for key in ("polydispersity", "friction")))
    for slab, (name, look) in zip(slabs, looks, strict=True):
        loaded = slab.isel(state=slice(1, None))
        disordered = float(slab["polydispersity"]) > 0.0
        panels[int(disordered)].plot(loaded["force"], loaded["response_at_centre"], label=name, **look)
    for axes, what in zip(panels, (style.RESPONSE, style.FLOOR_STRESS), strict=True):
        axes.set(xscale="log", xlabel=style.FORCE, ylabel=f"{what} at $x = 0$")
        axes.axhline(0.0, color=style.FAINT, linewidth=0.6)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3, columnspacing=1.0, handlelength=1.6)
    titles(panels, (style.equals(style.STIFFNESS_RATIO, float(slabs[0]["stiffness_ratio"])), ""))
    return {"explorer": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return of_group("explorer", {"explorer": {}}, p=parameters)
