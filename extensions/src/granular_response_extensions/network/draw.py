"""Statistics of contact networks: forces, mobilization, fabric, and coordination against the isostatic value."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_extensions.panels import GUIDE
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import DASHED, DOTTED, among, family, packing, titles

from .parameters import Parameters

#: Of the panels against friction or polydispersity alone.
POLYDISPERSITY, FRICTION = 0.1, 0.2


def draw(datasets: Datasets) -> dict[str, Figure]:
    data = datasets["statistics"]
    rest = data.sel(state="rest")
    delta, mu = among(data["polydispersity"], [POLYDISPERSITY])[0], among(data["friction"], [FRICTION])[0]
    one = rest.sel(polydispersity=delta).mean("realization")
    figure, panels = style.figure(2, 3, height=5.2)
    (forces, spreads, limits), (fabric, contacts, excess) = panels
    for value, look in family(data["friction"].values, of="friction", marked=False):
        by = one.sel(friction=value)
        label = style.equals(style.FRICTION, value)
        _density(forces, by, label=label, **look)
        if value:
            limits.plot(by["mobilization"], by["mobilization_density"], label=label, **look)
    for value, look in family(data["polydispersity"].values, of="polydispersity"):
        by = rest.sel(polydispersity=value)
        alike = by.sel(friction=mu).mean("realization")
        _density(spreads, alike, label=packing(value), **look)
        fabric.plot(np.degrees(by["angle"]), alike["angle_density"] * np.pi, **look | {"markersize": 2.5})
        for axes, name in ((contacts, "coordination_number"), (excess, "hyperstaticity")):
            _against_friction(axes, data.sel(polydispersity=value)[name], label=packing(value), **look)
    for axes in (forces, spreads):
        x = np.array([1.0, 5.5])
        axes.plot(x, 0.5 * np.exp(-1.5 * (x - 1.0)), linestyle=DASHED, **GUIDE)
        axes.set(yscale="log", ylim=(2e-4, 2.0), xlabel="normal force / local mean", ylabel="probability density")
    limits.set(xlabel="tangential force / limit", ylabel="probability density", ylim=(0.0, None))
    fabric.set(xlabel="angle of contact [°]", ylabel="density / isotropic", xticks=[0, 60, 120, 180], ylim=(0.0, None))
    for axes, values in ((contacts, (3.0, 4.0)), (excess, (0.0,))):
        for value in values:
            axes.axhline(value, linestyle=DOTTED, **GUIDE)
        axes.set(xlabel=f"friction ${style.FRICTION}$")
    contacts.set(ylabel="contacts per disk", ylim=(2.9, 4.5))
    excess.set(ylabel="hyperstaticity")
    for axes in (limits, spreads, contacts):
        axes.legend(fontsize=7)
    forces.legend(fontsize=7, loc="lower left")
    titles(
        panels.flat,
        (f"forces, {packing(delta)}", f"forces, {style.equals(style.FRICTION, mu)}", f"mobilization, {packing(delta)}",
         f"fabric, {style.equals(style.FRICTION, mu)}", "coordination", "beyond balance"),
    )  # fmt: skip
    return {"network_statistics": figure}


def _density(axes: Axes, by: xr.Dataset, **look: Any) -> None:
    shown = by["force_density"].where(by["force_density"] > 0.0)
    axes.plot(by["force"], shown, **look | {"markersize": 2.5})


def _against_friction(axes: Axes, values: xr.DataArray, **look: Any) -> None:
    """Means with least and largest realization at rest; large open symbols under the load."""
    friction, rest = values["friction"].values, values.sel(state="rest")
    mean = rest.mean("realization")
    ends = np.abs(np.stack([rest.min("realization") - mean, rest.max("realization") - mean]))
    axes.errorbar(friction, mean, ends, capsize=2, **look | {"markersize": 3.5})
    open_ = {"linestyle": "none", "markerfacecolor": "none", "markersize": 7, "markeredgewidth": 0.8, "label": None}
    axes.plot(friction, values.sel(state="loaded").mean("realization"), **look | open_)


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    said = of_scene(
        parameters.base, friction=None, wall_friction=None, polydispersity=None,
        realizations=parameters.realizations, force=parameters.force,
    )  # fmt: skip
    return of_group("network", {"network_statistics": said}, p=parameters)
