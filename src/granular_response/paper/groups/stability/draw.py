"""Where the dynamics stops working: maps of the time step, energy, rolling, and what became of random scenes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from granular_response.plot import style

#: Outcomes of a kick in the order of their codes, with colours that differ in lightness too.
OUTCOMES = (
    ("settles", style.SKY),
    ("cycles", style.ORANGE),
    ("blows up", style.VERMILION),
    ("no rest state", style.FAINT),
)
#: Axes of the maps with their labels.
AXES = {
    "normal_stiffness": r"$k_N$ [$mg/R$]",
    "stiffness_ratio": r"$k_T/k_N$",
    "damping_ratio": r"damping ratio $\zeta$",
    "friction": r"friction $\mu$",
    "wall_friction": "friction of walls",
    "wall_stiffness": r"$k_N$ of walls [$mg/R$]",
    "polydispersity": r"polydispersity $\delta$",
    "load": r"load $F$ [$mg$]",
}
#: Outcomes of random scenes in the order of their codes.
RANDOM = ("certified", "uncertified", "not settled", "no equilibrium", "time step refused", "scene refused", "wrong")


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``stability_steps`` (one map per integrator and axis), ``stability_motion`` and ``stability_scenes``."""
    return {
        "stability_steps": _steps(datasets),
        "stability_motion": _motion(datasets),
        "stability_scenes": _scenes(datasets),
    }


def _steps(datasets: Mapping[str, xr.Dataset]) -> Figure:
    """Two blocks of maps, one above the other: a row for each integrator, a column for each axis."""
    names = [name for name in AXES if f"time_step_{name}" in datasets]
    integrators = [str(i) for i in datasets[f"time_step_{names[0]}"]["integrator"].values]
    columns = -(-len(names) // 2)
    rows = len(integrators)
    figure, axes = style.figure(2 * rows, columns, width="double", height=2.4 * rows + 0.6, sharey=True)
    for panel in axes.flat:
        panel.set_visible(False)
    colours = ListedColormap([colour for _, colour in OUTCOMES])
    for k, name in enumerate(names):
        top, column = rows * (k // columns), k % columns
        for row, integrator in enumerate(integrators):
            panel = axes[top + row, column]
            panel.set_visible(True)
            _map(panel, datasets[f"time_step_{name}"].sel(integrator=integrator), name, colours)
            if row == rows - 1:
                panel.set_xlabel(AXES[name])
            else:
                panel.tick_params(labelbottom=False)
            if column == 0:
                panel.set_ylabel(f"{integrator.capitalize()}\nstep / limit")
    handles: list[Any] = [Patch(facecolor=colour, label=name) for name, colour in OUTCOMES[:3]]
    handles.append(axes[0, 0].get_lines()[0])
    figure.legend(handles=handles, loc="outside upper center", ncols=4)
    return figure


def _map(panel: Axes, study: xr.Dataset, name: str, colours: ListedColormap) -> None:
    """Cells of equal width; the time step in units of its predicted limit on a logarithmic axis."""
    ratio, values = study["ratio"].values, study[name].values
    middle = np.sqrt(ratio[1:] * ratio[:-1])
    edges = np.concatenate([[ratio[0] ** 2 / middle[0]], middle, [ratio[-1] ** 2 / middle[-1]]])
    norm = BoundaryNorm(np.arange(len(OUTCOMES) + 1) - 0.5, len(OUTCOMES))
    outcome = study["outcome"].transpose("ratio", name).values
    panel.pcolormesh(
        np.arange(len(values) + 1), edges, outcome, cmap=colours, norm=norm, edgecolor="white", linewidth=0.4
    )
    panel.axhline(1.0, color=style.BLACK, linestyle="-", linewidth=1.0, label="predicted limit")
    panel.set_yscale("log")
    panel.set_yticks([0.5, 1.0, 2.0, 4.0], ["0.5", "1", "2", "4"])
    panel.minorticks_off()
    panel.set_xticks(np.arange(len(values)) + 0.5, [_short(value) for value in values], rotation=90)
    panel.tick_params(top=False, right=False, length=2.0)


def _short(value: float) -> str:
    exponent = round(np.log10(value)) if value else 0
    return rf"$10^{exponent}$" if exponent > 2 and value == 10.0**exponent else f"{value:g}"


def _motion(datasets: Mapping[str, xr.Dataset]) -> Figure:
    figure, axes = style.figure(2, 2, width="double", height=4.8)
    _drift(axes[0, 0], datasets["drift"])
    _sliding(axes[0, 1], datasets["drift"])
    _collisions(axes[1, 0], datasets["collisions"])
    _rolling(axes[1, 1], datasets["rolling"])
    style.letters(axes)
    return figure


def _drift(panel: Axes, study: xr.Dataset) -> None:
    for k, integrator in enumerate(study["integrator"].values):
        one = study.sel(integrator=integrator, system="slab")
        panel.plot(one["time"], 1e3 * one["energy_change"], label=str(integrator).capitalize(), **style.line(k))
    panel.set_xlabel(r"time [$\sqrt{R/g}$]")
    panel.set_ylabel(r"energy change [$10^{-3}$]")
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + 0.3 * (high - low))
    panel.legend(title="undamped slab, no friction", loc="upper right", ncols=3)


def _sliding(panel: Axes, study: xr.Dataset) -> None:
    for k, integrator in enumerate(study["integrator"].values):
        one = study.sel(integrator=integrator, system="slab with friction")
        panel.plot(one["time"], one["energy_change"], label=str(integrator).capitalize(), **style.line(k))
    panel.axhline(0.0, color=style.MUTED, linewidth=0.8, linestyle="-", zorder=0)
    panel.set_ylim(-1.15, 0.25)
    panel.set_xlabel(r"time [$\sqrt{R/g}$]")
    panel.set_ylabel("energy change")
    panel.legend(title="the same with friction", loc="center right")


def _collisions(panel: Axes, study: xr.Dataset) -> None:
    worst = study["energy_ratio"].max(["spin", "friction"])
    for k, (law, body) in enumerate((law, body) for law in ("cut", "literal") for body in ("floor", "disk")):
        one = worst.sel(friction_law=law, body=body, damping_ratio=0.0)
        panel.plot(one["angle"], one, label=f"{law} rule, {body}", **style.marked_line(k))
    panel.axhline(1.0, color=style.MUTED, linewidth=0.8, linestyle="-", zorder=0)
    panel.set_xlabel("angle from grazing [degrees]")
    panel.set_ylabel("largest energy, after / before")
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + 0.25 * (high - low))
    panel.legend(loc="upper right", ncols=2)


