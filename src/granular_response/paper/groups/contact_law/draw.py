"""The linear law and the power 3/2: floor responses at several forces, a panel for each friction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style

#: Part of the slab that is shown, to both sides of the load (radii).
REACH = 40.0


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``contact_law`` from the dataset ``responses`` of the study of the same name."""
    data = datasets["responses"]
    frictions, forces = data["friction"].values, data["force"].values
    figure, (panels,) = style.figure(1, len(frictions), width="double", height=2.7, sharey=True)
    x = data["x"].values
    shown = np.abs(x) <= REACH
    for index, axes in enumerate(panels):
        one = data.isel(friction=index)
        for k, force in enumerate(forces):
            linear, power = one["floor_response"].isel(force=k).values
            difference = float(one["difference"][k])
            axes.plot(x[shown], linear[shown], color=style.COLOURS[k], linewidth=1.0)
            axes.plot(
                x[shown], power[shown], color=style.COLOURS[k], linestyle="none", marker=style.MARKERS[k],
                markersize=3.0, markerfacecolor="none", label=f"{force:g} $mg$: {100 * difference:.1f} % apart",
            )  # fmt: skip
        style.letter(axes, "abc"[index], place="above", text=f"µ = {frictions[index]:g}")
        axes.set_xlabel("$x/R$")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2))
    panels[0].set_ylabel(r"floor response$\,/\,F_\mathrm{ext}$")
    return {"contact_law": figure}
