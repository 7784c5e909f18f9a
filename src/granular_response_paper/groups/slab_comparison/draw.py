"""Beside Fig. 1a: simulated responses to a small force and the elastic slab, as the number of layers grows."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import note, titles, zero
from granular_response_paper.records import alike

from .parameters import Parameters

STEM = "fig01b_slab_comparison"

#: In the order of their colours.
FLOORS = ("smooth", "rough")

#: What tells cases apart.
_KEYS = ("friction", "floor", "gravity", "disks_per_layer")

#: Legends stand below their panels, in two columns.
_BELOW: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.17), "ncols": 2, "columnspacing": 1.4}


def draw(datasets: Datasets) -> dict[str, Figure]:
    data = datasets["slabs"]
    figure, ((profiles, distances),) = style.figure(1, 2, height=3.5)
    _profiles(profiles, data)
    _distances(distances, data)
    titles((profiles, distances), ("response and elastic slab", "difference from the elastic slab"), stem=STEM)
    return {STEM: figure}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    cases = parameters.cases
    layers = sorted({n for case in cases for n in case.layers})
    wide = float(datasets["slabs"]["disks_per_layer"].max())
    said = of_scene(
        parameters.scene,
        force=parameters.force,
        friction=sorted({case.friction for case in cases}),
        wall_friction=sorted({case.friction if case.floor == "rough" else 0.0 for case in cases}),
        stiffness_ratio=parameters.scene.contact.stiffness_ratio,
        packing=f"slabs of {layers[0]} to {layers[-1]} layers, {wide:g} disks in a row for each layer",
    )
    slabs = datasets["slabs"].isel(slab=datasets["slabs"]["friction"].values == 0.0)
    slabs = slabs.isel(slab=slabs["disks_per_layer"].values == wide)
    count, off = slabs["layers"].values, 100.0 * slabs["distance"].values
    finding = (
        f"Without friction the difference from the elastic slab is {off[count.argmin()]:.2g} % of the peak in "
        f"{count.min():g} layers and {off[count.argmax()]:.2g} % in {count.max():g}."
        if count.size
        else ""
    )
    return of_group("slab_comparison", {STEM: said}, {STEM: finding})


def _name(case: tuple) -> str:
    friction, floor, gravity, _ = case
    return f"µ = {friction:g}, {floor} floor" + (", gravity ramped" if gravity == "slow" else "")


def _profiles(axes: Axes, data: xr.Dataset) -> None:
    """A thin and a deep slab of the first case on a smooth and the last one on a rough floor."""
    cases = alike(data, "slab", *_KEYS)
    first = {case[1]: case for case in reversed(cases)}
    for index, case in enumerate(first[floor] for floor in FLOORS if floor in first):
        friction, floor, *_ = case
        for k, marker in zip((0, -1), ("o.", "sx")[index], strict=True):
            one = cases[case].isel(slab=k)
            layers = int(one["layers"])
            height = np.sqrt(3.0) * layers
            x = one["x"].values / height
            near = np.abs(x) <= 2.0
            # a floor disk covers a length of 2
            pressure = 0.5 * height * one["floor_response"].values
            look: dict[str, Any] = {"color": style.COLOURS[index], "linestyle": "none", "marker": marker, "zorder": 3}
            look |= {"markersize": 4.5, "markerfacecolor": "none"} if marker in "os" else {"markersize": 3.0}
            axes.plot(x[near], pressure[near], **look, label=f"µ = {friction:g}, {floor}, {layers} layers")
        elastic = 0.5 * height * one["elastic"].values
        axes.plot(x[near], elastic[near], **style.line(index), label=f"elastic slab, {floor}")
    zero(axes)
    axes.set(xlabel=style.SCALED_POSITION, ylabel=style.PRESSURE, xlim=(-2.0, 2.0))
    axes.legend(**_BELOW)


def _distances(axes: Axes, data: xr.Dataset) -> None:
    """Distance against the number of layers, one line for each case."""
    widest = data["disks_per_layer"].values == data["disks_per_layer"].values.max()
    for index, (case, slabs) in enumerate(alike(data.isel(slab=widest), "slab", *_KEYS).items()):
        layers, distance = slabs["layers"].values, slabs["distance"].values
        colour = style.COLOURS[FLOORS.index(case[1])]
        marked = style.marked_line(index, colour=colour)
        apart = np.flatnonzero(np.diff(np.log(distance)) > 1.0) + 1  # no part of how the distance falls: not joined
        axes.plot(*np.delete([layers, distance], apart, axis=1), **marked, label=_name(case))
    layers = np.array([data["layers"].min(), data["layers"].max()], dtype=float)
    other = data["distance_other_floor"].values.min()
    axes.axhline(other, color=style.MUTED, linewidth=0.8, linestyle=(0, (2, 2)))
    note(axes, "slab with the other floor", (layers[0], other), (0, -4), va="top", color=style.MUTED, fontsize=8)
    thinnest = data["distance"].values[data["layers"].values == layers[0]]
    guide = 1.25 * thinnest.max() * layers[0] / layers
    axes.plot(layers, guide, color=style.FAINT, linewidth=0.8, zorder=0)
    note(axes, "$\\propto 1/n$", (layers[1], guide[1]), (0, -12), ha="right", fontsize=8)
    axes.set(xscale="log", yscale="log", xlabel="layers $n$", ylabel="difference / largest response")
    ticks = np.unique(data["layers"].values)
    axes.set_xticks(ticks, [f"{n:g}" for n in ticks])
    axes.minorticks_off()
    axes.legend(**_BELOW)
