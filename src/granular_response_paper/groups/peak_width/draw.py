"""Widths of the response against depth, the powers with which they grow, and the profiles that they are read off."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from granular_response.plot import style
from granular_response_paper.captions import RADIUS, WEIGHT, Caption, of_group, of_scene
from granular_response_paper.panels import DASHED, DOTTED, GUIDE, SURVEYED, different, family, material, titles

from .parameters import Parameters

#: Powers of depth of an elastic response, and of force that diffuses; and their middle.
ELASTIC, DIFFUSIVE = 1.0, 0.5
HALFWAY = 0.5 * (ELASTIC + DIFFUSIVE)
#: Two definitions of the width: label, and filling of the symbols.
DEFINITIONS = {"half_maximum": ("at half maximum", "full"), "half_force": ("with half of the force", "none")}
#: Half widths per depth that are shown.
PER_DEPTH = 0.28, 2.0
#: Labelled on logarithmic axes, in every decade.
TICKS = (1.0, 2.0, 5.0)


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``peak_width_depth`` and ``peak_width_powers`` from the datasets ``inside`` and ``floors``."""
    inside, floors = datasets["inside"], datasets["floors"]
    return {"peak_width_depth": _growth(inside, floors), "peak_width_powers": _powers(inside, floors)}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    counts = {case.count(h) for case in parameters.cases if case.polydispersity for h in range(len(case.heights))}
    said = of_scene(
        parameters.base, friction=None, wall_friction=None, polydispersity=None, packing=None, normal_stiffness=None,
        width=parameters.width,
    )  # fmt: skip
    surveyed = [layers for case in parameters.cases for layers in case.surveyed]
    stored = f"packings of the survey, {min(surveyed)} to {max(surveyed)} layers" if surveyed else ""
    slabs = (
        f"Forces F, in {WEIGHT}, and k_N = {parameters.base.contact.normal_stiffness:g} {WEIGHT}/{RADIUS} are those at "
        f"{parameters.reference_layers} layers; F grows as their square, k_N with them. "
        "* Friction only after settling. Walls rub as the disks."
    )
    realizations = " or ".join(map(str, sorted(counts)))
    return of_group(
        "peak_width",
        {"peak_width_depth": said, "peak_width_powers": said},
        p=parameters,
        disorder=f"Disorder: mean profiles of {realizations} packings. " if counts else "",
        edges=f"Open symbols: {stored}. " if stored else "",
        along=f"With {stored}. " if stored else "",
        slabs=slabs,
    )


def name(data: xr.Dataset, case: int) -> str:
    """A case as it stands in legends."""
    one = data.isel(case=case)
    prepared = "*" if str(one["gravity"].values) == "frictionless" else ""
    load = f", $F = {float(one['force']):g}$" if one["force"] else ""
    return material(float(one["polydispersity"]), float(one["friction"])) + prepared + load


def kinds(data: xr.Dataset) -> tuple[tuple[str, list[int]], ...]:
    """Cases by what stands in one panel."""
    disordered, large = data["polydispersity"].values > 0.0, data["force"].values > 0.0
    parts = (
        ("lattices, small force", ~disordered & ~large),
        ("lattices, larger force", ~disordered & large),
        ("disorder", disordered),
    )
    return tuple((title, np.flatnonzero(part).tolist()) for title, part in parts if part.any())


