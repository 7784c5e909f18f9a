"""Figs. 2, 19, 20 and 21: forces in a polydisperse slab, and responses of ensembles of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from granular_response.plot import style
from granular_response.plot.network import (
    draw_box,
    draw_disks,
    draw_force_chains,
    draw_force_key,
    draw_load,
    draw_loaded_disk,
    draw_rotations,
    force_scale,
    pair_points,
    wall_points,
)
from granular_response.state import WALL_NORMAL, Box, contact_force

FloatArray = NDArray[np.float64]

#: Fig. 21 is smoothed with this width, and shows at most so many forces of a case.
FIG21_WIDTH, MOST_FORCES = 6.0, 4

START_NAMES = {"touching-largest": "start: largest disks touch", "2.0": "start: lattice constant $2\\bar R$"}


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig02_polydisperse_forces``, ``fig19_disordered_response``, ``fig20_disordered_linear_range``,
    ``fig21_disordered_forces`` and ``packings`` from the datasets of the study of the same name."""
    return {
        "fig02_polydisperse_forces": _forces(datasets["forces"]),
        "fig19_disordered_response": _response(datasets["individual"]),
        "fig20_disordered_linear_range": _linear_range(datasets["linear_range"]),
        "fig21_disordered_forces": _averages(datasets["averages"]),
        "packings": _packings(datasets["packings"], datasets["averages"]),
    }


def _forces(data: xr.Dataset) -> Figure:
    """Fig. 2: at rest, and what the load adds; one scale for each panel."""
    figure, panels = style.figure(2, 1, width="double", height=3.75)
    pair, wall = _contact_forces(data)
    width, disk = float(data["width"]), int(data["loaded_disk"])
    force = float(data["force"][1])
    radius = data["radius"].values
    top = float((data["position"].values[..., 1] + radius).max())
    for index, axes in enumerate(panels[:, 0]):
        position = data["position"].values[index]
        shown = (pair[0], wall[0]) if index == 0 else (pair[1] - pair[0], wall[1] - wall[0])
        scale = force_scale(*shown, longest=3.2 if index == 0 else 4.4, widest=3.4 if index == 0 else 4.2)
        draw_disks(axes, position, radius, edgecolor="#C4C4C4", linewidth=0.35)
        draw_rotations(axes, position, radius, data["angle"].values[index], color=style.SKY, linewidth=0.45)
        draw_box(axes, Box(width), top)
        pairs = data["contact_disk"].values, data["contact_partner"].values
        draw_force_chains(axes, pair_points(position, radius, *pairs), shown[0], **scale)
        at_wall = wall_points(position, radius, data["wall_disk"].values, data["wall_index"].values)
        draw_force_chains(axes, at_wall, shown[1], **scale)
        name = "at rest under gravity" if index == 0 else f"added by $F_{{\\mathrm{{ext}}}} = {force:g}\\,mg$"
        style.letter(axes, "ab"[index], place="above", text=name)
        draw_force_key(axes, (width - 14.0, top + 2.8), 20.0 if index == 0 else 2.0, **scale)
        style.no_axes(axes)
        axes.set(xlim=(-1.5, width + 1.5), ylim=(-1.5, top + 4.0))
    x, z = data["position"].values[1, disk] + [0.0, radius[disk]]
    draw_loaded_disk(panels[1, 0], (float(x), float(z - radius[disk])), float(radius[disk]))
    draw_load(panels[1, 0], (float(x), float(z)), length=3.6)
    return figure


def _contact_forces(data: xr.Dataset) -> tuple[FloatArray, FloatArray]:
    """(state, m, 2) forces on the first disks of all contacts, and (state, w, 2) forces of the walls."""
    position = data["position"].values
    between = position[:, data["contact_disk"].values] - position[:, data["contact_partner"].values]
    normal = between / np.linalg.norm(between, axis=-1, keepdims=True)
    wall_normal = np.broadcast_to(
        WALL_NORMAL[data["wall_index"].values.astype(int)], (*data["wall_normal_force"].shape, 2)
    )
    return _vectors(normal, data, "contact"), _vectors(wall_normal, data, "wall")


