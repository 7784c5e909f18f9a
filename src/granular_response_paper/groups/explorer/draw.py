"""The response at x = 0 of the slabs that the page's explorer adds, as in Figs. 6 and 20."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group

from .parameters import Parameters


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``explorer``: a panel for ordered slabs, one for disordered ones."""
    figure, (panels,) = style.figure(1, 2, width="double", height=2.9)
    keys = [(float(slab["polydispersity"]), float(slab["friction"])) for slab in datasets.values()]
    spreads, frictions = (sorted(set(values)) for values in zip(*keys, strict=True))
    for (delta, friction), slab in sorted(zip(keys, datasets.values(), strict=True), key=lambda pair: pair[0]):
        name = f"δ = {delta:g}" if delta else f"$k_T/k_N$ = {float(slab['stiffness_ratio']):g}"
        loaded = slab.isel(state=slice(1, None))
        marked = style.marked_line(frictions.index(friction), colour=style.COLOURS[spreads.index(delta)])
        panels[int(delta > 0.0)].plot(
            loaded["force"], loaded["response_at_centre"], label=f"{name}, µ = {friction:g}", **marked
        )
    for axes, what in zip(panels, (style.RESPONSE, style.FLOOR_STRESS), strict=True):
        axes.set(xscale="log", xlabel=style.FORCE, ylabel=f"{what} at $x = 0$")
        axes.axhline(0.0, color=style.FAINT, linewidth=0.6)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3, columnspacing=1.0, handlelength=1.6)
    style.letters(panels, place="above")
    return {"explorer": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return of_group("explorer", {"explorer": {}}, p=parameters)
