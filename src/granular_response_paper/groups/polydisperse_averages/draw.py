"""Figs. 2, 19, 20 and 21: forces in a polydisperse slab, and responses of ensembles of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response.state import WALL_NORMAL, Box, FloatArray, contact_force
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import family, material, packing, titles, zero

from .parameters import Parameters

#: Fig. 21 is smoothed with this width, and shows at most so many forces of a case.
FIG21_WIDTH, MOST_FORCES = 6.0, 4

#: Forces of the keys of Fig. 2 in mean disk weights, at rest and added: both are drawn as the same line.
KEYS = 20.0, 2.0

START_NAMES = {"touching-largest": "largest disks touch", "2.0": "lattice constant $2\\bar R$"}

#: Contacts of a disk without friction at ``delta`` = 0.01 in the paper (Sec. VII).
PAPER_CONTACTS = 4.25


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig02_polydisperse_forces``, ``fig19_disordered_response``, ``fig20_disordered_linear_range``,
    ``fig21_disordered_forces`` and ``packings`` from the datasets of the study of the same name."""
    return {
        "fig02_polydisperse_forces": _forces(datasets["forces"]),
        "fig19_disordered_response": _response(datasets["individual"]),
        "fig20_disordered_linear_range": _linear_range(datasets["linear_range"], datasets["averages"]),
        "fig21_disordered_forces": _averages(datasets["averages"]),
        "packings": _packings(datasets["packings"], datasets["averages"]),
    }


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    scene, averages = parameters.scene, datasets["averages"]
    picture, single, linear = parameters.forces_picture, parameters.individual, parameters.linear_range
    disordered = sorted({case.polydispersity for case in parameters.columns if case.polydispersity})
    frictions = sorted({case.friction for case in parameters.columns})
    forces = sorted({force for case in parameters.columns for force in case.forces})
    ensemble = of_scene(
        scene, frictions=frictions, polydispersity=disordered, realizations=_counts(parameters, disordered)
    )
    return of_group(
        "polydisperse_averages",
        {
            "fig02_polydisperse_forces": of_scene(
                scene, force=picture.force, frictions=picture.friction, polydispersity=picture.polydispersity
            ),
            "fig19_disordered_response": of_scene(
                scene,
                force=single.force,
                frictions=single.frictions,
                polydispersity=single.polydispersity,
                realizations=single.realizations,
                width=single.width,
            ),
            "fig20_disordered_linear_range": of_scene(
                scene,
                force=linear.forces,
                friction=linear.frictions,
                wall_friction=0.0,
                polydispersity=linear.polydispersities,
                realizations=_counts(parameters, linear.polydispersities),
                width=linear.width,
            ),
            "fig21_disordered_forces": {
                **ensemble,
                "force": forces,
                "width": float(averages["width"].values[smoothed_by(averages)]),
            },
            "packings": ensemble,
        },
        keys=KEYS,
        tolerance=100.0 * float(datasets["linear_range"].attrs["tolerance"]),
        last=chr(ord("a") - 1 + len(disordered) * len(frictions)),
        contacts=PAPER_CONTACTS,
    )


def _counts(parameters: Parameters, polydispersities: Sequence[float]) -> list[int]:
    """Numbers of realizations of the disordered cases from the usual initial lattice."""
    usual = [case for case in parameters.columns if case.lattice_constant == parameters.lattice_constant]
    return sorted(
        {case.realizations for case in usual if case.polydispersity and case.polydispersity in polydispersities}
    )


