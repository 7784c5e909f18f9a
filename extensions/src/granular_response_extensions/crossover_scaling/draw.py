"""The crossover against the size of a slab, regions of open contacts scaled, and what else sets the crossover."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import ArrayLike

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import different, family, label_ends, titles

from .parameters import Parameters, varied

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

#: What is varied beside the layers, and its label.
APART = {
    "disks_per_layer": "disks in a row / layers",
    "stiffness_per_layer": rf"stiffness per layer $k_N{style.RADIUS}/(N{style.WEIGHT})$",
    "confinement": rf"lateral prestress $P/{style.WEIGHT}$",
}


def draw(datasets: Datasets) -> dict[str, Figure]:
    slabs, paths, powers = datasets["slabs"], datasets["paths"], datasets["powers"]
    return {
        "crossover_scaling": _against_layers(slabs, powers),
        "crossover_scaling_regions": _regions(slabs, paths, powers),
        "crossover_scaling_apart": _apart(slabs, powers),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    slabs, powers = datasets["slabs"], datasets["powers"]
    drawn = {
        "crossover_scaling": of_layers(powers),
        "crossover_scaling_regions": regions_of(powers),
        "crossover_scaling_apart": np.flatnonzero(powers["varied"].values != "layers").tolist(),
    }
    said = {
        stem: of_scene(
            parameters.base, friction=different(powers["friction"][series]), normal_stiffness=None, packing=None
        )
        for stem, series in drawn.items()
    }
    surveyed = any(one.surveyed for one in parameters.series)
    return of_group(
        "crossover_scaling",
        said,
        p=parameters,
        layers=different(slabs["layers"]),
        survey=" Open symbols: slabs of the survey." if surveyed else "",
    )


def of_layers(powers: xr.Dataset) -> list[int]:
    """The series whose slabs differ in their layers."""
    return np.flatnonzero(powers["varied"].values == "layers").tolist()


def _slabs_of(slabs: xr.Dataset, powers: xr.Dataset, series: int) -> np.ndarray:
    return np.flatnonzero(slabs["series"].values == str(powers["series"].values[series]))


def name(powers: xr.Dataset, series: int) -> str:
    """Of a series of layers, for legends."""
    friction, kind = float(powers["friction"][series]), str(powers["confined"].values[series])
    sides = {"walls": "walls", "constant": "$P$ constant"}.get(kind, "$P\\propto N$")
    return f"$\\mu = {friction:g}$, {sides}"


def said(power: float) -> str:
    """To two decimals, with a minus that is one and no sign of a zero."""
    return f"{round(power, 2) + 0.0:.2f}".replace("-", "\N{MINUS SIGN}")


def _ticks(axes: Axes) -> dict[str, Any]:
    """Where the ticks of a logarithmic axis stand; it is linear where nothing was found."""
    return {"major_locator": LogLocator(subs=(1.0, 2.0, 5.0))} if axes.get_yscale() == "log" else {}


def _brackets(one: xr.Dataset, event: str) -> tuple[np.ndarray, np.ndarray]:
    """Middles and half widths."""
    low, high = one[f"{event}_bracket"].values.T
    return 0.5 * (low + high), 0.5 * (high - low)


def _against_layers(slabs: xr.Dataset, powers: xr.Dataset) -> Figure:
    """(a) crossover, (b) region at the floor, (c) first opening against layers, with power laws; names beside them."""
    figure, panels = style.figure(2, 2, height=5.6)
    titles(panels.flat, NAMES.values())
    for event, axes in zip(NAMES, panels.flat, strict=False):
        exponents = []
        for look, series in zip(_symbols(powers), of_layers(powers), strict=True):
            one = slabs.isel(slab=_slabs_of(slabs, powers, series))
            layers = one["layers"].values.astype(float)
            middle, half = _brackets(one, event)
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
        axes.yaxis.set(major_formatter="{x:g}", **_ticks(axes))
        axes.set_xlim(right=1.5 * float(slabs["layers"].max()))
        label_ends(axes, [end for end in exponents if np.isfinite(end[2])], gap=8.0, bbox=WHITE)
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


def _regions(slabs: xr.Dataset, paths: xr.Dataset, powers: xr.Dataset) -> Figure:
    """Depth of the region of open contacts over that of the slab, against the scaled force, for each friction."""
    chosen = regions_of(powers)
    figure, panels = style.figure(1, max(1, len(chosen)), height=2.7, sharey=True)
    titles(panels[0], [name(powers, series) for series in chosen])
    for axes, series in zip(panels[0], chosen, strict=False):
        rows = _slabs_of(slabs, powers, series)
        weight = float(powers["friction"][series]) > 0.0
        for k, look in family(rows, of="length"):
            layers, confinement = float(slabs["layers"][k]), float(slabs["confinement"][k])
            force = paths["force"].values[k] / (layers**2 if weight else layers * confinement)
            depth = paths["depth"].values[k] / (ROW * (layers - 1.0))
            axes.plot(force, depth, label=f"{layers:.0f}", **look | {"markersize": 3.2})
        unit = rf"$N^2\,{style.WEIGHT}$" if weight else "$NP$"
        axes.set(xlabel=rf"${style.F_EXT}\,/\,$({unit})", ylim=(-0.03, 1.35), xscale="log")
        axes.xaxis.set_minor_formatter("")
        axes.legend(title="layers", loc="upper left", ncols=3, columnspacing=1.0)
    panels[0, 0].set_ylabel("depth of the open region / slab")
    return figure


def regions_of(powers: xr.Dataset) -> list[int]:
    """The series whose regions are drawn: the first without friction, and the least and the most friction.

    With friction only those whose confinement grows with the weight: others need not fall on one another.
    """
    layers = of_layers(powers)
    friction, confined = powers["friction"].values, powers["confined"].values
    without = [k for k in layers if friction[k] == 0.0][:1]
    weight = [k for k in layers if friction[k] > 0.0 and str(confined[k]) == "as weight"]
    rough = sorted(weight, key=lambda k: float(friction[k]))
    return list(dict.fromkeys([*without, *rough[:1], *rough[-1:]]))


def _apart(slabs: xr.Dataset, powers: xr.Dataset) -> Figure:
    """Crossover over its value at the smallest entry, against width, stiffness and confinement."""
    differs = powers["varied"].values
    kinds = [kind for kind in APART if (differs == kind).any()]
    figure, panels = style.figure(1, max(1, len(kinds)), height=2.7)
    titles(panels[0, : len(kinds)])
    for axes, kind in zip(panels[0], kinds, strict=False):
        for series, look in family(np.flatnonzero(differs == kind).tolist(), of="friction"):
            one = slabs.isel(slab=_slabs_of(slabs, powers, series))
            middle, half = _brackets(one, "crossover")
            power, least, largest = powers["exponent"].isel(series=series).sel(event="crossover").values
            friction, layers = float(powers["friction"][series]), int(one["layers"][0])
            label = f"$\\mu = {friction:g}$, $N = {layers}$:\n{said(power)} ({said(least)} to {said(largest)})"
            axes.errorbar(varied(one, kind), middle, half, capsize=2, label=label, **look | {"markersize": 4.5})
        style.logarithmic(axes)
        axes.set(xlabel=APART[kind])
        axes.yaxis.set(**_ticks(axes))
        low, high = axes.get_ylim()
        if low > 0.0:
            axes.set_ylim(low / 1.3, high * max((high / low) ** 0.5, 2.0))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set(major_formatter="{x:g}", minor_formatter="")
        if kind == "disks_per_layer":  # within a decade
            axes.set_xticks([2, 3, 4, 6], labels=["2", "3", "4", "6"])
        axes.legend(loc="upper left", fontsize=7)
    panels[0, 0].set_ylabel(f"onset of two peaks, {style.FORCE}")
    return figure