def _vectors(normal: FloatArray, data: xr.Dataset, kind: str) -> FloatArray:
    return contact_force(normal, data[f"{kind}_normal_force"].values, data[f"{kind}_tangential_force"].values)


def _response(data: xr.Dataset) -> Figure:
    """Fig. 19: every realization thin, the mean thick; a row for each start that is stored."""
    frictions = sorted(set(data["friction"].values.tolist()))
    starts = [name for name in START_NAMES if name in data["lattice_constant"].values]
    figure, panels = style.figure(
        len(starts), len(frictions), width="double", height=0.5 + 1.95 * len(starts), sharex=True, sharey=True
    )
    x = data["x"].values
    for row, start in enumerate(starts):
        for column, friction in enumerate(frictions):
            axes = panels[row, column]
            case = _case(data, float(data["polydispersity"][0]), friction, start)
            if case is None:
                axes.set_axis_off()
                continue
            rows = data["response"].values[case]
            rows = rows[np.isfinite(rows).all(axis=1)]
            axes.plot(x, rows.T, color="#A8A8A8", linewidth=0.5, linestyle="-")
            axes.plot(x, rows.mean(axis=0), color=style.BLACK, linewidth=1.8, linestyle="-")
            axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)
            name = f"$\\mu = {friction:g}$, {len(rows)} realizations"
            style.letter(axes, "abcdefgh"[len(frictions) * row + column], text=name)
            if len(starts) > 1:
                axes.annotate(
                    START_NAMES[start],
                    (1.0, 1.0),
                    (-5.0, -5.0),
                    xycoords="axes fraction",
                    textcoords="offset points",
                    ha="right",
                    va="top",
                    fontsize=8,
                )
        panels[row, 0].set_ylabel("$\\sigma_{zz} R / F_{\\mathrm{ext}}$")
    for axes in panels[-1]:
        axes.set(xlabel="$x/R$", xlim=(x[0], x[-1]))
    panels[0, 0].margins(y=0.12)
    return figure


def _case(data: xr.Dataset, polydispersity: float, friction: float, start: str | None = None) -> int | None:
    """The case with these values, if there is one; ``start`` None is any."""
    here = (data["polydispersity"].values == polydispersity) & (data["friction"].values == friction)
    if start is not None:
        here &= data["lattice_constant"].values == start
    found = np.flatnonzero(here)
    return int(found[0]) if found.size else None


def _linear_range(data: xr.Dataset) -> Figure:
    """Fig. 20, with the lattice (Fig. 6, smoothed alike) beside it, and the ends of the linear ranges."""
    deltas = sorted(set(data["polydispersity"].values.tolist()), reverse=True)
    figure, panels = style.figure(
        1, len(deltas) + 1, width="double", height=2.7, width_ratios=[1.25] * len(deltas) + [1]
    )
    frictions = sorted(set(data["friction"].values.tolist()))
    colours = style.ordered_colours(len(frictions))
    force = data["force"].values
    for column, delta in enumerate(deltas):
        axes = panels[0, column]
        for k, friction in enumerate(frictions):
            path = int(np.flatnonzero((data["polydispersity"] == delta) & (data["friction"] == friction))[0])
            look = {**style.marked_line(k), "color": colours[k], "markersize": 2.6}
            axes.plot(force, data["response_at_centre"].values[path], **look, label=f"{friction:g}")
        axes.set(xscale="log", xlabel="$F_{\\mathrm{ext}}/mg$")
        style.letter(axes, "abc"[column], place="above", text=f"$\\delta = {delta:g}$" if delta else "lattice")
    largest = max(float(np.nanmax(data["response_at_centre"].values)), 0.0)
    for column in range(len(deltas)):
        panels[0, column].set_ylim(0.0, 1.05 * largest)
    panels[0, 0].set_ylabel("$\\sigma_{zz}(x = 0) R / F_{\\mathrm{ext}}$")
    panels[0, len(deltas) - 1].legend(title="$\\mu$", ncols=2, loc="upper right", columnspacing=1.0)
    ends = panels[0, -1]
    for index, delta in enumerate(deltas):
        here = data["polydispersity"].values == delta
        _range_ends(
            ends, data.isel(path=here), style.marked_line(index), f"$\\delta = {delta:g}$" if delta else "lattice"
        )
    ends.set(yscale="log", xlabel="$\\mu$", ylabel="end of the linear range, $F_{\\mathrm{ext}}/mg$")
    ends.legend(loc="lower center", bbox_to_anchor=(0.45, 0.0))
    style.letter(ends, "abc"[len(deltas)], place="above")
    return figure