def _forces(data: xr.Dataset) -> Figure:
    """Fig. 2: at rest, and what the load adds; the line of the key is the same, the force that it stands for is not."""
    figure, panels = style.figure(2, 1, width="double", height=3.75)
    pair, wall = _contact_forces(data)
    width, disk = float(data["width"]), int(data["loaded_disk"])
    force = float(data["force"][1])
    radius = data["radius"].values
    top = float((data["position"].values[..., 1] + radius).max())
    at_rest = network.force_scale(pair[0], wall[0], longest=3.8, widest=4.2)
    for index, axes in enumerate(panels[:, 0]):
        scale = {name: KEYS[0] / KEYS[index] * per_force for name, per_force in at_rest.items()}
        position = data["position"].values[index]
        shown = (pair[0], wall[0]) if index == 0 else (pair[1] - pair[0], wall[1] - wall[0])
        network.draw_disks(axes, position, radius)
        network.draw_rotations(axes, position, radius, data["angle"].values[index], color=style.SKY, linewidth=0.5)
        network.draw_box(axes, Box(width), top)
        pairs = data["contact_disk"].values, data["contact_partner"].values
        network.draw_force_chains(axes, network.pair_points(position, radius, *pairs), shown[0], **scale)
        at_wall = network.wall_points(position, radius, data["wall_disk"].values, data["wall_index"].values)
        network.draw_force_chains(axes, at_wall, shown[1], **scale)
        name = "at rest under gravity" if index == 0 else f"added by {style.equals(style.F_EXT, force, style.WEIGHT)}"
        style.letter(axes, "ab"[index], place="above", text=name)
        network.draw_force_key(axes, (width - 14.0, top + 2.8), KEYS[index], **scale)
        style.no_axes(axes)
        axes.set(xlim=(-1.5, width + 1.5), ylim=(-1.5, top + 4.0))
    x, z = data["position"].values[1, disk] + [0.0, radius[disk]]
    network.draw_loaded_disk(panels[1, 0], (x, z - radius[disk]), float(radius[disk]))
    network.draw_load(panels[1, 0], (x, z), length=3.6)
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
    """Fig. 19: every realization thin, the mean thick in a band of its standard error; a row for each start."""
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
            mean, error = rows.mean(axis=0), rows.std(axis=0, ddof=1) / np.sqrt(len(rows))
            axes.plot(x, rows.T, color="#BDBDBD", linewidth=0.5, linestyle="-")
            axes.plot(x, mean, color=style.BLACK, linewidth=1.4, linestyle="-", zorder=3)
            axes.fill_between(x, mean - error, mean + error, color=style.VERMILION, linewidth=0.0, zorder=2.5)
            zero(axes)
            name = f"$\\mu = {friction:g}$, {START_NAMES[start]}, {len(rows)} realizations"
            style.letter(axes, "abcdefgh"[len(frictions) * row + column], place="above", text=name)
        panels[row, 0].set_ylabel(style.FLOOR_STRESS)
    for axes in panels[-1]:
        axes.set(xlabel=style.POSITION, xlim=(x[0], x[-1]))
    return figure


def _case(data: xr.Dataset, polydispersity: float, friction: float, start: str | None = None) -> int | None:
    """The case with these values, if there is one; ``start`` None is any."""
    here = (data["polydispersity"].values == polydispersity) & (data["friction"].values == friction)
    if start is not None:
        here &= data["lattice_constant"].values == start
    found = np.flatnonzero(here)
    return int(found[0]) if found.size else None


def _linear_range(data: xr.Dataset, averages: xr.Dataset) -> Figure:
    """Fig. 20: one packing, the means of all, the lattice, smoothed alike, and the ends of the linear ranges."""
    deltas = sorted(set(data["polydispersity"].values.tolist()), reverse=True)
    frictions = sorted(set(data["friction"].values.tolist()))
    looks = {friction: look | {"markersize": 3.0} for friction, look in family(frictions, of="friction")}
    figure, panels = style.figure(1, len(deltas) + 2, width="double", height=3.0)
    one, means, *others = panels[0]
    responses = [one, *others[:-1]]
    for axes, delta in zip(responses, deltas, strict=True):
        for friction in frictions:
            path = int(np.flatnonzero((data["polydispersity"] == delta) & (data["friction"] == friction))[0])
            response = data["response_at_centre"].values[path]
            axes.plot(data["force"], response, **looks[friction], label=f"$\\mu = {friction:g}$")
    _central_means(means, averages, deltas[0], float(data.attrs["width"]), looks)
    largest = 1.05 * max(line.get_ydata().max() for axes in (*responses, means) for line in axes.get_lines())
    for axes in (*responses, means):
        axes.set(xscale="log", xlabel=style.FORCE, ylim=(0.0, largest), xlim=(0.04, 600.0))
    for axes in (means, *others[:-1]):
        axes.tick_params(labelleft=False)
    one.set_ylabel(f"{style.FLOOR_STRESS} at $x = 0$")
    names = list(map(packing, deltas))
    titles(panels[0], [f"{names[0]}, one packing", f"{names[0]}, rough walls", *names[1:], ""])
    ends = others[-1]
    for index, (delta, name) in enumerate(zip(deltas, names, strict=True)):
        here = data["polydispersity"].values == delta
        _range_ends(ends, data.isel(path=here), style.marked_line(index), name)
    ends.set(yscale="log", xlabel="$\\mu$", ylabel=f"end of the linear range, {style.FORCE}")
    ends.legend(loc="lower center", bbox_to_anchor=(0.45, 0.0))
    figure.legend(*one.get_legend_handles_labels(), loc="outside upper center", ncols=len(frictions))
    return figure


