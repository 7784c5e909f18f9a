"""How much each reading of the paper moves the floor response: a chart for docs/reproduction-notes.md."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """Largest difference of the floor response from the reference, for every variant and friction."""
    figure, ((axes,),) = style.figure(width="double", height=3.2)
    names = [str(text) for text in next(iter(datasets.values()))["text"].values[1:]]
    places = np.arange(len(names))[::-1]
    for index, (group, data) in enumerate(datasets.items()):
        look = style.marked_line(index) | {"linestyle": "none"}
        label = f"µ = {group.removeprefix('mu_')}"
        axes.plot(data["largest_difference"].values[1:], places, label=label, **look)
    axes.set(xscale="log", xlabel="largest change of the floor response, per applied force", yticks=places)
    axes.set_yticklabels(names)
    axes.grid(axis="y", linewidth=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return {"sensitivity": figure}
