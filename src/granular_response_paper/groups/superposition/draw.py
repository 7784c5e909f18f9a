"""Figs. 23 and 24: two forces at once against the sum of each alone, and how far the two are apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response.state import FloatArray
from granular_response_paper.captions import WEIGHT, Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import banded, family, label_ends, titles, zero

from .parameters import FORCES, Parameters

#: The realization that both figures show.
REALIZATION = 0

#: The force up to which the paper finds the response linear here, in mean disk weights (Sec. VI).
LINEAR_UNTIL = 0.4

#: Part of the box that is shown, in mean radii.
HALF_WIDTH = 48.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    figures = {stem: _responses(datasets["responses"], force) for stem, force in FORCES.items()}
    figures["fig24b_superposition_error"] = _errors(datasets)
    return figures


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    scene, distance = parameters.scene, [4.0 * offset for offset in parameters.offsets]
    given = {stem: of_scene(scene, force=force, distance=distance) for stem, force in FORCES.items()}
    several = of_scene(scene, force=parameters.forces, distance=distance, realizations=parameters.realizations)
    return of_group(
        "superposition",
        given | {"fig24b_superposition_error": several},
        findings={stem: _finding(datasets["errors"], force) for stem, force in FORCES.items()}
        | {"fig24b_superposition_error": _errors_finding(datasets["errors"])},
        tolerance=100.0 * parameters.tolerance,
    )


def _finding(errors: xr.Dataset, force: float) -> str:
    """How far the sum is off in the packing that is drawn, at the smallest and the largest distance."""
    off = 100.0 * errors["floor_error"].isel(realization=REALIZATION).sel(force=force, method="nearest").values
    near, far = errors["distance"].values[[0, -1]]
    return (
        f"In this packing the sum of the single responses is off by {off[0]:.2g} % (root mean square) at a distance of "
        f"{near:g} diameters and by {off[-1]:.2g} % at {far:g}."
    )


def _errors_finding(errors: xr.Dataset) -> str:
    mean = 100.0 * errors["floor_error"].isel(distance=0).mean("realization").values
    low, high = errors["force"].values[[0, -1]]
    return (
        f"At {float(errors['distance'][0]):g} diameters the deviation on the floor is {mean[0]:.2g} % at {low:g} "
        f"and {mean[-1]:.2g} % at {high:g} {WEIGHT}, in the mean over realizations."
    )


def _responses(dataset: xr.Dataset, force: float) -> Figure:
    """Force by force, in one realization; a panel for each distance."""
    data = dataset.isel(realization=REALIZATION).sel(force=force)
    distances = data["distance"].values
    rows = (len(distances) + 1) // 2
    figure, grid = style.figure(
        2 * rows, 2, height=0.45 + 2.4 * rows, sharex=True, sharey="row", height_ratios=[4, 1] * rows
    )
    panels, strips = grid[::2], grid[1::2]
    x, responses = data["x"].values, data["floor_response"].values
    both_figures = dataset.isel(realization=REALIZATION).sel(force=list(FORCES.values()))["floor_response"].values
    high, low = float(both_figures.max()), float(min(0.0, both_figures.min()))  # they share their scales
    furthest = 1.1 * float(np.abs(both_figures[:, :, 2] - both_figures[:, :, :2].sum(axis=2)).max())
    for axes in [*panels.ravel()[len(distances) :], *strips.ravel()[len(distances) :]]:
        axes.set_axis_off()
    for k, (axes, strip) in enumerate(zip(panels.flat[: len(distances)], strips.flat, strict=False)):
        left, right, both = responses[k]
        zero(axes, strip)
        axes.plot(x, left, **{**style.line(0), "linestyle": (0, (5, 1.6)), "linewidth": 0.9}, label="Left")
        axes.plot(x, right, **{**style.line(2), "linewidth": 1.1}, label="Right")
        axes.plot(x, both, color=style.BLACK, linestyle="-", linewidth=0.9, label="(Left+Right)")
        circles = {"markerfacecolor": "none", "markeredgecolor": style.VERMILION, "markeredgewidth": 0.8}
        axes.plot(x, left + right, "o", markersize=3.2, **circles, label="(Left)+(Right)")
        strip.plot(x, both - left - right, color=style.VERMILION, linestyle="-", linewidth=0.9)
        for at in data["load_x"].values[k]:
            network.draw_load(axes, (at, 1.10 * high), length=0.2 * high)
        axes.set(xlim=(-HALF_WIDTH, HALF_WIDTH), ylim=(1.2 * low if low < 0.0 else -0.03 * high, 1.36 * high))
        strip.set_ylim(-furthest, furthest)
        if k % 2 == 0:
            axes.set_ylabel(style.RESPONSE)
            strip.set_ylabel("difference", fontsize=7)
        if k + 2 >= len(distances):
            strip.set_xlabel(style.POSITION)
    titles(panels.flat, [f"$d = {distance:g}$ diameters" for distance in distances])
    panels[0, 1].legend(loc="upper right", fontsize=7.5)
    return figure


def _errors(datasets: Datasets) -> Figure:
    """Errors against force on the floor and at all contacts, and against depth; means over realizations."""
    figure, panels = style.figure(1, 3, height=3.0, sharey=True)
    floor, contacts, deep = panels[0]
    errors, linear = datasets["errors"], datasets["linear_range"]
    force, distances = errors["force"].values, errors["distance"].values
    ends = 0.5 * (linear["linear_until"].values + linear["nonlinear_from"].fillna(np.inf).values)
    quarter, middle, three_quarters = np.quantile(ends, [0.25, 0.5, 0.75], method="closest_observation")
    labels: dict[str, list[tuple[str, float, float, str]]] = {}
    for axes, name in ((floor, "floor_error"), (contacts, "contact_error")):
        axes.axvspan(quarter, min(three_quarters, force[-1]), color=style.FAINT, alpha=0.35, linewidth=0.0, zorder=0)
        if np.isfinite(middle):
            axes.axvline(middle, ymax=0.78, color=style.MUTED, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        for k, look in family(range(len(distances)), of="length"):
            _mean_with_error(axes, force, errors[name].values[:, k], look)
            ends = (f"{distances[k]:g}", float(force[-1]), float(errors[name].values[:, k, -1].mean()), look["color"])
            labels.setdefault(name, []).append(ends)
        style.paper_value(axes, LINEAR_UNTIL, f"paper: {LINEAR_UNTIL:g}", at=0.2)
        axes.set(xscale="log", yscale="log", xlabel=style.FORCE)
    change = linear["contact_change"].values.mean(axis=0)[1:]  # zero at the first force, by definition
    (dotted,) = contacts.plot(linear["force"].values[1:], change, color=style.BLACK, linestyle=(0, (1.2, 1.2)))
    floor.set_ylabel("relative deviation from superposition")
    last = FORCES["fig24_superposition"]
    profiles = errors["row_error"].sel(force=last).values
    for k, look in family(range(len(distances)), of="length"):
        _mean_with_error(deep, errors["gap"].values, profiles[:, k], look)
    deep.set(yscale="log", ylim=(1e-4, 1.5), xlabel=rf"depth below the loads$\,/\,{style.RADIUS}$", xlim=(0.0, None))
    (median,) = contacts.plot([], [], color=style.MUTED, linewidth=0.8, linestyle=(0, (4, 2)))
    deep.legend([dotted, median], ["single load", "linear range ends, median"], loc="lower left")
    for axes, name in ((floor, "floor_error"), (contacts, "contact_error")):
        axes.set_xlim(right=1.9 * force[-1])
        label_ends(axes, labels[name])
    floor.text(0.97, 0.03, "numbers: distance in diameters", transform=floor.transAxes, ha="right", fontsize=7)
    rows = f"contacts between rows, {style.equals(style.F_EXT, last, style.WEIGHT)}"
    texts = ("floor forces", "all contact forces", rows)
    titles(panels[0], texts, stem="fig24b_superposition_error", place="inside")
    return figure


def _mean_with_error(axes: Axes, at: FloatArray, values: FloatArray, look: dict[str, Any]) -> None:
    """Mean over realizations (first axis) with a band of its standard error, if there are several."""
    mean = values.mean(axis=0)
    if len(values) == 1:
        axes.plot(at, mean, **look)
        return
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    banded(axes, at, mean, (np.maximum(mean - error, 1e-9), mean + error), look, alpha=0.18)
