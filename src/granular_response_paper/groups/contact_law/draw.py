"""The linear law and the power 3/2: floor responses at several forces, a panel for each friction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, lettered, of_group, of_scene
from granular_response_paper.panels import titles

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
        for k, force in enumerate(forces):
            linear, power = one["floor_response"].isel(force=k).values
            difference = float(one["difference"][k])
            look = style.line(k) | {"linewidth": 1.0}
            axes.plot(x[shown], linear[shown], **look)
            axes.plot(
                x[shown], power[shown], color=style.COLOURS[k], linestyle="none", marker=style.MARKERS[k],
                markersize=3.0, markerfacecolor="none",
            )  # fmt: skip
            # one entry for the line and the symbols of a force
            name = f"${force:g}\\,{style.WEIGHT}$: {100 * difference:.0f} % apart"
            axes.plot([], [], **look, marker=style.MARKERS[k], markersize=3.0, markerfacecolor="none", label=name)
        axes.set_xlabel(style.POSITION)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), handlelength=3.0)
    titles(panels, [style.equals(style.FRICTION, friction) for friction in frictions])
    panels[0].set_ylabel(style.RESPONSE)
    return {"contact_law": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    panels = lettered(f"µ = {mu:g}" for mu in parameters.friction)
    said = of_scene(parameters.scene, force=parameters.forces, friction=parameters.friction)
    return of_group("contact_law", {"contact_law": said}, panels=panels)
