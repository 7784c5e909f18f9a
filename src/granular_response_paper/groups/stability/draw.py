"""Where the dynamics stops working: limits of the time step, energy, rolling, and what became of random scenes."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from granular_response.plot import style
from granular_response.state import FloatArray
from granular_response_paper.captions import Caption, of_group
from granular_response_paper.panels import titles

from .parameters import Parameters

#: Outcomes of a kick in the order of their codes.
OUTCOMES = ("settles", "cycles", "blows up", "no rest state")
SETTLES, BLOWS_UP = OUTCOMES.index("settles"), OUTCOMES.index("blows up")
#: Axes of the study of time steps with their labels.
AXES = {
    "normal_stiffness": style.STIFFNESS,
    "stiffness_ratio": f"${style.STIFFNESS_RATIO}$",
    "damping_ratio": r"damping ratio $\zeta$",
    "friction": f"${style.FRICTION}$",
    "wall_friction": f"${style.WALL_FRICTION}$",
    "wall_stiffness": f"{style.STIFFNESS} of walls",
    "polydispersity": f"${style.POLYDISPERSITY}$",
    "load": style.FORCE,
}
#: Markers without a line.
DOTS: dict[str, Any] = {"linestyle": "none", "markersize": 4.5}

#: Laws of friction, with their names in the legend.
FRICTION_LAWS = {"cut": "default", "literal": "literal"}

#: Outcomes of random scenes in the order of their codes.
RANDOM = ("certified", "uncertified", "not settled", "no equilibrium", "time step refused", "scene refused", "wrong")


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``stability_steps`` (a panel for each property of the scene), ``stability_motion`` and ``stability_scenes``."""
    drawn = {"steps": _steps, "motion": _motion, "scenes": _scenes}
    return {f"stability_{name}": figure(datasets) for name, figure in drawn.items()}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    axes = sum(f"time_step_{name}" in datasets for name in AXES)
    return of_group(
        "stability",
        {"stability_steps": {}, "stability_motion": {}, "stability_scenes": {}},
        p=parameters,
        last=chr(ord("a") - 1 + axes),
        scenes=datasets["random_scenes"].sizes["scene"],
    )


