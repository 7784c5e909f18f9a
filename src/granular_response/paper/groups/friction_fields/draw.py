"""Figs. 13 to 15: force chains, vertical stress and force magnitudes in a slab with and without friction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.field import draw_field, root_norm
from granular_response.plot.network import (
    draw_box,
    draw_disks,
    draw_force_chains,
    draw_force_key,
    draw_load,
    draw_loaded_disk,
    force_scale,
    pair_points,
    wall_points,
)
from granular_response.state import Box

#: Half of the width of the stress maps and of the profiles, in mean radii.
MAP_HALF_WIDTH, PROFILE_HALF_WIDTH = 30.0, 20.0
#: Contours of the stress maps, per largest stress.
LEVELS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7)


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig13_force_chains``, ``fig14_vertical_stress`` and ``fig15_force_profiles``."""
    drawn = {
        "fig13_force_chains": _force_chains(datasets["forces"]),
        "fig14_vertical_stress": _vertical_stress(datasets["stress"]),
    }
    if "profiles" in datasets:
        drawn["fig15_force_profiles"] = _force_profiles(datasets["profiles"])
    return drawn


def _force_chains(data: xr.Dataset) -> Figure:
    """The central third of the slab; one scale for all panels."""
    frictions = data["friction"].values
    figure, panels = style.figure(len(frictions), 1, width="single", height=2.15 * len(frictions) + 0.2)
    width, disk = float(data["width"]), int(data["loaded_disk"])
    added, at_wall = data["contact_added_force"].values, data["wall_added_force"].values
    scale = force_scale(added.reshape(-1, 2), longest=4.6, widest=4.6)
    smallest = 1e-3 * float(np.linalg.norm(added, axis=-1).max())
    radius = data["radius"].values
    for index, axes in enumerate(panels[:, 0]):
        position = data["position"].values[index]
        pairs = data["contact_disk"].values, data["contact_partner"].values
        walls = data["wall_disk"].values, data["wall_index"].values
        inside = np.abs(position[:, 0] - 0.5 * width) <= width / 6.0 + 1.0
        draw_disks(axes, position[inside], radius[inside], edgecolor="#E0E0E0")
        for point, force in (
            (pair_points(position, radius, *pairs), added[index]),
            (wall_points(position, radius, *walls), at_wall[index]),
        ):
            shown = np.abs(point[:, 0] - 0.5 * width) <= width / 6.0
            draw_force_chains(axes, point[shown], force[shown], smallest=smallest, **scale)
        top = (float(position[disk, 0]), float(position[disk, 1]) + 1.0)
        draw_loaded_disk(axes, (top[0], top[1] - 1.0), float(radius[disk]))
        draw_load(axes, top)
        draw_box(axes, Box(width), top[1], between=(width / 3.0, 2.0 * width / 3.0))
        style.no_axes(axes)
        axes.set(xlim=(width / 3.0 - 0.5, 2.0 * width / 3.0 + 0.5), ylim=(-0.8, top[1] + 4.2))
        style.letter(axes, chr(ord("a") + index), text=_friction(frictions[index]))
    last = panels[-1, 0]
    magnitude = _round(float(data["force"]) / 5.0)
    draw_force_key(last, (2.0 * width / 3.0 - 8.0, top[1] + 2.5), magnitude, **scale)
    return figure


def _vertical_stress(data: xr.Dataset) -> Figure:
    """Maps on one scale, the harmonic lattice last."""
    frictions = data["friction"].values
    maps = [(field, _friction(mu)) for field, mu in zip(data["stress_zz"].values, frictions, strict=True)]
    maps.append((data["stress_zz_lattice"].values, "isotropic harmonic lattice"))
    rows = (len(maps) + 1) // 2
    figure, panels = style.figure(rows, 2, width="double", height=1.62 * rows + 0.3, sharex=True, sharey=True)
    x, z = data["x"].values, data["z"].values
    half = min(MAP_HALF_WIDTH, float(x.max()))
    largest = max(float(field.max()) for field, _ in maps)
    # the stress falls like 1/depth: equal steps of its square root show the lower part of the slab too
    norm = root_norm(largest)
    levels = largest * np.array(LEVELS)
    for index, (axes, (field, name)) in enumerate(zip(panels.ravel(), maps, strict=False)):
        image = draw_field(axes, x, z, np.clip(field, 0.0, None), norm=norm, levels=levels)
        axes.set(xlim=(-half, half), ylim=(0.0, z.max()))
        style.letter(axes, chr(ord("a") + index), place="above", text=name)
    for axes in panels.ravel()[len(maps) :]:
        axes.set_axis_off()
    for axes in panels[-1]:
        axes.set_xlabel("$x/R$")
    for axes in panels[:, 0]:
        axes.set_ylabel("$z/R$")
    bar = figure.colorbar(image, ax=panels, shrink=0.9, aspect=25, pad=0.02)
    bar.set_label("$\\sigma_{zz} R / F_{\\mathrm{ext}}$")
    bar.set_ticks([t for t in (0.0, 0.005, 0.02, 0.05, 0.1, 0.15) if t <= largest])
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.tick_params(which="minor", size=0)
    return figure


def _force_profiles(data: xr.Dataset) -> Figure:
    frictions, depths = data["friction"].values, data["depth"].values
    figure, panels = style.figure(1, len(frictions), width="double", height=2.9, sharex=True)
    colours = style.ordered_colours(len(depths))
    for index, axes in enumerate(panels[0]):
        for row, depth in enumerate(depths):
            axes.plot(
                data["contact_x"].values[index, row],
                data["magnitude"].values[index, row],
                linestyle="-",
                linewidth=0.8,
                color=colours[row],
                marker=style.MARKERS[row % len(style.MARKERS)],
                markersize=2.8,
                markeredgewidth=0.0,
                label=f"${depth:.1f}\\,R$",
            )
        half = PROFILE_HALF_WIDTH
        axes.set(xlabel="$x/R$", xlim=(-half, half))
        axes.set_ylim(0.0, 1.06 * float(np.nanmax(data["magnitude"].values[index])))
        style.letter(axes, chr(ord("a") + index), text=_friction(frictions[index]))
    panels[0, 0].set_ylabel("$|\\mathbf{f}|/mg$")
    panels[0, -1].legend(title="depth", loc="upper right")
    return figure


def _friction(value: float) -> str:
    if value == 0.0:
        return "$\\mu = 0$"
    return f"$\\mu = \\mu^{{\\mathrm{{wall}}}} = {value:g}$"


def _round(value: float) -> float:
    """A round number near ``value``."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda digit: abs(digit * power - value)) * power)
