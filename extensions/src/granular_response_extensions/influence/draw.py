"""What every disk sets in motion on the floor."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.collections import PatchCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from granular_response.plot import style
from granular_response_extensions.panels import materials
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene, values
from granular_response_paper.panels import titles

from .parameters import Parameters

#: Half the width of the maps (radii).
REACH = 30.0
#: End of the colour scale: a little below the least there is, 1 where walls bear nothing.
LEAST = 0.8
#: A map is drawn where one disk in twenty exceeds the median by this factor; others have one colour.
VARIED = 1.2


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"influence_map": _maps(datasets["packings"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    packings = datasets["packings"]
    like = packings.isel(case=packings["polydispersity"].values == packings["polydispersity"].values[-1])
    medians = [
        f"{float(np.nanmedian(one)):.2g} at µ = {float(mu):g}"
        for one, mu in zip(like["total"].values, like["friction"].values, strict=True)
    ]
    said = of_scene(parameters.base, friction=None, wall_friction=None, polydispersity=None)
    return of_group(
        "influence",
        {"influence_map": said},
        {"influence_map": f"A small force changes the floor forces by a median of {values(medians)} times itself."},
    )


def _maps(data: xr.Dataset) -> Figure:
    """A panel for each case that differs from disk to disk; disks that bear nothing stay white."""
    data = _mapped(data)
    figure, (panels,) = style.figure(1, data.sizes["case"], height=1.2 + 2.4 / data.sizes["case"], sharey=True)
    # the weight of a unit force is 1 where no floor disk is relieved; what exceeds that is pushed up and down
    largest = float(np.nanquantile(data["total"].values, 0.995))
    medians = np.nanmedian(data["total"].values, axis=1)
    cases = materials(data["polydispersity"], data["friction"])
    titles(panels, [f"{name}, median {middle:.1f}" for (name, _), middle in zip(cases, medians, strict=True)])
    for case, axes in enumerate(panels):
        one = data.isel(case=case)
        x, z = one["position"].values.T
        shown = np.flatnonzero(np.abs(x) <= REACH)
        disks = [Circle((x[k], z[k]), one["radius"].values[k]) for k in shown]
        drawn = PatchCollection(disks, cmap=style.SEQUENTIAL, edgecolor="none")
        drawn.set_array(np.ma.masked_invalid(one["total"].values[shown]))
        drawn.set_norm(LogNorm(LEAST, max(largest, 2.0 * LEAST)))
        axes.add_collection(drawn)
        axes.axhline(0.0, color=style.BLACK, linewidth=1.0)
        axes.set(xlim=(-REACH, REACH), ylim=(-1.0, z.max() + 1.5), aspect="equal", xlabel=style.POSITION)
    panels[0].set_ylabel(style.HEIGHT)
    ticks = [t for t in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if t <= largest]
    label = "absolute forces on the floor\nper unit force on the disk"
    bar = figure.colorbar(drawn, ax=panels, label=label, shrink=0.8)
    bar.set_ticks(ticks, labels=[f"{t:g}" for t in ticks])
    bar.minorticks_off()
    return figure


def _mapped(data: xr.Dataset) -> xr.Dataset:
    """The cases with the polydispersity of the last one whose weights differ from disk to disk."""
    data = data.isel(case=data["polydispersity"].values == data["polydispersity"].values[-1])
    varied = np.nanquantile(data["total"].values, 0.95, axis=1) > VARIED * np.nanmedian(data["total"].values, axis=1)
    return data.isel(case=varied) if varied.any() else data