def _range_ends(axes: Axes, data: xr.Dataset, look: dict[str, Any], name: str) -> None:
    """Brackets of the ends of linear ranges; an arrow upwards where the range ends beyond the largest force."""
    friction, low, high = (data[key].values for key in ("friction", "linear_until", "nonlinear_from"))
    ended = np.isfinite(high)
    middle = np.where(ended, np.sqrt(low * np.where(ended, high, 1.0)), low)
    around = np.abs(np.stack([low, np.where(ended, high, low)]) - middle)
    axes.errorbar(friction, middle, around, capsize=2.0, elinewidth=0.8, label=name, **look)
    for mu, force in zip(friction[~ended], low[~ended], strict=True):
        axes.annotate(
            "",
            (mu, 1.6 * force),
            (mu, force),
            arrowprops={"arrowstyle": "->", "color": look["color"], "linewidth": 0.8},
        )


def _averages(data: xr.Dataset) -> Figure:
    """Fig. 21: a panel for each polydispersity and friction, forces growing from dark to light.

    A number in brackets is that of the realizations at rest, where not all of them are.
    """
    usual = data["lattice_constant"].values[0]
    keep = (data["lattice_constant"].values == usual) & (data["polydispersity"].values > 0.0)
    deltas = sorted(set(data["polydispersity"].values[keep].tolist()))
    frictions = sorted(set(data["friction"].values[keep].tolist()))
    figure, panels = style.figure(
        len(frictions), len(deltas), width="double", height=0.6 + 1.55 * len(frictions), sharex=True
    )
    w = int(np.flatnonzero(data["width"].values == FIG21_WIDTH)[0])
    x = data["x"].values
    for row, friction in enumerate(frictions):
        for column, delta in enumerate(deltas):
            axes = panels[row, column]
            case = _case(data, delta, friction, usual)
            if case is None:
                axes.set_axis_off()
                continue
            _family(axes, data.isel(case=case, width=w), x)
            style.letter(axes, chr(ord("a") + row * len(deltas) + column), text=f"$\\mu = {friction:g}$")
            if row == 0:
                axes.set_title(f"$\\delta = {delta:g}$", pad=4.0)
        panels[row, 0].set_ylabel("$\\sigma_{zz} R / F_{\\mathrm{ext}}$")
    for axes in panels[-1]:
        axes.set_xlabel("$x/R$")
    return figure


def _family(axes: Axes, one: xr.Dataset, x: FloatArray) -> None:
    """Mean responses with bands of one standard error at a few forces of a case."""
    usable = np.flatnonzero((one["count_at_rest"].values >= 2) & np.isfinite(one["force"].values))
    steps = usable[np.unique(np.linspace(0, len(usable) - 1, min(MOST_FORCES, len(usable))).round().astype(int))]
    total = int(
        sum(one[f"count_{name}"].values[usable[0]] for name in ("at_rest", "collapsed", "failed", "not_reached"))
    )
    for k, (step, colour) in enumerate(zip(steps, style.ordered_colours(len(steps)), strict=True)):
        mean, error = one["mean"].values[step], one["standard_error"].values[step]
        count = int(one["count_at_rest"][step])
        label = f"{float(one['force'][step]):g}" + (f" ({count})" if count < total else "")
        axes.fill_between(x, mean - error, mean + error, color=colour, alpha=0.25, linewidth=0.0)
        axes.plot(x, mean, color=colour, linestyle=style.LINE_STYLES[k], linewidth=1.0, label=label)
    axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)
    axes.set_xlim(-45.0, 45.0)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.55 * (high - low))  # room for letter and legend
    axes.legend(loc="upper right", fontsize=7, handlelength=1.6, title="$F_{\\mathrm{ext}}/mg$", title_fontsize=7)


