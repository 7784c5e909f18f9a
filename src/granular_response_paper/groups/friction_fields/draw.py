"""Figs. 13 to 15: force chains, vertical stress and force magnitudes in a slab with and without friction."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.special import erfc

from granular_response.plot import network, style
from granular_response.plot.field import draw_field, root_norm
from granular_response.state import Box, FloatArray
from granular_response_paper.captions import RADIUS, Caption, Datasets, of_group, of_scene, values
from granular_response_paper.panels import ContactLines, added_forces, family, force_key, forces, note, outer, titles

from .parameters import Parameters

#: Half of the width of the stress maps and of the profiles, in mean radii.
MAP_HALF_WIDTH, PROFILE_HALF_WIDTH = 30.0, 20.0
#: Lengths of the largest forces of Fig. 13 in mean radii, above and below, and what has it below: force times depth per
#: load.
LONGEST, LONGEST_DEEP, DEEP = 6.0, 4.0, 2.0
#: Height of the largest force of the profiles, per least distance of two depths.
HIGHEST = 2.2
#: Mean radii from the load within which the directions of forces are averaged.
NEAR_LOAD = 15.0
#: Contours of the stress maps, per largest stress.
LEVELS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7)
#: Contours of the differences, of both signs, per largest difference.
DIFFERENCE_LEVELS = (0.05, 0.3)


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {
        "fig13_force_chains": _force_chains(datasets["forces"]),
        "fig14_vertical_stress": _vertical_stress(datasets["stress"]),
        "fig15_force_profiles": _force_profiles(datasets["profiles"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    scene, profiles = parameters.scene, parameters.profiles
    given = of_scene(scene, force=parameters.force, frictions=parameters.frictions)
    return of_group(
        "friction_fields",
        {
            "fig13_force_chains": given,
            "fig14_vertical_stress": {**given, "width": parameters.stress_width},
            "fig15_force_profiles": of_scene(scene, force=profiles.force, frictions=profiles.frictions),
        },
        _findings(datasets),
        levels=LEVELS,
    )


def _findings(datasets: Datasets) -> dict[str, str]:
    """What the data show, a sentence for each picture."""
    data, stress, profiles = datasets["forces"], datasets["stress"], datasets["profiles"]
    turned = []
    for index, position in enumerate(data["position"].values):
        vector, point = data["contact_added_force"].values[index], ContactLines.of(data, position).point
        size = np.linalg.norm(vector, axis=1)
        centre = position[int(data["loaded_disk"])]
        near = np.linalg.norm(point[: len(size)] - centre, axis=1) < NEAR_LOAD
        angle = np.degrees(np.arctan2(np.abs(vector[near, 0]), np.abs(vector[near, 1])))
        turned.append(float(np.average(angle, weights=size[near])) if size[near].any() else np.nan)
    off = np.abs(stress["stress_zz"].values - stress["stress_zz_lattice"].values).max(axis=(-2, -1))
    off = off / float(stress["stress_zz_lattice"].max())
    frictions = f"at µ = {values(stress['friction'].values.tolist())}"
    widest = []
    for column in range(profiles.sizes["friction"]):
        deepest = int(np.argmax(profiles["depth"].values))
        x, size = (profiles[name].values[column, deepest] for name in ("contact_x", "magnitude"))
        known = np.isfinite(x) & np.isfinite(size)
        widest.append(abs(float(x[known][np.argmax(size[known])])) if known.any() else np.nan)
    return {
        "fig13_force_chains": "The mean direction of the forces near the load is "
        + values([f"{angle:.0f}°" for angle in turned])
        + f" off the vertical, {frictions}.",
        "fig14_vertical_stress": "The largest difference from the isotropic lattice is "
        + values([f"{100.0 * part:.2g} %" for part in off])
        + f" of its largest stress, {frictions}.",
        "fig15_force_profiles": "At the largest depth the largest force is "
        + values([f"{place:.0f} {RADIUS}" for place in widest])
        + f" from the middle, at µ = {values(profiles['friction'].values.tolist())}.",
    }


def _force_chains(data: xr.Dataset) -> Figure:
    """The central third of the slab: the forces, and below them the forces times depth, which undoes their decay."""
    frictions = data["friction"].values
    figure, panels = style.figure(2, len(frictions), height=4.2)
    width, disk, load = float(data["width"]), int(data["loaded_disk"]), float(data["force"])
    radius = data["radius"].values
    added, strongest = added_forces(data)
    for index, position in enumerate(data["position"].values):
        contacts = ContactLines.of(data, position)
        x, z = position[disk]
        inside = np.abs(position[:, 0] - 0.5 * width) <= width / 6.0 + 1.0
        near = np.abs(contacts.point[:, 0] - 0.5 * width) <= width / 6.0 + 1.0
        deep = added[index] * (z - contacts.point[:, 1:]) / load
        for axes, vector, largest, key, unit, longest in (
            (panels[0, index], added[index], strongest, _round(load / 5.0), style.WEIGHT, LONGEST),
            (panels[1, index], deep, DEEP, 0.5, style.RADIUS, LONGEST_DEEP),
        ):
            network.draw_disks(axes, position[inside], radius[inside], facecolor=style.DISKS, edgecolor="none")
            forces(axes, contacts, vector, largest, shown=near, longest=longest)
            slab = Rectangle((0.0, 0.0), width, 2.0 * z, transform=axes.transData)
            for lines in axes.collections:
                lines.set_clip_path(slab)  # below, forces times depth would stick out of the floor
                lines.set_in_layout(False)
            force_key(axes, (2.0 * width / 3.0 - 8.0, z + 3.0), key, largest, unit, longest=longest)
            network.draw_loaded_disk(axes, (x, z), float(radius[disk]))
            network.draw_load(axes, (x, z + 1.0))
            network.draw_box(axes, Box(width), z, between=(width / 3.0, 2.0 * width / 3.0))
            style.no_axes(axes)
            axes.set(xlim=(width / 3.0, 2.0 * width / 3.0), ylim=(-2.4, z + 5.2))
    names = list(map(_friction, frictions))
    titles(panels.flat, [*names, *(rf"{name}, $|\,\mathbf{{f}}\,|\,z/{style.F_EXT}$" for name in names)])
    return figure


def _vertical_stress(data: xr.Dataset) -> Figure:
    """Maps on one scale, the harmonic lattice last, and beside them how far they are off it."""
    x, z = data["x"].values, data["z"].values
    lattice = to_floor(data["stress_zz_lattice"].values, z, float(data["stress_width"]))
    fields = to_floor(data["stress_zz"].values, z, float(data["stress_width"]))
    names = list(map(_friction, data["friction"].values))
    rows = len(names) + 1
    figure, panels = style.figure(rows, 2, height=1.5 * rows + 0.3, sharex=True, sharey=True)
    half = min(MAP_HALF_WIDTH, float(x.max()))
    largest = float(max(fields.max(), lattice.max()))
    furthest = float(np.abs(fields - lattice)[..., np.abs(x) <= half].max())
    norm, signed = root_norm(largest), root_norm(furthest, signed=True)
    for axes, field in zip(panels[:, 0], [lattice, *fields], strict=True):
        image = draw_field(axes, x, z, np.clip(field, 0.0, None), norm=norm, levels=largest * np.array(LEVELS))
    levels = sorted(sign * level * furthest for sign in (-1.0, 1.0) for level in DIFFERENCE_LEVELS)
    for axes, off in zip(panels[1:, 1], fields - lattice, strict=True):
        # white where there is no difference; lines tell the sign without colours, broken where it is negative
        change = draw_field(axes, x, z, off, norm=signed, cmap=style.SIGNED)
        if lines := [level for level in levels if off.min() < level < off.max()]:
            axes.contour(x, z, off, lines, colors=style.MUTED, linewidths=0.5)
    drawn = [*panels[:, 0], *panels[1:, 1]]
    differences = [f"{style.equals(style.FRICTION, mu)} minus (a)" for mu in data["friction"].values]
    titles(drawn, ["harmonic lattice", *names, *differences])
    for axes in drawn:
        network.draw_load(axes, (0.0, float(z.max())), length=3.0)
        axes.set(xlim=(-half, half), ylim=(0.0, z.max()))
    outer(panels, style.POSITION, style.HEIGHT)
    empty = panels[0, 1]
    empty.set_axis_off()
    steps, both = (0.0, 0.005, 0.02, 0.05, 0.1, 0.15), (-0.02, -0.005, 0.0, 0.005, 0.02)
    for place, mapped, label, ticks in (
        (0.62, image, style.STRESS, [t for t in steps if t <= largest]),
        (0.16, change, f"difference of {style.STRESS}", [t for t in both if abs(t) <= furthest]),
    ):
        bar = figure.colorbar(mapped, cax=empty.inset_axes((0.05, place, 0.9, 0.09)), orientation="horizontal")
        bar.set_label(label)
        bar.set_ticks(ticks)
        bar.ax.xaxis.set_major_formatter("{x:g}")
        bar.ax.tick_params(which="minor", size=0)
    for at, side, text in ((0.05, "left", "smaller than (a)"), (0.95, "right", "larger than (a)")):
        empty.text(at, 0.27, text, transform=empty.transAxes, ha=side, va="bottom", fontsize=8)
    return figure


def to_floor(stress: FloatArray, z: FloatArray, width: float) -> FloatArray:
    """The vertical stress (..., z, x) with the part of the floor (Weinhart et al., Granular Matter 14, 289 (2012)).

    The line of a contact with the floor, z = 0, ends there; continued downwards it adds the floor force, smoothed along
    x, times ``erfc(z/width)/2``. That force is twice the stress at the floor, which has the half of it that lies above.
    """
    return np.asarray(stress + stress[..., :1, :] * erfc(z[:, None] / width))


def _force_profiles(data: xr.Dataset) -> Figure:
    """Fig. 15: a panel for each friction; the curve of each depth stands on a line at that depth."""
    frictions, depths = data["friction"].values, data["depth"].values
    figure, panels = style.figure(1, len(frictions), height=3.6, sharex=True, sharey=True)
    gap = float(np.diff(np.sort(depths)).min()) if len(depths) > 1 else 1.0
    for column, axes in enumerate(panels[0]):
        largest = float(np.nanmax(data["magnitude"].values[column]))
        tall = HIGHEST * gap / largest
        for row, look in family(range(len(depths)), of="length", marked=False):
            x, magnitude = (data[name].values[column, row] for name in ("contact_x", "magnitude"))
            known = np.flatnonzero(np.isfinite(x) & np.isfinite(magnitude))
            order, base = known[np.argsort(x[known])], -float(depths[row])
            axes.axhline(base, color=style.FAINT, linewidth=0.5, zorder=0)
            axes.plot(x[order], base + tall * magnitude[order], color=look["color"], linestyle="-", linewidth=1.1)
        key = _round(0.5 * largest)
        top, left = -float(depths.min()) + 0.5 * HIGHEST * gap, -0.93 * PROFILE_HALF_WIDTH
        axes.plot([left] * 2, [top, top + tall * key], color=style.BLACK, linewidth=2.0, solid_capstyle="butt")
        note(axes, f"${key:g}\\,{style.WEIGHT}$", (left, top + 0.5 * tall * key), (4.0, 0.0), va="center", fontsize=8)
        axes.set(xlim=(-PROFILE_HALF_WIDTH, PROFILE_HALF_WIDTH), xlabel=style.POSITION)
        axes.set_yticks(-np.sort(depths), [f"{depth:.1f}" for depth in np.sort(depths)])
        axes.tick_params(axis="y", which="both", length=0.0)
    panels[0, 0].set_ylabel(f"{style.DEPTH}; height of a curve: {style.CONTACT_FORCE}", fontsize=8)
    titles(panels[0], map(_friction, frictions))
    return figure


def _friction(value: float) -> str:
    return style.equals(style.FRICTION if value == 0.0 else style.BOTH_FRICTIONS, value)


def _round(value: float) -> float:
    """A round number near ``value``."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda digit: abs(digit * power - value)) * power)
