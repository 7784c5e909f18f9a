"""Moduli of packings against their coordination, measured and predicted responses, and sizes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import SURVEYED, label_ends, materials, outer, titles, zero

from .parameters import Parameters

#: Names in keys of how disks follow a strain.
FOLLOWING = {"affine": "affine", "free": "relaxed"}


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``moduli_packings``, ``moduli_response`` and ``moduli_size`` from ``packings``, ``moduli_lattice`` from
    ``lattice``."""
    packings = datasets["packings"]
    return {
        "moduli_lattice": _lattice(datasets["lattice"]),
        "moduli_packings": _moduli(packings),
        "moduli_response": _responses(packings),
        "moduli_size": _sizes(packings),
    }


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    packing = f"slabs with periodic sides, {parameters.disks_per_layer} disks in a row for each layer"
    said = of_scene(parameters.base, friction=None, wall_friction=None, polydispersity=None, packing=packing)
    lattice = of_scene(
        parameters.base,
        friction=parameters.lattice.friction, wall_friction=0.0, packing=None, stiffness_ratio=None,
    )  # fmt: skip
    most = [max(map(sum, zip(case.realizations, case.further, strict=True))) for case in parameters.cases]
    surveyed: Counter[int] = Counter()
    for case in parameters.cases:
        surveyed.update(dict(zip(case.layers, case.further, strict=True)))
    stored = [f"{count} of {layers} layers" for layers, count in sorted(surveyed.items()) if count]
    return of_group(
        "moduli",
        {"moduli_packings": said, "moduli_response": said, "moduli_size": said, "moduli_lattice": lattice},
        p=parameters,
        ensemble=f"{min(most)} to {max(most)}" if min(most) != max(most) else f"{most[0]}",
        survey=f" Of the survey: {', '.join(stored)}." if stored else "",
        edges=" Open symbols: at least half of the packings are the survey's." if stored else "",
        tolerances=[100.0 * tolerance for tolerance in parameters.tolerances],
    )


def _mean_and_spread(values: xr.DataArray) -> tuple[np.ndarray, np.ndarray]:
    """Over realizations; no spread of fewer than two."""
    count = values.notnull().sum("realization")
    return values.mean("realization").values, values.std("realization", ddof=1).where(count > 1, 0.0).values


def _moduli(data: xr.Dataset) -> Figure:
    """(a) bulk and (b) shear modulus against coordination, affine and relaxed; (c) horizontal over vertical."""
    figure, (panels,) = style.figure(1, 3, width="double", height=3.2)
    a, b, c, d = (data["moduli"].sel(modulus=name) for name in "abcd")
    shown = {
        r"bulk modulus $(a + b + 2c)\,/\,4k_N$": 0.25 * (a + b + 2.0 * c),
        r"shear modulus $(a + b - 2c + 2d)\,/\,8k_N$": 0.125 * (a + b - 2.0 * c) + 0.25 * d,
        r"$a\,/\,b$, horizontal over vertical": a / b,
    }
    cases = materials(data["polydispersity"], data["friction"])
    for axes, (label, modulus) in zip(panels, shown.items(), strict=True):
        for case, (_, look) in enumerate(cases):
            across, beside = _mean_and_spread(data["coordination"].isel(case=case))
            look = look | {"markeredgewidth": 0.8, "markersize": 4.5, "capsize": 2, "linewidth": 0.7}
            for following, filled in (("affine", False), ("free", True)):
                mean, spread = _mean_and_spread(modulus.isel(case=case).sel(following=following))
                face = look["color"] if filled else "white"
                axes.errorbar(across, mean, spread, beside, markerfacecolor=face, markeredgecolor=look["color"], **look)
        axes.set(xlabel="coordination number $z$", ylabel=label, ylim=(0.0, None))
    panels[2].axhline(1.0, color=style.FAINT, linewidth=0.6, zorder=0)
    titles(panels)
    keys = [Line2D([], [], **look | {"linestyle": "none", "markersize": 4.5}) for _, look in cases]
    plain: dict[str, Any] = {"linestyle": "none", "marker": "o", "color": style.BLACK, "markersize": 4.5}
    keys += [Line2D([], [], markerfacecolor="white", **plain), Line2D([], [], **plain)]
    names = [*(name for name, _ in cases), *FOLLOWING.values()]
    figure.legend(keys, names, loc="outside lower center", ncols=4)
    return figure