def _packings(data: xr.Dataset, averages: xr.Dataset) -> Figure:
    """Directions of contacts, coordination numbers, and how many packings bear a force."""
    figure, panels = style.figure(1, 3, width="double", height=2.7)
    directions, coordination, bearing = panels[0]
    starts = data["lattice_constant"].values
    usual = starts[0]
    deltas = sorted(set(data["polydispersity"].values.tolist()))
    angle = np.degrees(data["angle"].values)
    literal = [start for start in START_NAMES if start != usual and start in starts]
    for delta, start in [*((delta, usual) for delta in deltas if delta), *((deltas[1], start) for start in literal)]:
        case = _case(data, delta, 0.0, start)
        if case is None:
            continue
        density = np.nanmean(data["contact_angle_density"].values[case], axis=0)
        look = style.line(deltas.index(delta)) if start == usual else {"color": style.BLACK, "linestyle": ":"}
        name = f"$\\delta = {delta:g}$" + ("" if start == usual else ", start $2\\bar R$")
        directions.plot(angle, density, **look, linewidth=1.0, label=name)
    directions.set(
        xlabel="angle to the horizontal (degrees)",
        ylabel="contact directions per radian, $\\mu = 0$",
        xticks=range(0, 181, 60),
        ylim=(0.0, 1.75 * directions.get_ylim()[1]),
    )
    directions.legend(loc="upper right", fontsize=7)
    for index, delta in enumerate(deltas):
        here = np.flatnonzero((data["polydispersity"].values == delta) & (starts == usual))
        here = here[np.argsort(data["friction"].values[here])]
        name = f"$\\delta = {delta:g}$" if delta else "lattice"
        look = style.marked_line(index)
        here = here[np.isfinite(data["coordination_number_bulk"].values[here]).any(axis=1)]
        numbers = data["coordination_number_bulk"].values[here]
        mean, spread = np.nanmean(numbers, axis=1), np.nanstd(numbers, axis=1)
        look |= {"markersize": 3.5, "elinewidth": 0.8, "capsize": 2.0}
        coordination.errorbar(data["friction"].values[here], mean, spread, **look, label=name)
        if delta:
            _bearing(bearing, averages, delta, usual, style.COLOURS[index])
    coordination.set(xlabel="$\\mu = \\mu^{\\mathrm{wall}}$", ylabel="contacts per disk in the bulk")
    coordination.legend(loc="center right", bbox_to_anchor=(1.0, 0.68))
    bearing.set(xlabel="$F_{\\mathrm{ext}}/mg$", ylabel="part of the packings at rest", xscale="log", ylim=(0.4, 1.02))
    bearing.legend(*_friction_key(bearing), loc="lower left", title="$\\mu$", ncols=2, columnspacing=1.0)
    for axes, name in zip(panels[0], "abc", strict=True):
        style.letter(axes, name, place="above")
    return figure


def _bearing(axes: Axes, averages: xr.Dataset, delta: float, start: str, colour: str) -> None:
    """The part of the packings at rest against the force: colour by polydispersity, line style by friction."""
    here = (averages["polydispersity"].values == delta) & (averages["lattice_constant"].values == start)
    cases = np.flatnonzero(here)
    for index, case in enumerate(cases[np.argsort(averages["friction"].values[cases])]):
        one = averages.isel(case=int(case))
        used = np.isfinite(one["force"].values)
        total = sum(one[f"count_{name}"].values[used] for name in ("at_rest", "collapsed", "failed", "not_reached"))
        part = one["count_at_rest"].values[used] / total
        label = f"{float(one['friction']):g}"
        axes.plot(
            one["force"].values[used],
            part,
            color=colour,
            linestyle=style.LINE_STYLES[index],
            linewidth=0.9,
            label=label,
        )


def _friction_key(axes: Axes) -> tuple[list[Line2D], list[str]]:
    """One black line for each friction."""
    names = sorted({str(line.get_label()) for line in axes.get_lines()}, key=float)
    keys = [Line2D([], [], color=style.BLACK, linewidth=0.9, linestyle=style.LINE_STYLES[k]) for k in range(len(names))]
    return keys, names