def _steps(datasets: Mapping[str, xr.Dataset]) -> Figure:
    """A panel for each property of the scene: where settling ends for each integrator, and where energy explodes."""
    studies = {name: datasets[f"time_step_{name}"] for name in AXES if f"time_step_{name}" in datasets}
    columns = min(4, len(studies))
    rows = -(-len(studies) // columns)
    figure, panels = style.figure(rows, columns, width="double", height=0.5 + 1.9 * rows, sharey=True)
    for axes in panels.flat[len(studies) :]:
        axes.set_axis_off()
    for axes, (name, study) in zip(panels.flat, studies.items(), strict=False):
        for k, integrator in enumerate(study["integrator"].values.tolist()):
            outcome = study["outcome"].sel(integrator=integrator).transpose(name, "ratio").values
            shift = 0.22 * (k - 0.5 * (study.sizes["integrator"] - 1))
            _limits(axes, study["ratio"].values, outcome, shift, style.marked_line(k), integrator.capitalize())
        axes.axhline(1.0, color=style.BLACK, linestyle="-", linewidth=0.8, zorder=0, label="predicted limit")
        axes.set(yscale="log", xlabel=AXES[name], xlim=(-0.6, study.sizes[name] - 0.4), ylim=(0.7, 4.6))
        axes.set_xticks(range(study.sizes[name]), [_short(value) for value in study[name].values], rotation=90)
        axes.set_yticks([1.0, 2.0, 4.0], ["1", "2", "4"])
        axes.minorticks_off()
        axes.tick_params(axis="x", top=False, length=2.0)
    titles(panels.flat[: len(studies)])
    for axes in panels[:, 0]:
        axes.set_ylabel("time step / limit")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    handles.append(Line2D([], [], linestyle="none", marker="x", color=style.BLACK))
    figure.legend(handles, [*labels, "blows up from here"], loc="outside upper center", ncols=len(handles))
    return figure


def _limits(
    axes: Axes, ratio: FloatArray, outcome: NDArray[Any], shift: float, look: dict[str, Any], name: str
) -> None:
    """Brackets of the step up to which all settle; a cross at the smallest step that blows up.

    ``outcome`` (value, ratio) are codes of :data:`OUTCOMES` for growing ``ratio``. There is no bracket where the
    smallest step does not settle, or the largest does.
    """
    settled = np.logical_and.accumulate(outcome == SETTLES, axis=1).sum(axis=1)
    here = np.flatnonzero((settled > 0) & (settled < len(ratio)))
    low, high = ratio[settled[here] - 1], ratio[settled[here]]
    middle = np.sqrt(low * high)
    axes.errorbar(here + shift, middle, [middle - low, high - middle], **look | DOTS, elinewidth=1.2, label=name)
    for index, row in enumerate(outcome):
        exploding = np.flatnonzero(row == BLOWS_UP)
        if exploding.size:
            axes.plot(index + shift, ratio[exploding[0]], marker="x", color=look["color"], markersize=4.5)


def _short(value: float) -> str:
    exponent = round(np.log10(value)) if value else 0
    return rf"$10^{exponent}$" if exponent > 2 and value == 10.0**exponent else f"{value:g}"


def _motion(datasets: Mapping[str, xr.Dataset]) -> Figure:
    figure, axes = style.figure(2, 2, width="double", height=4.8)
    (drift, sliding), (collisions, rolling) = axes
    _drift(drift, datasets["drift"])
    _sliding(sliding, datasets["drift"])
    _collisions(collisions, datasets["collisions"])
    _rolling(rolling, datasets["rolling"])
    for panel, part in ((drift, 0.3), (collisions, 0.25), (rolling, 0.15)):  # room for the legends
        low, high = panel.get_ylim()
        panel.set_ylim(low, high + part * (high - low))
    titles(axes.flat, place="inside")
    return figure


def _drift(panel: Axes, study: xr.Dataset) -> None:
    for k, integrator in enumerate(study["integrator"].values):
        one = study.sel(integrator=integrator, system="slab")
        panel.plot(one["time"], 1e3 * one["energy_change"], label=str(integrator).capitalize(), **style.line(k))
    panel.set(xlabel=f"time [${style.TIME_UNIT}$]", ylabel=r"energy change [$10^{-3}$]")
    panel.legend(title="undamped slab, no friction", loc="upper right", ncols=3)


def _sliding(panel: Axes, study: xr.Dataset) -> None:
    for k, integrator in enumerate(study["integrator"].values):
        one = study.sel(integrator=integrator, system="slab with friction")
        look = style.marked_line(k)
        place = slice(1 + 5 * k, None, 15)  # at other times, as the curves cover each other
        panel.plot(one["time"], one["energy_change"], color=look["color"], linestyle="-", linewidth=0.9)
        panel.plot(one["time"][place], one["energy_change"][place], label=str(integrator).capitalize(), **look | DOTS)
    panel.axhline(0.0, color=style.MUTED, linewidth=0.8, linestyle="-", zorder=0)
    panel.set(xlabel=f"time [${style.TIME_UNIT}$]", ylabel="energy change", ylim=(-1.15, 0.25))
    panel.legend(title="the same with friction", loc="center right")


def _collisions(panel: Axes, study: xr.Dataset) -> None:
    worst = study["energy_ratio"].max(["spin", "friction"])
    for k, (law, body) in enumerate(product(FRICTION_LAWS, ("floor", "disk"))):
        one = worst.sel(friction_law=law, body=body, damping_ratio=0.0)
        panel.plot(one["angle"], one, label=f"{FRICTION_LAWS[law]} rule, {body}", **style.marked_line(k))
    panel.axhline(1.0, color=style.MUTED, linewidth=0.8, linestyle="-", zorder=0)
    panel.set(xlabel="angle from grazing [degrees]", ylabel="largest energy, after / before")
    panel.legend(loc="upper right", ncols=2)


def _rolling(panel: Axes, study: xr.Dataset) -> None:
    """Time in units of that at which sliding ends, so that all starts have their kink at one."""
    friction = float(study["friction"])
    for k in range(study.sizes["start"]):
        one = study.isel(start=k)
        time = one["time"] * 3.0 * friction / abs(float(one["speed"]) + float(one["spin"]))
        label = f"$v = {float(one['speed']):g}$, $R\\omega = {float(one['spin']):g}$"
        look = style.marked_line(k)
        panel.plot(time, one["velocity"], color=look["color"], linestyle="-")
        panel.plot(time, one["rim_speed"], color=look["color"], linestyle="--")
        some = slice(4, None, 8)
        panel.plot(time[some], one["exact_velocity"][some], label=label, **look | DOTS)
        hollow = {"markerfacecolor": "white", "markeredgewidth": 0.8}
        panel.plot(time[some], one["exact_rim_speed"][some], **look | DOTS | hollow)
    panel.set(xlabel="time / time of sliding", ylabel=r"velocity (–), rim speed (– –) [$\sqrt{g\bar R}$]")
    panel.legend(title="at first", loc="lower right")


def _scenes(datasets: Mapping[str, xr.Dataset]) -> Figure:
    figure, axes = style.figure(1, 3, width="double", height=3.2, width_ratios=[1.1, 1, 1])
    outcomes, residuals, rounding = axes[0]
    study = datasets["random_scenes"]
    code = study["outcome"].values
    count = np.bincount(code, minlength=len(RANDOM)).tolist()
    place = np.arange(len(RANDOM))[::-1]
    bars = outcomes.barh(place, count, color=[style.SKY, style.SKY, *[style.ORANGE] * 4, style.VERMILION])
    for bar in bars[2:]:
        bar.set(hatch="////", edgecolor="white", linewidth=0.0)
    for y, number in zip(place, count, strict=True):
        outcomes.annotate(str(number), (number, y), xytext=(3, 0), textcoords="offset points", va="center", fontsize=8)
    outcomes.set_yticks(place, RANDOM)
    step = 250 if max(count) > 500 else 10
    outcomes.set(xlim=(0, step * np.ceil(1.2 * max(count) / step)), xlabel="random scenes")
    outcomes.tick_params(axis="y", length=0.0)
    certified = study["force_residual"].values[code == 0]
    bins = np.logspace(-16, -3, 53)
    residuals.hist(np.maximum(certified, 1e-16), bins=bins, color=style.SKY)
    residuals.axvline(1e-9, color=style.MUTED, linewidth=0.8, linestyle="--")
    residuals.set(xscale="log", xlim=(1e-16, 1e-4 if certified.max(initial=0.0) < 1e-4 else 1e-2))
    residuals.set_xticks([1e-16, 1e-13, 1e-10, 1e-7, 1e-4])
    residuals.set(xlabel=f"unbalanced force [${style.WEIGHT}$]", ylabel="certified scenes")
    disturbed = datasets["rounding"]
    rows = np.arange(disturbed.sizes["case"])[::-1]
    rounding.plot(disturbed["response_change"].transpose("case", "kick"), rows, "o", color=style.BLUE)
    rounding.axvline(float(disturbed["displacement"]), color=style.MUTED, linewidth=0.8, linestyle="--")
    rounding.set(xscale="log", xlim=(1e-13, 1.0), xticks=[1e-12, 1e-9, 1e-6, 1e-3, 1.0])
    names = [str(case).replace(", ", ",\n", 1) for case in disturbed["case"].values]
    rounding.set_yticks(rows, names, fontsize=7, linespacing=0.9)
    rounding.set(ylim=(-0.7, len(rows) - 0.3), xlabel="change of the response")
    titles(axes.flat)
    return figure
