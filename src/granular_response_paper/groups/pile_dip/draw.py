"""Fig. 17: forces, vertical stress and contact network of a pile without and with friction."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from scipy.spatial import ConvexHull
from scipy.special import erfc

from granular_response.plot import network, style
from granular_response.plot.field import draw_field
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL, Box
from granular_response_paper.captions import RADIUS, Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import ContactLines, force_key, forces, note, titles

from .parameters import Parameters

#: The cases that are drawn, left and right: of the two frictionless minima one.
NAMES = {"frictionless": "without friction", "frictional": "with friction"}
DRAWN = list(NAMES)

#: A dip of the stress that is smaller, relative to the largest stress, is none.
LEAST_DIP = 1e-3
#: Force of the key, in mean disk weights.
KEY = 5.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"fig17_pile": _pile(datasets["piles"], datasets["stress"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    said = {**of_scene(parameters.scene), "width": parameters.stress_width}
    return of_group("pile_dip", {"fig17_pile": said}, {"fig17_pile": _finding(datasets["stress"])})


def _finding(stress: xr.Dataset) -> str:
    """Whether the vertical stress has a dip under the apex, in each pile."""
    said = []
    for case, name in NAMES.items():
        dip = float(stress["dip"].sel(case=case))
        said.append(f"{name} " + ("it is largest there" if dip < LEAST_DIP else f"it has a dip of {100.0 * dip:.2g} %"))
    height = f"{float(stress['dip_height']):g} {RADIUS}"
    return f"Vertical stress under the apex, at the height {height}: {' and '.join(said)}."


def _pile(piles: xr.Dataset, stress: xr.Dataset) -> Figure:
    figure, panels = style.figure(3, 2, height=3.9)
    shown = piles.sel(case=DRAWN)
    strongest = float(np.linalg.norm(shown["contact_force"].values, axis=-1).max())
    fields = stress["stress_zz"].sel(case=DRAWN) + _wall_part(shown, stress)
    largest = float(fields.max())
    levels = np.asarray(MaxNLocator(8).tick_values(0.0, largest))[1:-1]  # without zero and what is above all
    width = float(piles["width"])
    top = float(piles["position"].values[..., 1].max()) + 1.0
    for column, case in enumerate(DRAWN):
        chains, map_axes, contacts = panels[:, column]
        one = piles.sel(case=case)
        _forces(chains, one, strongest)
        field = fields.sel(case=case)
        image = draw_field(map_axes, stress["x"], stress["z"], field, norm=Normalize(0.0, largest), levels=levels)
        _outline(map_axes, one)
        map_axes.set(xlabel=style.POSITION, ylabel=style.HEIGHT if column == 0 else "")
        _network(contacts, one)
        for axes in (chains, contacts):
            network.draw_box(axes, Box(width), 2.0)
            style.no_axes(axes)
            axes.set(xlim=(-4.6, width + 4.6), ylim=(-1.6, top + 0.2))
        map_axes.set(xlim=(-0.5 * width, 0.5 * width), ylim=(0.0, top))
        force_key(chains, (0.8 * width, 0.9 * top), KEY, strongest, style.WEIGHT)
    titles(panels.flat, [*(f"forces, {NAMES[case]}" for case in DRAWN), *2 * ["$\\sigma_{zz}$"], *2 * ["contacts"]])
    bar = figure.colorbar(image, ax=panels[1], shrink=0.9, aspect=14, pad=0.02, ticks=[0.0, *levels[1::2]])
    bar.ax.hlines(levels, 0.0, 1.0, transform=bar.ax.get_yaxis_transform(), color="white", linewidth=0.6)
    bar.set_label(style.STRESS_OF_GRAVITY)
    return figure


def _wall_part(piles: xr.Dataset, stress: xr.Dataset) -> xr.DataArray:
    """(case, z, x) stress that the forces of the floor add (Weinhart et al., Granular Matter 14, 289 (2012)).

    The line of a contact with the floor ends at the floor, so the coarse-grained stress falls to about half there; with
    the line continued downwards it is that of the material up to the floor.
    """
    on_floor = piles["wall_index"].values == FLOOR
    w, middle = float(stress["stress_width"]), 0.5 * float(piles["width"])
    at = piles["position"].isel(axis=0, disk=piles["wall_disk"].values[on_floor]).values - middle
    near = np.exp(-(((stress["x"].values - at[..., None]) / w) ** 2)) / (np.sqrt(np.pi) * w)
    pushed = piles["wall_force"].isel(axis=1).values[:, on_floor]
    along = np.einsum("cw,cwx->cx", pushed, near)
    below = 0.5 * erfc(stress["z"].values / w)
    return xr.DataArray(along[:, None] * below[:, None], dims=("case", "z", "x"))


def _forces(axes: Axes, one: xr.Dataset, strongest: float) -> None:
    position, radius = one["position"].values, one["radius"].values
    network.draw_disks(axes, position, radius, facecolor=style.DISKS, edgecolor="none")
    touching = np.where(one["contact_status"].values[:, None] != 0, one["contact_force"].values, 0.0)
    forces(axes, ContactLines.of(one, position), np.concatenate([touching, one["wall_force"].values]), strongest)
    _clipped_at_walls(axes, one)


def _clipped_at_walls(axes: Axes, one: xr.Dataset) -> None:
    """Lines of forces end at the side walls; those that would go through have their force beside them."""
    width = float(one["width"])
    inside = Rectangle((0.0, -4.0), width, 200.0, transform=axes.transData)
    for lines in axes.collections:
        lines.set_clip_path(inside)
        lines.set_in_layout(False)
    for wall, x, gap, side in ((LEFT_WALL, 0.0, -3.0, "right"), (RIGHT_WALL, width, 3.0, "left")):
        here = one["wall_index"].values == wall
        size = np.linalg.norm(one["wall_force"].values[here], axis=1)
        if here.any() and size.max() > KEY:
            height = float(one["position"].values[one["wall_disk"].values[here][size.argmax()], 1])
            text = f"${size.max():.0f}\\,{style.WEIGHT}$"
            note(axes, text, (x, height), (gap, 4.0), ha=side, va="bottom", fontsize=7, annotation_clip=False)


def _outline(axes: Axes, one: xr.Dataset) -> None:
    """The convex hull of the disks and the floor, in the coordinates of the map."""
    around = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    rim = one["position"].values[:, None] + one["radius"].values[:, None, None] * circle
    hull = ConvexHull(rim.reshape(-1, 2))
    corner = hull.points[hull.vertices[[*range(len(hull.vertices)), 0]]] - (0.5 * float(one["width"]), 0.0)
    axes.plot(*corner.T, color="white", linestyle="--", linewidth=0.9)
    axes.axhline(0.0, color=style.MUTED, linewidth=1.6, linestyle="-", zorder=4)


def _network(axes: Axes, one: xr.Dataset) -> None:
    touching = one["contact_status"].values != 0
    network.draw_disks(axes, one["position"].values, one["radius"].values)
    pairs = one["contact_disk"].values[touching], one["contact_partner"].values[touching]
    network.draw_contacts(axes, one["position"].values, *pairs, linewidth=0.6)