def _rolling(panel: Axes, study: xr.Dataset) -> None:
    """Time in units of that at which sliding ends, so that all starts have their kink at one."""
    friction = float(study["friction"])
    for k in range(study.sizes["start"]):
        one = study.isel(start=k)
        time = one["time"] * 3.0 * friction / abs(float(one["speed"]) + float(one["spin"]))
        label = f"$v$ = {float(one['speed']):g}, $R\\omega$ = {float(one['spin']):g}"
        colour = style.COLOURS[k]
        panel.plot(time, one["velocity"], color=colour, linestyle="-", label=label)
        panel.plot(time, one["rim_speed"], color=colour, linestyle="--")
        some = slice(4, None, 8)
        panel.plot(time[some], one["exact_velocity"][some], color=colour, marker="o", linestyle="none")
        panel.plot(time[some], one["exact_rim_speed"][some], color=colour, marker="s", linestyle="none", mfc="w")
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + 0.15 * (high - low))
    panel.set_xlabel("time / time of sliding")
    panel.set_ylabel(r"velocity (–), rim speed (– –) [$\sqrt{gR}$]")
    panel.legend(title="at first", loc="lower right")


def _scenes(datasets: Mapping[str, xr.Dataset]) -> Figure:
    figure, axes = style.figure(1, 3, width="double", height=3.2, width_ratios=[1.1, 1, 1])
    outcomes, residuals, rounding = axes[0]
    study = datasets["random_scenes"]
    code = study["outcome"].values
    count = [int((code == k).sum()) for k in range(len(RANDOM))]
    place = np.arange(len(RANDOM))[::-1]
    outcomes.barh(place, count, color=[style.SKY, style.SKY, *[style.ORANGE] * 4, style.VERMILION])
    for y, number in zip(place, count, strict=True):
        outcomes.annotate(str(number), (number, y), xytext=(3, 0), textcoords="offset points", va="center", fontsize=8)
    outcomes.set_yticks(place, RANDOM)
    outcomes.set_xlim(0, 1.3 * max(count))
    outcomes.tick_params(axis="y", length=0.0)
    outcomes.set_xlabel("random scenes")
    certified = study["force_residual"].values[code == 0]
    bins = np.logspace(-16, -3, 53)
    residuals.hist(np.maximum(certified, 1e-16), bins=bins, color=style.SKY)
    residuals.axvline(1e-9, color=style.MUTED, linewidth=0.8, linestyle="--")
    residuals.set_xscale("log")
    residuals.set_xlabel(r"unbalanced force [$mg$]")
    residuals.set_ylabel("certified scenes")
    disturbed = datasets["rounding"]
    rows = np.arange(disturbed.sizes["case"])[::-1]
    for k in range(disturbed.sizes["kick"]):
        rounding.plot(disturbed["response_change"].isel(kick=k), rows, "o", color=style.BLUE)
    rounding.axvline(float(disturbed["displacement"]), color=style.MUTED, linewidth=0.8, linestyle="--")
    rounding.set_xscale("log")
    names = [str(case).replace(", ", ",\n", 1) for case in disturbed["case"].values]
    rounding.set_yticks(rows, names, fontsize=7, linespacing=0.9)
    rounding.set_ylim(-0.7, len(rows) - 0.3)
    rounding.set_xlabel("change of the response")
    style.letters(axes, place="above")
    return figure
