"""The crossover against the size of a slab."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import ArrayLike

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import different, family, label_ends, titles

from .parameters import Parameters

#: Height of a row of the lattice (radii).
ROW = float(np.sqrt(3.0))

#: Behind an exponent: no curve runs through it.
WHITE: dict[str, Any] = {"facecolor": "white", "edgecolor": "none", "pad": 0.3}

#: Over symbols of slabs of the survey.
SURVEYED: dict[str, Any] = {"linestyle": "none", "markerfacecolor": "white", "markeredgewidth": 0.9, "zorder": 3}

#: Least ratio of numbers of layers that are labelled.
NEXT_LABEL = 1.25

#: Events of the first figure.
NAMES = {
    "crossover": "onset of two peaks",
    "reaches_floor": "open region at the floor",
    "first_opening": "first contact opens",
}


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"crossover_scaling": _against_layers(datasets["slabs"], datasets["powers"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    powers = datasets["powers"]
    frictions = different(powers["friction"][of_layers(powers)])
    given = of_scene(parameters.base, friction=frictions, normal_stiffness=None, packing=None)
    exponents = powers["exponent"].sel(event="crossover").values[of_layers(powers), 0]
    known = sorted(exponents[np.isfinite(exponents)])
    ends = " to ".join(dict.fromkeys(said(power) for power in (*known[:1], *known[-1:])))
    finding = f"The onset force of two peaks grows with the number of layers to the power of {ends}." if ends else ""
    surveyed = " Open symbols: slabs of the survey." if any(one.surveyed for one in parameters.series) else ""
    stem = "crossover_scaling"
    return of_group(stem, {stem: given}, {stem: finding}, p=parameters, survey=surveyed)


def of_layers(powers: xr.Dataset) -> list[int]:
    """The series whose slabs differ in their layers."""
    return np.flatnonzero(powers["varied"].values == "layers").tolist()


def name(powers: xr.Dataset, series: int) -> str:
    """Of a series of layers, for legends."""
    friction, kind = float(powers["friction"][series]), str(powers["confined"].values[series])
    sides = {"walls": "walls", "constant": "$P$ constant"}.get(kind, "$P\\propto N$")
    return f"$\\mu = {friction:g}$, {sides}"


def said(power: float) -> str:
    """To two decimals, with a minus that is one and no sign of a zero."""
    return f"{round(power, 2) + 0.0:.2f}".replace("-", "\N{MINUS SIGN}")


def _against_layers(slabs: xr.Dataset, powers: xr.Dataset) -> Figure:
    """(a) crossover, (b) region at the floor, (c) first opening against layers, with power laws; names beside them."""
    figure, panels = style.figure(2, 2, height=5.6)
    titles(panels.flat, NAMES.values())
    for event, axes in zip(NAMES, panels.flat, strict=False):
        exponents = []
        for look, series in zip(_symbols(powers), of_layers(powers), strict=True):
            one = slabs.isel(slab=slabs["series"].values == str(powers["series"].values[series]))
            layers = one["layers"].values.astype(float)
            low, high = one[f"{event}_bracket"].values.T
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            power = float(powers["exponent"].isel(series=series).sel(event=event)[0])
            axes.errorbar(layers, middle, half, capsize=2, **look | {"linestyle": "none"})
            stored = one["surveyed"].values > 0
            axes.plot(layers[stored], middle[stored], **look | SURVEYED)
            ends = np.array([layers.min(), layers.max()])
            through = np.exp(np.nanmean(np.log(middle)) + power * np.log(ends / np.exp(np.log(layers).mean())))
            axes.plot(ends, through, **look | {"marker": ""})
            exponents.append((f"$N^{{{said(power)}}}$", float(ends[1]), float(through[1]), look["color"]))
        style.logarithmic(axes)
        axes.set(xlabel="layers $N$", ylabel=style.FORCE)
        ticks = apart(slabs["layers"])
        axes.set_xticks(ticks, labels=[str(t) for t in ticks])
        axes.xaxis.set_minor_formatter("")
        axes.minorticks_off()
        if axes.get_yscale() == "log":  # it is linear where nothing was found
            axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set_xlim(right=1.5 * float(slabs["layers"].max()))
        label_ends(axes, [end for end in exponents if np.isfinite(end[2])], gap=10.0, bbox=WHITE)
    key = panels[1, 1]
    key.set_axis_off()
    for look, series in zip(_symbols(powers), of_layers(powers), strict=True):
        key.plot([], [], label=name(powers, series), **look)
    key.legend(loc="center")
    return figure


def _symbols(powers: xr.Dataset) -> list[dict[str, Any]]:
    """Of the series of layers: colours by the friction, a marker and dashes of its own for each."""
    frictions = powers["friction"].values[of_layers(powers)].tolist()
    colours = dict(family(different(frictions), of="friction"))
    return [
        {**style.marked_line(k, colour=colours[mu]["color"]), "linestyle": style.LINE_STYLES[k], "markersize": 4.5}
        for k, mu in enumerate(frictions)
    ]


def apart(layers: ArrayLike) -> list[int]:
    """Of ``layers`` those whose labels do not meet on a logarithmic axis, from the least on."""
    chosen: list[int] = []
    for number in different(layers):
        if not chosen or number > NEXT_LABEL * chosen[-1]:
            chosen.append(number)
    return chosen
