"""Fig. 22: the force at which one peak becomes two, against friction, for every polydispersity."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.figures import style

#: Kinds of a crossover, as stored.
FOUND, BELOW, ABOVE = 0, 1, 2
#: Levels of the drawn interval.
LOW, HIGH = 0.16, 0.84


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig22_phase_diagram`` from the datasets of the study of the same name."""
    crossovers, shapes = datasets["crossovers"], datasets["shapes"]
    figure, panels = style.figure(1, 2, width="double", height=3.0, sharey=True)
    usual = crossovers["lattice_constant"].values[0]
    for index, (axes, width) in enumerate(zip(panels[0], crossovers["width"].values, strict=False)):
        _diagram(axes, crossovers.isel(width=index), usual)
        style.letter(axes, "ab"[index], place="above", text=f"$w = {width:g}\\,R$")
        axes.set(xlabel="$\\mu = \\mu^{\\mathrm{wall}}$", yscale="log")
    panels[0, 0].set_ylabel("crossover force $F_{\\mathrm{ext}}/mg$")
    panels[0, 0].legend(loc="lower right")
    del shapes
    return {"fig22_phase_diagram": figure}


def _diagram(axes: Axes, data: xr.Dataset, usual: str) -> None:
    chosen = data["lattice_constant"].values == usual
    deltas = sorted(set(data["polydispersity"].values[chosen].tolist()))
    for index, delta in enumerate(deltas):
        here = np.flatnonzero(chosen & (data["polydispersity"].values == delta))
        here = here[np.argsort(data["friction"].values[here])]
        friction, force, kind = (data[name].values[here] for name in ("friction", "force", "kind"))
        shift = 0.012 * (index - 0.5 * (len(deltas) - 1))  # so that error bars do not hide each other
        low, high = (data["interval"].sel(level=level).values[here] for level in (LOW, HIGH))
        look = style.marked_line(index)
        name = f"$\\delta = {delta:g}$" if delta else "lattice"
        found = kind == FOUND
        axes.plot(friction[found] + shift, force[found], **look, label=name)
        bars = {"color": look["color"], "linewidth": 0.9, "linestyle": "-"}
        for k in range(len(here)):
            at = friction[k] + shift
            if kind[k] == FOUND:
                ends = [max(low[k], 1e-6), min(high[k], 1e6)]
                axes.plot([at, at], ends, **bars)
            else:
                marker = "v" if kind[k] == BELOW else "^"
                axes.plot(at, force[k], marker=marker, markerfacecolor="white", markeredgecolor=look["color"],
                          markersize=5.0, linestyle="none")  # fmt: skip
    axes.set_xlim(-0.06, None)
