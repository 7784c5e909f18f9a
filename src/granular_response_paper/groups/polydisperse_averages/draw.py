"""Figs. 2, 19, 20 and 21: forces in a polydisperse slab, and responses of ensembles of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from granular_response.observe.peaks import central_dip, is_double_peaked
from granular_response.plot import network, style
from granular_response.state import WALL_NORMAL, Box, FloatArray, contact_force
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import (
    DASHED,
    ContactLines,
    banded,
    different,
    family,
    force_key,
    forces,
    grey_limit,
    label_ends,
    material,
    outer,
    packing,
    titles,
    zero,
)
from granular_response_paper.records import alike

from .parameters import Parameters

#: Fig. 21 is smoothed with this width, and shows at most so many forces of a case.
FIG21_WIDTH, MOST_FORCES = 6.0, 4

#: Forces of the keys of Fig. 2 in mean disk weights, under gravity and incremental; incremental force times depth per
#: load that has the full width.
KEYS, DEEP = (20.0, 1.0), 4.0
#: Longest incremental force of Fig. 2(b), as a part of the load: the ones beside the load would hide the disks there.
CLIPPED = 0.5

#: Of the keys over the panels of Fig. 21.
OVER: dict[str, Any] = {
    "loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "fontsize": 7.5, "handlelength": 1.9, "handletextpad": 0.3,
    "columnspacing": 0.7, "borderpad": 0.0, "borderaxespad": 0.2,
}  # fmt: skip

#: Initial lattices; the last is that of the paper's text.
START_NAMES = {
    "2.0075": "lattice constant $2.0075\\bar R$",
    "touching-largest": "largest disks touch",
    "2.0": "lattice constant $2\\bar R$",
}

#: Contacts of a disk without friction at ``delta`` = 0.01 in the paper (Sec. VII).
PAPER_CONTACTS = 4.25


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {
        "fig02_polydisperse_forces": _forces(datasets["forces"]),
        "fig19_disordered_response": _response(datasets["individual"], datasets["averages"]),
        "fig20_disordered_linear_range": _linear_range(datasets["linear_range"], datasets["averages"]),
        "fig21_disordered_forces": _averages(datasets["averages"]),
        "packings": _packings(datasets["packings"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    scene, averages = parameters.scene, datasets["averages"]
    picture, single, linear = parameters.forces_picture, parameters.individual, parameters.linear_range
    disordered = sorted({case.polydispersity for case in parameters.columns if case.polydispersity})
    frictions = sorted({case.friction for case in parameters.columns})
    forces = sorted({force for case in parameters.columns for force in case.forces})
    counts, width = _counts(parameters, disordered), float(averages["width"][smoothed_by(averages)])
    ensemble = of_scene(scene, frictions=frictions, polydispersity=disordered, realizations=counts)
    return of_group(
        "polydisperse_averages",
        {
            "fig02_polydisperse_forces": of_scene(
                scene, force=picture.force, frictions=picture.friction, polydispersity=picture.polydispersity
            ),
            "fig19_disordered_response": of_scene(scene, **single.model_dump()),
            "fig20_disordered_linear_range": of_scene(
                scene,
                force=linear.forces,
                friction=linear.frictions,
                wall_friction=0.0,
                polydispersity=linear.polydispersities,
                realizations=_counts(parameters, linear.polydispersities),
                width=linear.width,
            ),
            "fig21_disordered_forces": ensemble | {"force": forces, "width": width},
            "packings": ensemble,
        },
        clipped=CLIPPED * picture.force,
        tolerance=100.0 * float(datasets["linear_range"].attrs["tolerance"]),
        contacts=PAPER_CONTACTS,
        findings=_findings(datasets),
    )


def _findings(datasets: Datasets) -> dict[str, str]:
    """What the data show, a sentence for each picture."""
    single, averages, packings = (datasets[name] for name in ("individual", "averages", "packings"))
    mean = single["response"].mean("realization").values
    even = zip(single["friction"].values, 0.5 * (mean + mean[:, ::-1]), strict=True)
    dips = [f"{100.0 * central_dip(single['x'].values, one):.2g} % at µ = {friction:g}" for friction, one in even]
    double = []
    for index in _shown(averages).tolist():
        one = averages.isel(case=index, width=smoothed_by(averages))
        usable = _usable(one)
        if usable.size and one["polydispersity"] > 0.0 and one["friction"] > 0.0:
            double.append(is_double_peaked(averages["x"].values, one["mean"].values[usable[0]]))
    data = datasets["linear_range"].sortby("polydispersity")  # the lattice first
    ends = [same["linear_until"].values for same in alike(data, "path", "friction").values()]
    shorter, compared = sum(one[-1] < one[0] for one in ends), sum(len(one) > 1 for one in ends)
    shown = _shown(packings)
    z = np.nanmean(packings["coordination_number_with_walls"].values[shown], axis=1)
    rest, under = _contact_forces(datasets["forces"])
    part = float(np.linalg.norm(under - rest, axis=1).max() / np.linalg.norm(rest, axis=1).max())
    return {
        "fig02_polydisperse_forces": f"The largest incremental force is {part:.2g} times the largest under gravity.",
        "fig19_disordered_response": (
            f"The mean response, both sides made alike, has a central dip of {' and of '.join(dips)}."
        ),
        "fig20_disordered_linear_range": (
            f"The linear range of the disordered slab is shorter than that of the lattice at {shorter} of {compared} "
            "frictions."
        ),
        "fig21_disordered_forces": (
            f"With friction {double.count(False)} of {len(double)} averages have one peak at the smallest force."
        ),
        "packings": f"The coordination number is between {np.nanmin(z):.2f} and {np.nanmax(z):.2f}.",
    }  # fmt: skip


def _counts(parameters: Parameters, polydispersities: Sequence[float]) -> list[int]:
    """Numbers of realizations of the disordered cases from the initial lattice that is shown."""
    shown = [case for case in parameters.columns if case.lattice_constant == parameters.start(case.polydispersity)]
    return sorted({one.realizations for one in shown if one.polydispersity and one.polydispersity in polydispersities})


def _shown(data: xr.Dataset) -> NDArray[np.intp]:
    """The first case of each polydispersity and friction, in this order."""
    pairs = np.stack([data["polydispersity"].values, data["friction"].values])
    return np.unique(pairs, axis=1, return_index=True)[1]


def _forces(data: xr.Dataset) -> Figure:
    """Fig. 2: the slab under gravity, and in the middle third the incremental forces, and these times the depth."""
    figure, panels = style.figure(2, 2, height=4.4, height_ratios=(1.0, 1.6))
    grid = panels[0, 0].get_gridspec()
    for axes in panels[0]:
        axes.remove()
    resting, loaded = _contact_forces(data)
    width, disk, load = float(data["width"]), int(data["loaded_disk"]), float(data["force"][1])
    radius, position = data["radius"].values, data["position"].values
    top = float((position[..., 1] + radius).max())
    x, z = position[1, disk]
    under_gravity, contacts = (ContactLines.of(data, one) for one in position)
    added = loaded - resting
    size = np.linalg.norm(added, axis=1, keepdims=True)
    clipped = added * np.minimum(1.0, CLIPPED * load / np.maximum(size, CLIPPED * load))
    force = style.equals(style.F_EXT, load, style.WEIGHT)
    wide = figure.add_subplot(grid[0, :])
    strongest = float(np.linalg.norm(resting, axis=1).max())
    middle = x - width / 6.0, x + width / 6.0
    drawn = (
        (wide, under_gravity, resting, strongest, KEYS[0], style.WEIGHT, (-1.5, width + 1.5)),
        (panels[1, 0], contacts, clipped, CLIPPED * load, KEYS[1], style.WEIGHT, middle),
        (panels[1, 1], contacts, added * (z - contacts.point[:, 1:]) / load, DEEP, 1.0, style.RADIUS, middle),
    )
    for axes, where, vector, largest, key, unit, limits in drawn:
        state = 0 if axes is wide else 1
        network.draw_disks(axes, position[state], radius, facecolor=style.DISKS, edgecolor="none")
        marks = {"color": "white", "linewidth": 0.4 if axes is wide else 0.9, "zorder": 1.5}
        network.draw_rotations(axes, position[state], radius, data["angle"].values[state], **marks)
        network.draw_box(axes, Box(width), top)
        forces(axes, where, vector, largest)
        force_key(axes, (limits[1] - 0.08 * width, top + 2.8), key, largest, unit)
        style.no_axes(axes)
        axes.set(xlim=limits, ylim=(-2.4, top + 4.0))
        if state:
            network.draw_loaded_disk(axes, (x, z), float(radius[disk]))
            network.draw_load(axes, (x, z + radius[disk]), length=3.6)
            axes.set(xlim=limits)
    times_depth = rf"incremental, $|\,\mathbf{{f}}\,|\,z/{style.F_EXT}$"
    titles((wide, *panels[1]), ("under gravity", f"incremental, {force}, middle third", times_depth))
    return figure


def _contact_forces(data: xr.Dataset) -> FloatArray:
    """(state, m, 2) forces on the first disks of all contacts, then those of the walls."""
    position = data["position"].values
    between = position[:, data["contact_disk"].values] - position[:, data["contact_partner"].values]
    normals = {
        "contact": between / np.linalg.norm(between, axis=-1, keepdims=True),
        "wall": WALL_NORMAL[data["wall_index"].values.astype(int)],
    }
    forces = [
        contact_force(normal, data[f"{kind}_normal_force"].values, data[f"{kind}_tangential_force"].values)
        for kind, normal in normals.items()
    ]
    return np.concatenate(forces, axis=1)


def _response(data: xr.Dataset, averages: xr.Dataset) -> Figure:
    """Fig. 19: every realization thin, the mean thick in a band of its standard error; a row for each start."""
    frictions = different(data["friction"])
    starts = [name for name in START_NAMES if name in data["lattice_constant"].values]
    figure, panels = style.figure(
        len(starts), len(frictions), height=0.5 + 1.95 * len(starts), sharex=True, sharey="col"
    )
    x = data["x"].values
    for row, start in enumerate(starts):
        for column, friction in enumerate(frictions):
            axes = panels[row, column]
            case = _case(data, float(data["polydispersity"][0]), friction, start)
            rows = data["response"].isel(case=case).dropna("realization").values
            mean, error = rows.mean(axis=0), rows.std(axis=0, ddof=1) / np.sqrt(len(rows))
            _elastic(axes, averages, float(data["width"]))
            axes.plot(x, rows.T, color="#909090", linewidth=0.4, linestyle="-")
            axes.plot(x, mean, color=style.BLACK, linewidth=1.4, linestyle="-", zorder=3)
            even = 0.5 * (mean + mean[::-1])
            axes.plot(x, even, color=style.BLUE, linewidth=1.1, linestyle=DASHED, zorder=3.5, label="mean, sides alike")
            if not (row or column):
                axes.legend(loc="upper right", fontsize=7)
            axes.fill_between(x, mean - error, mean + error, color=style.VERMILION, linewidth=0.0, zorder=2.5)
            zero(axes)
            name = f"$\\mu = {friction:g}$, {START_NAMES[start]}, {len(rows)} realizations"
            style.letter(axes, "abcdefgh"[len(frictions) * row + column], place="above", text=name)
    panels[0, 0].set_xlim(x[0], x[-1])
    outer(panels, style.POSITION, style.FLOOR_STRESS)
    return figure


def _elastic(axes: Axes, averages: xr.Dataset, width: float) -> None:
    """The response of the lattice with the largest friction to its smallest force, smoothed alike, behind others."""
    lattice = np.flatnonzero(averages["polydispersity"].values == 0.0)
    case = int(lattice[np.argmax(averages["friction"].values[lattice])])
    grey_limit(axes, averages["x"].values, averages["mean"].sel(width=width).values[case, 0])


def _case(data: xr.Dataset, polydispersity: float, friction: float, start: str | None = None) -> int | None:
    """The case with these values, if there is one; ``start`` None is that of the first."""
    here = (data["polydispersity"].values == polydispersity) & (data["friction"].values == friction)
    if start is not None:
        here &= data["lattice_constant"].values == start
    return int(np.argmax(here)) if here.any() else None


def _linear_range(data: xr.Dataset, averages: xr.Dataset) -> Figure:
    """Fig. 20: one packing and the lattice, smoothed alike, and the ends of their linear ranges."""
    deltas, frictions = different(data["polydispersity"])[::-1], different(data["friction"])
    looks = {friction: look | {"markersize": 3.0} for friction, look in family(frictions, of="friction")}
    wide = [1.0] * len(deltas) + [1.2]
    figure, panels = style.figure(1, len(deltas) + 1, height=3.1, width_ratios=wide)
    *responses, ends = panels[0]
    for axes, delta in zip(responses, deltas, strict=True):
        for friction in frictions:
            response = data["response_at_centre"].values[_case(data, delta, friction)]
            axes.plot(data["force"], response, **looks[friction])
    largest = 1.05 * max(line.get_ydata().max() for axes in responses for line in axes.get_lines())
    smallest = float(data["force"].min())
    for axes, delta in zip(responses, deltas, strict=True):
        axes.set(xscale="log", xlabel=style.FORCE, ylim=(0.0, 1.1 * largest), xlim=(0.3 * smallest, 1200.0))
        starts = []
        for friction in frictions:
            known = data["response_at_centre"].values[_case(data, delta, friction)]
            last = int(np.flatnonzero(np.isfinite(known))[-1])
            end = float(data["force"][last]), float(known[last])
            starts.append((f"{friction:g}", *end, looks[friction]["color"]))
        label_ends(axes, starts)
        text = f"numbers: ${style.FRICTION}$"
        axes.text(0.97, 0.97, text, transform=axes.transAxes, ha="right", va="top", fontsize=8)
    # what the packing stands beside without friction, where walls are smooth in both: mean and standard deviation of
    # the response to the smallest force over the packings of Fig. 21, smoothed as it is
    beside = averages.isel(case=_case(averages, deltas[0], 0.0), step=0).sel(width=data.attrs["width"], x=0.0)
    spread = float(beside["standard_error"]) * float(np.sqrt(int(beside["count_at_rest"])))
    bar = {"color": style.MUTED, "marker": "_", "markersize": 8.0, "capsize": 2.5, "elinewidth": 1.0}
    responses[0].errorbar([0.5 * smallest], [float(beside["mean"])], [spread], **bar)
    for axes in responses[1:]:
        axes.tick_params(labelleft=False)
    responses[0].set_ylabel(f"{style.FLOOR_STRESS} at $x = 0$")
    titles(panels[0], [*map(packing, deltas), "ends of the linear ranges"])
    for delta, look in family(deltas[::-1], of="polydispersity"):
        _range_ends(ends, data.isel(path=data["polydispersity"].values == delta), look, packing(delta))
    ends.set(yscale="log", xlabel=f"${style.FRICTION}$", ylabel=f"end of the linear range, {style.FORCE}")
    ends.legend(loc="lower center", bbox_to_anchor=(0.45, 0.0))
    return figure


def smoothed_by(averages: xr.Dataset) -> int:
    """Index of the width that is that of Fig. 21, or nearest to it."""
    return int(np.abs(averages["width"].values - FIG21_WIDTH).argmin())


def _range_ends(axes: Axes, data: xr.Dataset, look: dict[str, Any], name: str) -> None:
    """Brackets of the ends of linear ranges; an arrow upwards where the range ends beyond the largest force."""
    friction, low, high = (data[key].values for key in ("friction", "linear_until", "nonlinear_from"))
    ended = np.isfinite(high)
    middle = np.where(ended, np.sqrt(low * np.where(ended, high, 1.0)), low)
    around = np.abs(np.stack([low, np.where(ended, high, low)]) - middle)
    axes.errorbar(friction, middle, around, capsize=2.0, elinewidth=0.8, label=name, **look)
    arrow = {"arrowstyle": "->", "color": look["color"], "linewidth": 0.8}
    for mu, force in zip(friction[~ended], low[~ended], strict=True):
        axes.annotate("", (mu, 1.6 * force), (mu, force), arrowprops=arrow)


def _averages(data: xr.Dataset) -> Figure:
    """Fig. 21: a panel for each polydispersity and friction, one scale in each row, forces from dark to light."""
    disordered = data.isel(case=data["polydispersity"].values > 0.0)
    deltas, frictions = different(disordered["polydispersity"]), different(disordered["friction"])
    figure, panels = style.figure(len(frictions), len(deltas), height=0.5 + 1.35 * len(frictions), sharex=True)
    w = smoothed_by(data)
    x = data["x"].values
    for row, friction in enumerate(frictions):
        for column, delta in enumerate(deltas):
            axes = panels[row, column]
            case = _case(data, delta, friction)
            if case is None:
                axes.set_axis_off()
                continue
            _elastic(axes, data, float(data["width"][w]))
            _family(axes, data.isel(case=case, width=w), x)
            letter = chr(ord("a") + row * len(deltas) + column)
            style.letter(axes, letter, text=material(delta, friction).replace(", ", "\n      "))
        limits = np.array([axes.get_ylim() for axes in panels[row] if axes.axison])
        for axes, (low, high) in zip([axes for axes in panels[row] if axes.axison], limits, strict=True):
            # without friction the scatter of the widest disorder would flatten the others
            axes.set_ylim(*((low, 1.3 * high) if friction == 0.0 else (limits.min(), 1.3 * limits.max())))
    panels[0, 0].set_xlim(-45.0, 45.0)
    for axes in panels[-1]:
        axes.set_xlabel(style.POSITION)
    figure.supylabel(style.FLOOR_STRESS, fontsize=9)
    return figure


def _usable(one: xr.Dataset) -> NDArray[np.intp]:
    """The forces of a case that have a mean with an error."""
    return np.flatnonzero((one["count_at_rest"].values >= 2) & np.isfinite(one["force"].values))


def _family(axes: Axes, one: xr.Dataset, x: FloatArray) -> None:
    """Mean responses with bands of one standard error at a few forces of a case; their key stands over the panel."""
    usable = _usable(one)
    steps = usable[np.unique(np.linspace(0, len(usable) - 1, min(MOST_FORCES, len(usable))).round().astype(int))]
    if not usable.size:
        return
    total = int(one["realizations"])
    for step, look in family(steps, of="force", marked=False, dashed=True):
        mean, error = one["mean"].values[step], one["standard_error"].values[step]
        count = int(one["count_at_rest"][step])
        label = f"{float(one['force'][step]):g}" + (f" ({count})" if count < total else "")
        banded(axes, x, mean, (mean - error, mean + error), look | {"linewidth": 1.1}, alpha=0.25, label=label)
    zero(axes)
    handles, names = axes.get_legend_handles_labels()
    axes.legend(handles[-len(steps) :], names[-len(steps) :], ncols=len(steps), **OVER)


def _packings(data: xr.Dataset) -> Figure:
    """Directions of contacts, and coordination numbers."""
    shown = _shown(data)
    deltas = different(data["polydispersity"])
    colours = dict(zip(deltas, style.ordered_colours(len(deltas), of="polydispersity"), strict=True))
    disordered = [delta for delta in deltas if delta]
    figure, panels = style.figure(2, max(len(disordered), 2), height=4.6)
    grid = panels[0, 0].get_gridspec()
    for axes in panels.flat:
        axes.remove()
    roses = [figure.add_subplot(grid[0, k], projection="polar") for k in range(len(disordered))]
    for axes, delta in zip(roses, disordered, strict=True):
        _rose(axes, data, delta, colours[delta])
    coordination = figure.add_subplot(grid[1, :])
    ends, counted = [], data["coordination_number_with_walls"].values
    for delta, look in family(deltas, of="polydispersity"):
        here = shown[data["polydispersity"].values[shown] == delta]
        here = here[np.isfinite(counted[here]).any(axis=1)]
        numbers, friction = counted[here], data["friction"].values[here]
        mean, spread = np.nanmean(numbers, axis=1), np.nanstd(numbers, axis=1)
        coordination.errorbar(friction, mean, spread, **look, elinewidth=0.8, capsize=2.0)
        ends += [(packing(delta), float(friction[-1]), float(mean[-1]), look["color"])] if here.size else []
    coordination.set(xlabel=f"${style.BOTH_FRICTIONS}$", ylabel="coordination number $z$, with walls")
    coordination.set_xlim(right=1.18)
    paper = rf"paper: {PAPER_CONTACTS:g} at $\delta = 0.01$, $\mu = 0$"
    style.paper_value(coordination, PAPER_CONTACTS, paper, along="y")
    label_ends(coordination, ends)
    titles((*roses, coordination), [*map(packing, disordered), ""])
    return figure


def _rose(axes: Axes, data: xr.Dataset, delta: float, colour: str) -> None:
    """The distribution of the directions of contacts without friction over the full turn, a wedge for each bin."""
    case = _case(data, delta, 0.0)
    if case is not None:
        density = np.nanmean(data["contact_angle_density"].values[case], axis=0)
        angle = np.concatenate([data["angle"].values, np.pi + data["angle"].values])
        axes.bar(angle, np.tile(density, 2), width=np.pi / len(density), color=colour, edgecolor="white", linewidth=0.3)
    axes.set_xticks(np.radians(range(0, 360, 60)))
    axes.tick_params(labelsize=7, pad=-2.0)
    axes.yaxis.set_major_locator(MaxNLocator(3))
    axes.grid(color=style.FAINT, linewidth=0.4)