def smoothed_by(averages: xr.Dataset) -> int:
    """Index of the width that is that of Fig. 21, or nearest to it."""
    return int(np.abs(averages["width"].values - FIG21_WIDTH).argmin())


def _central_means(
    axes: Axes, averages: xr.Dataset, delta: float, width: float, looks: Mapping[float, dict[str, Any]]
) -> None:
    """Mean responses at x = 0 with their standard errors, of the cases that have one of the frictions of ``looks``."""
    same = np.flatnonzero(averages["width"].values == width)
    if not same.size:  # the averages are smoothed otherwise
        return
    smoothed = averages.isel(width=int(same[0]))
    for friction, look in looks.items():
        case = _case(averages, delta, friction, str(averages["lattice_constant"].values[0]))
        if case is None:
            continue
        one = smoothed.isel(case=case)
        force, known = one["force"].values, one["count_at_rest"].values >= 2
        at = one.sel(x=0.0)
        mean, error = at["mean"].values[known], at["standard_error"].values[known]
        axes.errorbar(force[known], mean, error, elinewidth=0.8, capsize=1.5, **look)


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
    """Fig. 21: a panel for each polydispersity and friction, all on one scale, forces growing from dark to light.

    A number in brackets is that of the realizations at rest, where not all of them are.
    """
    usual = data["lattice_constant"].values[0]
    keep = (data["lattice_constant"].values == usual) & (data["polydispersity"].values > 0.0)
    deltas = sorted(set(data["polydispersity"].values[keep].tolist()))
    frictions = sorted(set(data["friction"].values[keep].tolist()))
    figure, panels = style.figure(
        len(frictions), len(deltas), width="double", height=0.5 + 1.65 * len(frictions), sharex=True, sharey=True
    )
    w = smoothed_by(data)
    x = data["x"].values
    for row, friction in enumerate(frictions):
        for column, delta in enumerate(deltas):
            axes = panels[row, column]
            case = _case(data, delta, friction, usual)
            if case is None:
                axes.set_axis_off()
                continue
            _family(axes, data.isel(case=case, width=w), x)
            letter = chr(ord("a") + row * len(deltas) + column)
            style.letter(axes, letter, text=material(delta, friction))
        panels[row, 0].set_ylabel(style.FLOOR_STRESS)
    for axes in panels[-1]:
        axes.set(xlabel=style.POSITION, xlim=(-45.0, 45.0))
    note = f"over each panel: {style.FORCE}, in brackets the packings at rest where some collapsed"
    figure.suptitle(note, fontsize=8)
    return figure


def _family(axes: Axes, one: xr.Dataset, x: FloatArray) -> None:
    """Mean responses with bands of one standard error at a few forces of a case; their key stands over the panel."""
    usable = np.flatnonzero((one["count_at_rest"].values >= 2) & np.isfinite(one["force"].values))
    steps = usable[np.unique(np.linspace(0, len(usable) - 1, min(MOST_FORCES, len(usable))).round().astype(int))]
    if not usable.size:
        return
    total = int(_realizations(one)[usable[0]])
    for step, look in family(steps, of="force", marked=False, dashed=True):
        mean, error = one["mean"].values[step], one["standard_error"].values[step]
        count = int(one["count_at_rest"][step])
        label = f"{float(one['force'][step]):g}" + (f" ({count})" if count < total else "")
        axes.fill_between(x, mean - error, mean + error, color=look["color"], alpha=0.25, linewidth=0.0)
        axes.plot(x, mean, **look, linewidth=1.1, label=label)
    zero(axes)
    axes.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=len(steps),
        fontsize=7.5,
        handlelength=1.9,
        handletextpad=0.3,
        columnspacing=0.7,
        borderpad=0.0,
        borderaxespad=0.2,
    )


