"""Least friction of piles, their floor forces, and the response and couple stress of slabs, with rolling resistance."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import family, grey_limit, titles

from .parameters import Parameters

ROLLING = r"\mu_R"
#: Part of the slab that is shown, to both sides of the load (radii).
REACH = 20.0
#: Cases of piles by their names in the picture.
PILES = {"supported": "side walls", "free": "none", "resisting": f"none, ${ROLLING}$"}


def draw(datasets: Datasets) -> dict[str, Figure]:
    thresholds, piles, slabs = (datasets[name] for name in ("thresholds", "piles", "slabs"))
    figure, panels = style.figure(2, 3, height=5.2)
    (least, floor, events), (*responses, couples) = panels
    _least(least, thresholds)
    _floor(floor, piles, thresholds)
    _events(events, slabs)
    drawn = slabs["friction"].values[[0, -1]].tolist()
    for axes, friction in zip(responses, drawn, strict=True):
        _response(axes, slabs.sel(friction=friction))
    responses[0].legend(loc="lower center", handlelength=1.4, fontsize=6.5)
    _couples(couples, slabs.sel(friction=drawn[0]))
    slab = [f"slab, {style.equals(style.FRICTION, friction)}" for friction in drawn]
    titles(panels.flat, ["least friction", "floor force", "events, slab", *slab, f"couple stress, {slab[0][6:]}"])
    turned = _torques(datasets["torques"].sel(friction=drawn[0]))
    return {"rolling_resistance": figure, "rolling_resistance_torque": turned}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    p = parameters
    said = of_scene(p.scene, friction=[slab.friction for slab in p.slabs])
    layers = ", ".join(map(str, p.layers))
    small, large = p.shown_forces
    turned = of_scene(p.scene, friction=p.slabs[0].friction)
    pictures = {"rolling_resistance": said, "rolling_resistance_torque": turned}
    fields = {"small": small, "large": large, "small_torque": p.torques[0], "large_torque": p.torques[1]}
    return of_group("rolling_resistance", pictures, layers=layers, **fields)


def _places(axes: Axes, values: np.ndarray) -> np.ndarray:
    """(k,) places of rolling frictions, evenly spaced, with 0 among them; they label the axis."""
    places = np.arange(len(values), dtype=float)
    axes.set(xlabel=f"rolling friction ${ROLLING}$", xticks=places, xticklabels=[f"{value:g}" for value in values])
    return places


def _least(axes: Axes, thresholds: xr.Dataset) -> None:
    places = _places(axes, thresholds["rolling_friction"].values)
    for size, look in family(thresholds["layers"].values, of="length"):
        one = thresholds.sel(layers=size)
        middle = 0.5 * (one["low"] + one["high"])
        for k, ramp in enumerate(one["ramp"].values):
            slow = {"markerfacecolor": "white", "markeredgecolor": look["color"], "markeredgewidth": 0.9}
            fill: dict[str, Any] = slow | {"linestyle": "--"} if k else {"label": f"{size} layers"}
            axes.plot(places, middle.sel(ramp=ramp), **look | {"markersize": 4.0} | fill)
        axes.plot(places, one["balance"], color=look["color"], linestyle=":", linewidth=1.2)
    axes.set(ylabel=f"${style.FRICTION}$ that holds the pile", ylim=(0.0, None))
    axes.legend(loc="upper right", fontsize=7)


def _floor(axes: Axes, piles: xr.Dataset, thresholds: xr.Dataset) -> None:
    highest = piles.isel(layers=int(np.argmax(piles["layers"].values)))
    for k, (case, name) in enumerate(PILES.items()):
        one = highest.sel(case=case)
        axes.plot(one["x"], one["floor_force"], **style.line(k), label=name)
    last = thresholds.sel(layers=highest["layers"]).isel(rolling_friction=-1, ramp=0)
    if np.isfinite(float(last["high"])):
        name = f"none, ${ROLLING}$, {style.equals(style.FRICTION, round(float(last['high']), 2))}"
        axes.plot(last["x"], last["floor_force"], **style.line(len(PILES)), label=name)
    axes.set(xlabel=style.POSITION, ylabel=rf"floor force$\,/\,{style.WEIGHT}$", ylim=(0.0, None))
    axes.legend(loc="lower center", title="support", handlelength=1.6, fontsize=7, title_fontsize=7)


def _events(axes: Axes, slabs: xr.Dataset) -> None:
    places = _places(axes, slabs["rolling_friction"].values)
    names = {"opening": ("first opening", "o"), "crossover": ("two peaks", "s")}
    for friction, look in family(slabs["friction"].values, of="friction", marked=False):
        for event, (name, marker) in names.items():
            low, high = slabs[event].sel(friction=friction).values.T
            shown = look | {"marker": marker, "markersize": 4.0}
            axes.plot(places, high, **shown, label=f"{name}, ${style.FRICTION} = {friction:g}$")
            never = np.isnan(high)
            axes.errorbar(places[never], low[never], 0.15 * low[never], lolims=True, **shown | {"linestyle": "none"})
    ticks = [0.5, 1, 2, 5, 10, 20, 40]
    axes.set(ylabel=style.FORCE, yscale="log", yticks=ticks, yticklabels=ticks, ylim=(0.3, 60))
    axes.minorticks_off()
    axes.legend(loc="lower center", fontsize=6.5)


def _response(axes: Axes, slab: xr.Dataset) -> None:
    x = slab["x"].isel(rolling_friction=0).values
    shown = np.abs(x) <= REACH
    grey_limit(axes, x[shown], slab["floor_response"].isel(rolling_friction=0, load=0).values[shown])
    for rolling, look in family(slab["rolling_friction"].values, of="other", marked=False, dashed=True):
        curve = slab["floor_response"].sel(rolling_friction=rolling).isel(load=-1).values
        axes.plot(x[shown], curve[shown], **look, label=f"${ROLLING} = {rolling:g}$")
    axes.set(xlabel=style.POSITION, ylabel=style.RESPONSE)


def _couples(axes: Axes, slab: xr.Dataset) -> None:
    part = 100.0 * slab["couple_stress"] / slab["vertical_stress"]
    for rolling, look in family(slab["rolling_friction"].values, of="other", marked=False):
        for load, dashes in zip((0, -1), ("-", "--"), strict=True):
            axes.plot(part["z"], part.sel(rolling_friction=rolling).isel(load=load), **look | {"linestyle": dashes})
    axes.set(xlabel="height / slab height", ylim=(0.0, None))
    axes.set_ylabel(rf"couple stress$\,/\,\sigma_{{zz}}{style.RADIUS}$ (%)")


def _torques(slab: xr.Dataset) -> Figure:
    """What the antisymmetric stress takes at each row, and what couples hand on below it."""
    figure, panels = style.figure(1, 2, height=2.8, sharex=True, sharey=True)
    rows = np.arange(slab.sizes["line"])
    shares = {"antisymmetric": rows, "couple": rows + 0.5}
    for axes, (name, below) in zip(panels[0], shares.items(), strict=True):
        axes.axhline(0.0, color=style.MUTED, linewidth=0.6)
        for rolling, look in family(slab["rolling_friction"].values, of="other"):
            small, large = slab[name].sel(rolling_friction=rolling).values
            axes.plot(below, small, **look, label=f"${ROLLING} = {rolling:g}$")
            axes.plot(below, large, **look | {"linestyle": "--", "markersize": 2.5})
        axes.set(xlabel="rows below the load", xlim=(-0.2, 4.7), xticks=range(5))
        axes.set_yscale("symlog", linthresh=1e-3)
    panels[0, 0].set(ylabel="moment / torque", ylim=(-0.06, 2.0))
    solid = slab["solid"].isel(rolling_friction=-1, torque=0)
    panels[0, 1].plot(shares["couple"], solid, color=style.FAINT, linewidth=3.5, zorder=1, label="Cosserat solid")
    panels[0, 1].legend(loc="upper right", fontsize=7)
    titles(panels.flat, ["antisymmetric stress, by row", "couples, between rows"])
    return figure
