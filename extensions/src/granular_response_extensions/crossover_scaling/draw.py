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
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene, values
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
    slabs, powers = datasets["slabs"], datasets["powers"]
    return {
        "crossover_scaling": _against_layers(slabs, powers),
        "width_stiffness_and_prestress": _apart(slabs, powers),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    powers = datasets["powers"]
    drawn = {
        "crossover_scaling": of_layers(powers),
        "width_stiffness_and_prestress": np.flatnonzero(powers["varied"].values != "layers").tolist(),
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
        _findings(powers),
        p=parameters,
        survey=" Open symbols: slabs of the survey." if surveyed else "",
    )


def _findings(powers: xr.Dataset) -> dict[str, str]:
    """The exponents of the onset of two peaks, a sentence for each picture."""
    exponent = powers["exponent"].sel(event="crossover").values[:, 0]
    layers = [f"{said(exponent[k])} ({_plain(powers, k)})" for k in of_layers(powers) if np.isfinite(exponent[k])]
    kinds = []
    for kind, text in zip(APART, ("width", "stiffness", "prestress"), strict=True):
        chosen = [k for k in np.flatnonzero(powers["varied"].values == kind).tolist() if np.isfinite(exponent[k])]
        if chosen:
            each = (f"{said(exponent[k])} (µ = {powers['friction'].values[k]:g})" for k in chosen)
            kinds.append(f"{text}: {', '.join(each)}")
    return {
        "crossover_scaling": f"The onset force of two peaks grows with the layers to the power of {values(layers)}.",
        "width_stiffness_and_prestress": f"Exponents of the onset force of two peaks, by {'; '.join(kinds)}.",
    }


def _plain(powers: xr.Dataset, series: int) -> str:
    """As :func:`name`, for captions."""
    return name(powers, series).replace("$", "").replace("\\mu", "µ").replace("\\propto", "∝")


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


def _apart(slabs: xr.Dataset, powers: xr.Dataset) -> Figure:
    """Crossover over its value at the smallest entry, against width, stiffness and confinement."""
    differs = powers["varied"].values
    kinds = [kind for kind in APART if (differs == kind).any()]
    figure, panels = style.figure(1, max(1, len(kinds)), height=3.0)
    titles(panels[0, : len(kinds)])
    for axes, kind in zip(panels[0], kinds, strict=False):
        for series, look in family(np.flatnonzero(differs == kind).tolist(), of="friction"):
            one = slabs.isel(slab=_slabs_of(slabs, powers, series))
            middle, half = _brackets(one, "crossover")
            power = float(powers["exponent"].isel(series=series).sel(event="crossover")[0])
            friction, layers = float(powers["friction"][series]), int(one["layers"][0])
            label = f"$\\mu = {friction:g}$, $N = {layers}$: {said(power)}"
            axes.errorbar(varied(one, kind), middle, half, capsize=2, label=label, **look | {"markersize": 4.5})
        style.logarithmic(axes)
        axes.set(xlabel=APART[kind])
        axes.yaxis.set(**_ticks(axes))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set(major_formatter="{x:g}", minor_formatter="")
        if kind == "disks_per_layer":  # within a decade
            axes.set_xticks([2, 3, 4, 6], labels=["2", "3", "4", "6"])
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.08), fontsize=7, title="exponent", title_fontsize=7)
    panels[0, 0].set_ylabel(f"onset of two peaks, {style.FORCE}")
    return figure