def _responses(data: xr.Dataset) -> Figure:
    """Mean response of the largest packings of each case over that of the slabs of their moduli."""
    cases = materials(data["polydispersity"], data["friction"])
    rows = -(-len(cases) // 3)
    figure, panels = style.figure(rows, 3, width="double", height=0.5 + 1.9 * rows, sharex=True, sharey=True)
    place, texts = data["place"].values, []
    for case, ((name, _), axes) in enumerate(zip(cases, panels.flat, strict=False)):
        one = data.isel(case=case, size=int(np.nanargmax(data["layers"].values[case])), smoothing=0)
        mean, spread = _mean_and_spread(one["response"])
        axes.fill_between(place, mean - spread, mean + spread, color=style.COLOURS[0], alpha=0.2, linewidth=0.0)
        axes.plot(place, mean, **style.line(0), label="packings")
        for solid, look, label in (
            ("free", {"color": style.BLACK, "linestyle": (0, (4, 2))}, "slab with the measured moduli"),
            ("isotropic", {"color": style.COLOURS[1], "linestyle": (0, (1.2, 1.2))}, "isotropic slab"),
        ):
            axes.plot(place, one["predicted"].sel(solid=solid).mean("realization"), label=label, **look)
        zero(axes)
        axes.set_xlim(place[0], place[-1])
        texts.append(f"{name}, {float(one['layers']):g} layers")
    titles(panels.flat, texts)
    outer(panels, style.SCALED_POSITION, style.PRESSURE)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _sizes(data: xr.Dataset) -> Figure:
    """Differences to the slab against the number of layers: (a) of one load, (b) of the mean over loads."""
    figure, (panels,) = style.figure(1, 2, width="double", height=3.3, sharey=True)
    smoothing = 1, 0  # a load by itself is compared on the scale of the slab, not of the disks
    both = data["single"], data["difference"].sel(solid="free")
    for axes, apart, width in zip(panels, both, smoothing, strict=True):
        for case, (name, look) in enumerate(materials(data["polydispersity"], data["friction"])):
            one = apart.isel(case=case, smoothing=width)
            mean, spread = _mean_and_spread(one)
            count = np.maximum(one.notnull().sum("realization").values, 1)
            look = look | {"markersize": 4}
            layers = data["layers"][case]
            axes.errorbar(layers, mean, 1.96 * spread / np.sqrt(count), label=name, capsize=2.5, **look)
            stored = data["surveyed"].values[case] >= 0.5 * count
            axes.plot(layers[stored], mean[stored], **look | SURVEYED)
        for tolerance in data["tolerance"].values:
            axes.axhline(tolerance, color=style.FAINT, linewidth=0.8, zorder=0)
        sizes = np.unique(data["layers"].values[np.isfinite(data["layers"].values)])
        axes.set(xscale="log", yscale="log", xlabel="layers")
        axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axes.minorticks_off()
    panels[0].set_ylabel("largest difference / largest pressure")
    one_load, mean_load = data["smoothing"].values[list(smoothing)]
    titles(panels, (f"one load, $w$ = {one_load}", f"mean over loads, $w$ = {mean_load}"))
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend([handle[0] for handle in handles], labels, loc="outside lower center", ncols=3)
    return figure


def _lattice(data: xr.Dataset) -> Figure:
    """Measured moduli over the closed form, (a) closed and (b) open horizontal contacts; (c) where two peaks end."""
    figure, ((closed, opened, turn),) = style.figure(1, 3, width="double", height=3.4)
    ratio = data["stiffness_ratio"].values
    for axes, contacts in ((closed, "closed"), (opened, "open")):
        one, names = data.sel(contacts=contacts), []
        for index, name in enumerate("abcd"):
            # b stands around a, which it is equal to where all contacts are closed
            around = {"markersize": 6.5, "markerfacecolor": "none", "markeredgewidth": 0.9} if name == "b" else {}
            look = style.marked_line(index) | {"linestyle": "none", "markersize": 3.5} | around
            axes.plot(ratio, one["moduli"].sel(following="free", modulus=name), **look)
            closed_form = one["closed_form"].sel(rotations="free", modulus=name)
            axes.plot(ratio, closed_form, **style.line(index))
            names.append((f"${name}$", float(ratio[-1]), float(closed_form[-1]), style.line(index)["color"]))
        axes.set(xlabel=f"${style.STIFFNESS_RATIO}$", ylim=(0.0, None), xlim=(0.0, 1.12 * ratio[-1]))
        label_ends(axes, names)
    closed.set_ylabel("moduli $/\\,k_N$")
    for index, body in enumerate(data["body"].values):
        colour = style.COLOURS[index]
        dot = style.marked_line(index) | {"linestyle": "none", "markersize": 5, "markeredgewidth": 0.8}
        for rotations, name, face in (("free", "rotations", colour), ("suppressed", "no rotations", "white")):
            one = data.sel(body=body, rotations=rotations)
            turn.axhline(one["turn_closed_form"], color=colour, linewidth=0.7, linestyle=style.LINE_STYLES[index])
            dot |= {"markerfacecolor": face, "markeredgecolor": colour, "label": f"{body}, {name}"}
            turn.plot([0.0], [float(one["turn"])], **dot)
    look = style.marked_line(3) | {"linestyle": "none", "markersize": 4.5}
    turn.plot(1.0 / data["layers"].values, data["turn_response"], label="lattices under a small force", **look)
    largest = data.isel(size=int(np.argmax(data["layers"].values)))
    ends = [float(data["turn_limit"].sel(estimate="line")), float(largest["turn_response"])]
    turn.plot(
        [0.0, 1.0 / float(largest["layers"])], ends, color=look["color"], linewidth=0.7, linestyle=(0, (1.2, 1.2))
    )
    turn.set(xlabel="1 / layers", ylabel=f"${style.STIFFNESS_RATIO}$ where two peaks end")
    turn.set_xlim(-0.006, None)
    titles((closed, opened, turn), ("horizontal contacts closed", "open", "end of two peaks"))
    figure.legend(*turn.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
