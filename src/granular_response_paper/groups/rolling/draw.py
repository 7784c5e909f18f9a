"""Least friction of piles, their floor forces, and the response and couple stress of slabs, with rolling resistance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import family, grey_limit, titles

from .parameters import Parameters

ROLLING = r"\mu_R"
#: Part of the slab that is shown, to both sides of the load (radii).
REACH = 20.0
#: Cases of piles by their names in the picture.
PILES = {"supported": "side walls", "free": "none", "resisting": "none, rolling"}


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``rolling`` from the three datasets of the study of the same name."""
    thresholds, piles, slabs = (datasets[name] for name in ("thresholds", "piles", "slabs"))
    figure, panels = style.figure(2, 3, width="double", height=4.9)
    (least, floor, events), (*responses, couples) = panels
    _least(least, thresholds)
    _floor(floor, piles, thresholds)
    _events(events, slabs)
    drawn = slabs["friction"].values[[0, -1]].tolist()
    for axes, friction in zip(responses, drawn, strict=True):
        _response(axes, slabs.sel(friction=friction))
    responses[0].legend(loc="upper right", handlelength=1.4)
    _couples(couples, slabs)
    slab = [f"slab, ${style.FRICTION} = {friction:g}$" for friction in drawn]
    titles(panels.flat, ["least friction", "floor force", "events, slab", *slab, "couple stress"])
    return {"rolling": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    said = of_scene(parameters.scene, friction=[slab.friction for slab in parameters.slabs])
    return of_group("rolling", {"rolling": said}, p=parameters)


def _places(axes: Axes, values: np.ndarray) -> np.ndarray:
    """(k,) places of rolling frictions, evenly spaced, with 0 among them; they label the axis."""
    places = np.arange(len(values), dtype=float)
    axes.set(xlabel=f"rolling friction ${ROLLING}$", xticks=places, xticklabels=[f"{value:g}" for value in values])
    return places


def _brackets(axes: Axes, x: np.ndarray, low: np.ndarray, high: np.ndarray, **look: object) -> None:
    """Middles with bars from end to end; where nothing happened, an open symbol at the lower end."""
    known = np.isfinite(high)
    middle, half = 0.5 * (low + high)[known], 0.5 * (high - low)[known]
    axes.errorbar(x[known], middle, half, capsize=2.0, **look)  # type: ignore[arg-type]
    open_look = look | {"linestyle": "none", "markerfacecolor": "none", "label": None}
    axes.plot(x[~known], low[~known], **open_look)  # type: ignore[arg-type]


def _least(axes: Axes, thresholds: xr.Dataset) -> None:
    places = _places(axes, thresholds["rolling_friction"].values)
    layers = thresholds["layers"].values
    for k, (size, look) in enumerate(family(layers, of="length")):
        one = thresholds.sel(layers=size)
        beside = places + 0.12 * (k - 0.5 * (len(layers) - 1))
        _brackets(axes, beside, one["low"].values, one["high"].values, **look, label=f"{size} layers")
    axes.set(ylabel=f"${style.FRICTION}$ that holds the pile", ylim=(0.0, None))
    axes.legend(loc="upper right")


def _floor(axes: Axes, piles: xr.Dataset, thresholds: xr.Dataset) -> None:
    highest = piles.isel(layers=int(np.argmax(piles["layers"].values)))
    for k, (case, name) in enumerate(PILES.items()):
        one = highest.sel(case=case)
        axes.plot(one["x"], one["floor_force"], **style.line(k), label=name)
    last = thresholds.sel(layers=highest["layers"]).isel(rolling_friction=-1)
    if np.isfinite(float(last["high"])):
        name = f"none, rolling, ${style.FRICTION} = {float(last['high']):.2g}$"
        axes.plot(last["x"], last["floor_force"], **style.line(len(PILES)), label=name)
    axes.set(xlabel=style.POSITION, ylabel=rf"floor force$\,/\,{style.WEIGHT}$", ylim=(0.0, None))
    axes.legend(loc="lower center", title="support", handlelength=1.6)


def _events(axes: Axes, slabs: xr.Dataset) -> None:
    places = _places(axes, slabs["rolling_friction"].values)
    names = {"opening": ("first opening", "o"), "crossover": ("two peaks", "s")}
    for friction, look in family(slabs["friction"].values, of="friction", marked=False):
        for event, (name, marker) in names.items():
            low, high = slabs[event].sel(friction=friction).values.T
            label = f"{name}, ${style.FRICTION} = {friction:g}$"
            _brackets(axes, places, low, high, **look, marker=marker, markersize=4.0, label=label)
    axes.set(ylabel=rf"${style.F_EXT}\,/\,{style.WEIGHT}$", yscale="log")
    axes.legend(loc="best", fontsize=6.5)


def _response(axes: Axes, slab: xr.Dataset) -> None:
    x = slab["x"].isel(rolling_friction=0).values
    shown = np.abs(x) <= REACH
    grey_limit(axes, x[shown], slab["elastic_response"].isel(rolling_friction=0).values[shown])
    for rolling, look in family(slab["rolling_friction"].values, of="other", marked=False, dashed=True):
        curve = slab["floor_response"].sel(rolling_friction=rolling).values
        axes.plot(x[shown], curve[shown], **look, label=f"${ROLLING} = {rolling:g}$")
    axes.set(xlabel=style.POSITION, ylabel=style.RESPONSE)


def _couples(axes: Axes, slabs: xr.Dataset) -> None:
    for friction, dashes in zip(slabs["friction"].values[[0, -1]], ("-", "--"), strict=True):
        for rolling, look in family(slabs["rolling_friction"].values, of="other", marked=False):
            one = slabs.sel(friction=friction, rolling_friction=rolling)
            axes.plot(one["z"], 100.0 * one["couple_stress"] / one["vertical_stress"], **look | {"linestyle": dashes})
    axes.plot([], [], color=style.MUTED, linestyle="-", label=f"${style.FRICTION} = {slabs['friction'].values[0]:g}$")
    axes.plot([], [], color=style.MUTED, linestyle="--", label=f"${style.FRICTION} = {slabs['friction'].values[-1]:g}$")
    axes.set(
        xlabel="height per slab's", ylabel=rf"couple stress$\,/\,\sigma_{{zz}}{style.RADIUS}$ (%)", ylim=(0.0, None)
    )
    axes.legend(loc="best")
