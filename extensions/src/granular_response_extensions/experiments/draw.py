"""What the experiments of Sec. II.B observe: forces by direction, widths, images of one packing and all."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.field import draw_field, root_norm
from granular_response.plot.photoelastic import photoelastic
from granular_response_extensions.panels import GUIDE
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene, values
from granular_response_paper.panels import DOTTED, banded, note, titles

from .parameters import LATTICE, Parameters

#: Images of packings: pixels from side to side, mean radii to each side of the load, and the principal stress
#: difference of one fringe, per applied force, in 1/mean radius.
PIXELS, NEAR, FRINGE = 560, 18.0, 0.32
DOTS = GUIDE | {"linestyle": DOTTED}


def draw(datasets: Datasets) -> dict[str, Figure]:
    means = datasets["means"]
    known, largest, oblique = _cases(means)
    figure, ((straight, turned, widths),) = style.figure(1, 3, height=2.9)
    # of one packing under its largest and its smallest force
    alike = [case for case in known if means["packing"].values[case] == means["packing"].values[known[0]]]
    _directions(straight, means, list(dict.fromkeys([*alike[:1], *alike[-1:]])))
    _directions(turned, means, oblique)
    for angle in np.unique(means["angle_applied"].values[oblique]):
        turned.axvline(angle, color=style.FAINT, linewidth=3.0, zorder=0.4)
    _widths(widths, means, [case for case in known if case in largest])
    titles((straight, turned, widths), ("vertical force", "oblique force", "widths"))
    return {"experiments": figure, "experiments_images": _images(datasets)}


def _cases(means: xr.Dataset) -> tuple[list[int], list[int], list[int]]:
    """Those with a vertical force that have means, of each packing the first load that it holds, and oblique ones."""
    straight = means["angle_applied"].values == 90.0
    known = np.flatnonzero(straight & np.isfinite(means["contrast"].values[:, 0]))
    _, starts = np.unique(means["packing"].values[known], return_index=True)
    return known.tolist(), np.sort(known[starts]).tolist(), np.flatnonzero(~straight).tolist()


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    p = parameters
    sizes = ", ".join(f"{name}: {packing.build().n} disks" for name, packing in p.packings.items())
    counts = sorted({case.realizations for case in p.cases})
    said = of_scene(p.base, polydispersity=None, packing=sizes, width=p.width, realizations=counts)
    pictures = {"experiments": said, "experiments_images": said}
    return of_group("experiments", pictures, _findings(datasets["means"]), p=p)


def _findings(means: xr.Dataset) -> dict[str, str]:
    """The exponent with which the width grows with the depth, of each packing."""
    said = []
    for case in _cases(means)[1]:
        one = means["length"].isel(case=case).sel(definition="half_force", estimate="mean", depth=slice(2.0, None))
        one = one.dropna("depth")
        if one.sizes["depth"] > 2:
            power = np.polyfit(np.log(one["depth"].values), np.log(one.values), 1)[0]
            said.append(f"{power:.2g} ({means['packing'].values[case]})")
    return {"experiments": f"Widths grow with the depth to the power of {values(said)}." if said else ""}


def _name(data: xr.Dataset, case: int) -> str:
    one = data.isel(case=case)
    angle = f", {float(one['angle_applied']):g}°" if one["angle_applied"] != 90.0 else ""
    return f"{one['packing'].item()}, ${float(one['force_applied']):g}\\,{style.WEIGHT}${angle}"


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
        axes.legend(fontsize=7, handlelength=1.6)


def _widths(axes: Axes, means: xr.Dataset, cases: list[int]) -> None:
    for k, case in enumerate(cases):
        one = means["length"].isel(case=case).sel(definition="half_force", depth=slice(2.0, None)).dropna("depth")
        middle, low, high = one.transpose("estimate", "depth").values
        banded(axes, one["depth"], middle, (low, high), style.line(k), label=_name(means, case))
    depth = np.array([4.0, 30.0])
    for power, text in ((1.0, r"$\propto z$"), (0.5, r"$\propto \sqrt{z}$")):
        ends = 2.4 * (depth / depth[0]) ** power
        axes.plot(depth, ends, **DOTS)
        side, gap = ("bottom", 4.0) if power == 1.0 else ("top", -6.0)
        note(axes, text, (depth[1], ends[1]), (2.0, gap), fontsize=8, ha="right", va=side)
    ticks = [2, 5, 10, 20, 40]
    axes.set(xlabel=style.DEPTH, ylabel=rf"half width$\,/\,{style.RADIUS}$", xscale="log", yscale="log")
    axes.set(xticks=ticks, xticklabels=ticks, yticks=ticks, yticklabels=ticks, ylim=(0.8, 80.0))
    axes.minorticks_off()
    axes.legend(fontsize=7, loc="upper left", handlelength=1.6)


def _images(datasets: Datasets) -> Figure:
    """Above one packing between crossed polarisers, below the mean force of all."""
    pictures = {int(name.removeprefix("picture_")): one for name, one in datasets.items() if name.startswith("picture")}
    means, number = datasets["means"], max(1, len(pictures))
    figure, panels = style.figure(2, number, height=4.3)
    for (case, one), (above, below) in zip(pictures.items(), panels.T, strict=False):
        half = min(NEAR, 0.5 * float(one.attrs["width"]))
        photoelastic(one, ax=above, half_width=half, pixels=PIXELS, fringe=FRINGE * float(one["total_force"].max()))
        field = means["force"].isel(case=case).sel(estimate="mean", x=slice(-half, half)).dropna("depth", how="all")
        if field.size:
            largest = float(field.sel(depth=slice(2.0, None)).max()) or 1.0
            image = draw_field(below, field["x"], field["depth"], np.clip(field, 0.0, largest), norm=root_norm(largest))
            bar = figure.colorbar(image, ax=below, orientation="horizontal", shrink=0.8, aspect=18, pad=0.04)
            bar.set_ticks([0.0, largest], labels=["0", "largest"])
            bar.ax.minorticks_off()
        below.set(xlabel=style.POSITION, ylabel=style.DEPTH if case == min(pictures) else "")
        below.invert_yaxis()
    names = [_name(means, case) for case in pictures]
    titles(panels.flat, [*names, *(["mean of packings"] * len(names))])
    return figure
