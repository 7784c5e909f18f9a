"""What the experiments of Sec. II.B observe: forces by depth and direction, widths, images of one packing and all."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.field import draw_field, root_norm
from granular_response_extensions.panels import GUIDE
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import DOTTED, banded, family, polarised, titles

from .parameters import LATTICE, Parameters

#: Depths and reach of the profiles, in mean radii, and pixels of images from side to side.
DEPTHS, REACH, PIXELS = (4.0, 8.0, 12.0, 16.0), 22.0, 560
#: The small force of experiments in which the response was linear, in mean weights.
SMALL = 3.0
TITLES = "vertical force", "oblique force", "widths", "moved disks"
DOTS = GUIDE | {"linestyle": DOTTED}


def draw(datasets: Datasets) -> dict[str, Figure]:
    means, packings = datasets["means"], datasets["packings"]
    figure, panels = style.figure(2, 3, height=5.2)
    force, straight = means["force_applied"].values, means["angle_applied"].values == 90.0
    known = straight & np.isfinite(means["contrast"].values[:, 0])
    _, starts = np.unique(means["packing"].values[known], return_index=True)
    largest = np.sort(np.flatnonzero(known)[starts]).tolist()  # of each packing the first load that it holds
    shown = [case for case in np.flatnonzero(known).tolist() if case in largest or force[case] == SMALL]
    oblique = np.flatnonzero(~straight).tolist()
    for axes, case in zip(panels[0], largest[:2], strict=False):
        _profiles(axes, means.isel(case=case))
    _directions(panels[0, 2], means, shown)
    _directions(panels[1, 0], means, oblique)
    for angle in np.unique(means["angle_applied"].values[oblique]):
        panels[1, 0].axvline(angle, color=style.FAINT, linewidth=3.0, zorder=0.4)
    _widths(panels[1, 1], means, shown)
    _moves(panels[1, 2], packings, np.flatnonzero(force > SMALL).tolist())
    profiles = [f"profiles, {_name(means, case)}" for case in largest[:2]]
    titles(panels.flat, [*profiles, *["profiles"] * (2 - len(profiles)), *TITLES])
    return {"experiments": figure, "experiments_images": _images(datasets)}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    p = parameters
    said = of_scene(p.base, polydispersity=None, packing=None, width=p.width)
    sizes = ", ".join(f"{name}: {packing.build().n} disks" for name, packing in p.packings.items())
    numbers = [case.realizations for case in p.cases]
    counts = f"{min(numbers)} to {max(numbers)}"
    return of_group("experiments", {"experiments": said, "experiments_images": said}, p=p, sizes=sizes, counts=counts)


def _name(data: xr.Dataset, case: int) -> str:
    one = data.isel(case=case)
    angle = f", {float(one['angle_applied']):g}°" if one["angle_applied"] != 90.0 else ""
    return f"{one['packing'].item()}, {float(one['force_applied']):g}${style.WEIGHT}${angle}"


def _profiles(axes: Axes, one: xr.Dataset) -> None:
    near = one.sel(x=slice(-REACH, REACH))
    depths = [depth for depth in DEPTHS if depth in near["depth"] and near["force"].sel(depth=depth).notnull().any()]
    for depth, look in family(depths, of="length", marked=False):
        middle, low, high = near["force"].sel(depth=depth).transpose("estimate", "x").values
        banded(axes, near["x"], middle, (low, high), look, alpha=0.25, label=f"{depth:g}")
    axes.set(xlabel=style.POSITION, ylabel=rf"incremental force per length$\,\times\,{style.RADIUS}/{style.F_EXT}$")
    axes.legend(title=style.DEPTH, fontsize=7, title_fontsize=7, handlelength=1.2)


def _directions(axes: Axes, means: xr.Dataset, cases: list[int]) -> None:
    for k, case in enumerate(cases):
        middle, low, high = means["direction"].isel(case=case).transpose("estimate", "angle").values
        banded(axes, means["angle"], middle, (low, high), style.line(k), label=_name(means, case))
    for angle in (LATTICE, 180.0 - LATTICE):
        axes.axvline(angle, ymax=0.62, **DOTS)  # the legend is above
    axes.set(xlabel="direction below horizontal (°)", ylabel=rf"incremental force per radian$\,/\,{style.F_EXT}$")
    axes.set(xticks=[30, 60, 90, 120, 150], ylim=(0.0, None))
    if cases:
        axes.set_ylim(0.0, 1.5 * axes.get_ylim()[1])
        axes.legend(fontsize=6, handlelength=1.6)


def _widths(axes: Axes, means: xr.Dataset, cases: list[int]) -> None:
    for k, case in enumerate(cases):
        one = means["length"].isel(case=case).sel(definition="half_force", depth=slice(2.0, None)).dropna("depth")
        middle, low, high = one.transpose("estimate", "depth").values
        banded(axes, one["depth"], middle, (low, high), style.line(k), label=_name(means, case))
    depth = np.array([4.0, 30.0])
    for power in (1.0, 0.5):
        axes.plot(depth, 2.4 * (depth / depth[0]) ** power, **DOTS)
    ticks = [2, 5, 10, 20, 40]
    axes.set(xlabel=style.DEPTH, ylabel=rf"half width$\,/\,{style.RADIUS}$", xscale="log", yscale="log")
    axes.set(xticks=ticks, xticklabels=ticks, yticks=ticks, yticklabels=ticks, ylim=(0.8, 40.0))
    axes.minorticks_off()
    axes.legend(fontsize=6, loc="upper left", handlelength=1.6)


def _moves(axes: Axes, packings: xr.Dataset, cases: list[int]) -> None:
    for k, case in enumerate(cases):
        moves = np.sort(packings["moved"].isel(case=case).dropna("realization"))
        part = np.arange(1, len(moves) + 1) / len(moves)
        axes.step(np.maximum(moves, 1e-3), part, where="post", label=_name(packings, case), **style.line(k))
    axes.axvline(packings.attrs["largest_move"], ymax=0.62, **DOTS)
    axes.set(xlabel=rf"displacement of the loaded disk$\,/\,{style.RADIUS}$", xscale="log")
    axes.set(ylabel="fraction of packings", ylim=(0.0, 1.75), yticks=[0.0, 0.5, 1.0])
    axes.legend(fontsize=6, loc="upper left", handlelength=1.6)


def _images(datasets: Datasets) -> Figure:
    """Above one packing between crossed polarisers, below the mean force of all."""
    pictures = {int(name.removeprefix("picture_")): one for name, one in datasets.items() if name.startswith("picture")}
    means, number = datasets["means"], max(1, len(pictures))
    figure, panels = style.figure(2, number, height=3.9)
    for (case, one), (above, below) in zip(pictures.items(), panels.T, strict=False):
        half = polarised(above, one, float(one["total_force"].max()), pixels=PIXELS)
        field = means["force"].isel(case=case).sel(estimate="mean", x=slice(-half, half)).dropna("depth", how="all")
        if field.size:
            largest = float(field.sel(depth=slice(2.0, None)).max()) or 1.0
            draw_field(below, field["x"], -field["depth"], np.clip(field, 0.0, largest), norm=root_norm(largest))
        below.set(xlabel=style.POSITION, ylabel=rf"$-$depth$\,/\,{style.RADIUS}$")
    names = [_name(means, case) for case in pictures]
    titles(panels.flat, [*names, *(["mean of packings"] * len(names))])
    return figure