def _realizations(one: xr.Dataset) -> np.ndarray:
    """(step,) how many a case has, whatever became of them."""
    outcomes = ("at_rest", "collapsed", "failed", "not_reached")
    return np.sum([one[f"count_{name}"].values for name in outcomes], axis=0)


def _packings(data: xr.Dataset, averages: xr.Dataset) -> Figure:
    """Directions of contacts, coordination numbers, and how many packings bear a force."""
    figure, panels = style.figure(1, 3, width="double", height=3.0)
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
        look = style.line(deltas.index(delta)) if start == usual else {"color": style.BLACK, "linestyle": "-"}
        name = packing(delta) + ("" if start == usual else ", start $2\\bar R$")
        directions.plot(angle, density, **{**look, "linewidth": 1.0}, label=name)
    directions.set(
        xlabel="angle to the horizontal (degrees)",
        ylabel="contact directions per radian, $\\mu = 0$",
        xticks=range(0, 181, 60),
        ylim=(0.0, None),
    )
    directions.legend(loc="lower center", bbox_to_anchor=(0.5, 1.08), ncols=2, fontsize=7.5, columnspacing=1.0)
    for index, delta in enumerate(deltas):
        here = np.flatnonzero((data["polydispersity"].values == delta) & (starts == usual))
        here = here[np.argsort(data["friction"].values[here])]
        look = style.marked_line(index)
        here = here[np.isfinite(data["coordination_number_bulk"].values[here]).any(axis=1)]
        numbers = data["coordination_number_bulk"].values[here]
        mean, spread = np.nanmean(numbers, axis=1), np.nanstd(numbers, axis=1)
        look |= {"markersize": 3.5, "elinewidth": 0.8, "capsize": 2.0}
        coordination.errorbar(data["friction"].values[here], mean, spread, **look, label=packing(delta))
    coordination.set(xlabel=f"${style.BOTH_FRICTIONS}$", ylabel="coordination number $z$ in the bulk")
    paper = rf"paper: {PAPER_CONTACTS:g} at $\delta = 0.01$, $\mu = 0$"
    style.paper_value(coordination, PAPER_CONTACTS, paper, along="y")
    coordination.legend(loc="lower center", bbox_to_anchor=(0.5, 1.08), ncols=2, fontsize=7.5, columnspacing=1.0)
    _bearing(bearing, averages.isel(case=np.flatnonzero(averages["lattice_constant"].values == usual)), deltas)
    bearing.set(xlabel=style.FORCE, ylabel="fraction of stable packings", xscale="log", ylim=(0.0, 1.05))
    bearing.legend(loc="lower center", bbox_to_anchor=(0.5, 1.08), ncols=2, fontsize=7.5, columnspacing=1.0)
    style.letters(panels, place="above")
    return figure


def _bearing(axes: Axes, averages: xr.Dataset, deltas: list[float]) -> None:
    """The part of the packings at rest against the force with its standard error, where some of them collapse."""
    number = 0
    for case in np.lexsort((averages["friction"].values, averages["polydispersity"].values)):
        one = averages.isel(case=int(case))
        used = np.isfinite(one["force"].values)
        at_rest = one["count_at_rest"].values[used]
        total = _realizations(one)[used]
        if np.all(at_rest == total):
            continue
        delta, friction = float(one["polydispersity"]), float(one["friction"])
        look = {**style.marked_line(number), "color": style.COLOURS[deltas.index(delta)], "markersize": 4.0}
        look |= {"markeredgewidth": 0.8, "markerfacecolor": "white", "elinewidth": 0.8, "capsize": 1.5}
        part = at_rest / total
        error = np.sqrt(part * (1.0 - part) / total)
        axes.errorbar(one["force"].values[used], part, error, **look, label=material(delta, friction))
        number += 1
