"""Least friction of piles with rolling resistance."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import family

from .parameters import Parameters

ROLLING = r"\mu_R"
#: How gravity comes, in the order in which thresholds are stored, and how its symbols are drawn.
WAYS: dict[str, dict[str, Any]] = {
    "gravity at once": {},
    "gravity ramped": {"markerfacecolor": "white", "markeredgewidth": 0.9, "linestyle": "--"},
}


def draw(datasets: Datasets) -> dict[str, Figure]:
    thresholds = datasets["thresholds"]
    figure, ((axes,),) = style.figure(height=3.0)
    places = _places(axes, thresholds["rolling_friction"].values)
    looks = list(family(thresholds["layers"].values, of="length"))
    for size, look in looks:
        one = thresholds.sel(layers=size)
        middle = 0.5 * (one["low"] + one["high"])
        for ramp, way in zip(one["ramp"].values, WAYS, strict=False):
            axes.plot(places, middle.sel(ramp=ramp), **look | {"markersize": 4.5} | WAYS[way])
        axes.plot(places, one["balance"], color=look["color"], linestyle=":", linewidth=1.2)
    axes.set(ylabel=f"friction ${style.FRICTION}$ that holds the pile", ylim=(0.0, None))
    plain: dict[str, Any] = {"color": style.BLACK, "marker": "o", "markersize": 4.5, "linewidth": 0.9}
    handles = [Line2D([], [], **look, label=f"{size} layers") for size, look in looks]
    handles += [Line2D([], [], **plain | look, label=way) for way, look in WAYS.items()]
    handles.append(Line2D([], [], color=style.BLACK, linestyle=":", linewidth=1.2, label="balance of forces"))
    axes.legend(handles=handles, loc="upper right", ncols=2)
    return {"rolling_resistance": figure}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    layers = ", ".join(map(str, parameters.layers))
    said = of_scene(parameters.scene, friction=None)
    finding = _finding(datasets["thresholds"])
    return of_group("rolling_resistance", {"rolling_resistance": said}, {"rolling_resistance": finding}, layers=layers)


def _finding(thresholds: xr.Dataset) -> str:
    """The friction that holds the highest pile, without and with the largest rolling friction."""
    one = thresholds.isel(ramp=0, layers=int(np.argmax(thresholds["layers"].values)))
    middle = 0.5 * (one["low"] + one["high"]).values
    layers, rolling = int(one["layers"]), one["rolling_friction"].values
    return (
        f"A pile of {layers} layers is held by a friction of {middle[0]:.2g} at µ_R = {rolling[0]:g} and of "
        f"{middle[-1]:.2g} at µ_R = {rolling[-1]:g}."
    )


def _places(axes: Axes, values: np.ndarray) -> np.ndarray:
    """(k,) places of rolling frictions, evenly spaced, with 0 among them; they label the axis."""
    places = np.arange(len(values), dtype=float)
    axes.set(xlabel=f"rolling friction ${ROLLING}$", xticks=places, xticklabels=[f"{value:g}" for value in values])
    return places