def _growth(inside: xr.Dataset, floors: xr.Dataset) -> Figure:
    """Upper row: inside the highest slab of each case. Lower row: on the floors of all slabs. Width per depth."""
    parts = kinds(inside)
    figure, panels = style.figure(2, len(parts), width="double", height=5.0, sharex="row", sharey=True)
    for row, (data, label) in enumerate(((inside, "depth"), (floors, "height of the slab"))):
        for (_, cases), axes in zip(parts, panels[row], strict=True):
            along = "polydispersity" if data["polydispersity"].values[cases].any() else "friction"
            ramp = dict(family(different(data[along][cases]), of=along))
            for place, case in enumerate(cases):
                colour = ramp[float(data[along][case])]["color"]
                look = style.marked_line(place, colour=colour) | {"linestyle": "none", "markersize": 3.8}
                _widths(axes, data.isel(case=case).sel(definition="half_maximum"), name(data, case), look)
            axes.set(xscale="log", yscale="log", xlabel=rf"{label}$\,/\,{style.RADIUS}$", ylim=PER_DEPTH)
            for axis, ticks in ((axes.xaxis, TICKS), (axes.yaxis, (1.0, 2.0, 4.0, 6.0))):
                axis.set(major_locator=LogLocator(subs=ticks), major_formatter="{x:g}", minor_formatter="")
            guide = np.array([10.0, 22.0])
            axes.plot(guide, 0.46 * (guide[0] / guide) ** (ELASTIC - DIFFUSIVE), linestyle=DOTTED, **GUIDE)
        panels[row, 0].set_ylabel(f"half width / {label}")
    titles(panels.flat, [title + where for where in (", inside", ", on the floor") for title, _ in parts])
    for axes in panels[0]:
        axes.legend(loc="upper right", fontsize=7)
    return figure


def _widths(axes: Axes, one: xr.Dataset, text: str, look: dict[str, Any]) -> None:
    """Half width at half maximum per depth, hollow where packings are stored; of the elastic slab a grey line."""
    depth = one["depth"].values
    stored = np.broadcast_to(one["surveyed"].values > 0.0, depth.shape)  # inside all points are of one slab
    axes.plot(depth, one["length"] / depth, label=text, **look)
    axes.plot(depth[stored], (one["length"] / depth)[stored], **look | SURVEYED)
    axes.plot(depth, one["elastic_length"] / depth, color=style.FAINT, linewidth=3.5, linestyle="-", zorder=1)


def _powers(inside: xr.Dataset, floors: xr.Dataset) -> Figure:
    """A row for each case: powers inside and on the floor, by both definitions, and of what elastic slabs have."""
    cases = [case for _, members in kinds(inside) for case in members]
    figure, (panels,) = style.figure(1, 2, width="double", height=0.6 + 0.3 * len(cases), sharey=True)
    titles(panels, ("inside, against the depth", "on the floor, against the height"))
    for axes, data in zip(panels, (inside, floors), strict=True):
        axes.axvspan(HALFWAY, 2.0 * ELASTIC - HALFWAY, color="#EEEEEE", linewidth=0.0, zorder=0)
        axes.axvline(ELASTIC, linestyle=DASHED, **GUIDE)
        axes.axvline(DIFFUSIVE, linestyle=DOTTED, **GUIDE)
        for row, case in enumerate(cases):
            for k, (definition, (label, fill)) in enumerate(DEFINITIONS.items()):
                one = data.isel(case=case).sel(definition=definition)
                value, (low, high) = float(one["power"][0]), one["interval"].values
                y = row + (0.17 if k else -0.17)
                axes.errorbar(
                    [value], [y], xerr=[[max(value - low, 0.0)], [max(high - value, 0.0)]], fmt="os"[k],
                    color=style.COLOURS[k], fillstyle=fill, markersize=4, capsize=2, linewidth=0.9,
                    label=label if row == 0 else None,
                )  # fmt: skip
                axes.plot(
                    [float(one["elastic_power"][0])], [y], marker="|", markersize=7, color=style.BLACK,
                    linestyle="none", label="elastic slab" if row == 0 and k else None,
                )  # fmt: skip
        axes.set(xlabel="exponent of the width")
    panels[0].set_yticks(range(len(cases)), [name(inside, case) for case in cases])
    panels[0].set_ylim(len(cases) - 0.4, -0.6)
    panels[1].legend(loc="upper right", fontsize=7)
    return figure
