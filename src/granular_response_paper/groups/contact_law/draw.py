"""The linear law and the power 3/2: floor responses at several forces, a panel for each friction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, lettered, of_group, of_scene
from granular_response_paper.panels import family, titles

from .parameters import Parameters

#: Part of the slab that is shown, to both sides of the load (radii).
REACH = 40.0


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``contact_law`` from the dataset ``responses`` of the study of the same name."""
    data = datasets["responses"]
    frictions, forces = data["friction"].values, data["force"].values
    figure, (panels,) = style.figure(1, len(frictions), width="double", height=2.9, sharey=True)
    x = data["x"].values
    shown = np.abs(x) <= REACH
    for index, axes in enumerate(panels):
        one = data.isel(friction=index)
        for k, (force, look) in enumerate(family(forces, of="force", dashed=True)):
            linear, power = one["floor_response"].isel(force=k).values
            difference = float(one["difference"][k])
            look |= {"linewidth": 1.0, "markersize": 3.0, "markerfacecolor": "none", "markeredgewidth": 0.8}
            axes.plot(x[shown], linear[shown], **look | {"marker": ""})
            axes.plot(x[shown], power[shown], **look | {"linestyle": "none"})
            # one entry for the line and the symbols of a force
            name = f"${force:g}\\,{style.WEIGHT}$: {100 * difference:.0f} % apart"
            axes.plot([], [], **look, label=name)
        axes.set_xlabel(style.POSITION)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), handlelength=3.0)
    titles(panels, [style.equals(style.FRICTION, friction) for friction in frictions])
    panels[0].set_ylabel(style.RESPONSE)
    keys = [
        Line2D([], [], color=style.MUTED, linestyle="-"),
        Line2D([], [], color=style.MUTED, linestyle="none", marker="o", markerfacecolor="none"),
    ]
    figure.legend(keys, ["linear law", "power 3/2"], loc="outside upper center", ncols=2)
    return {"contact_law": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    panels = lettered(f"µ = {mu:g}" for mu in parameters.friction)
    said = of_scene(parameters.scene, force=parameters.forces, friction=parameters.friction)
    return of_group("contact_law", {"contact_law": said}, panels=panels)
