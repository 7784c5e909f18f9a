"""Fig. 22: the force at which one peak becomes two, against friction, for every polydispersity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from granular_response.plot import style
from granular_response.scene.lattice import touching_largest
from granular_response.state import FloatArray
from granular_response_paper.captions import Caption, Value, of_group
from granular_response_paper.panels import different, family, label_ends, outer, packing, titles
from granular_response_paper.survey.crossover import ABOVE, FOUND

from .parameters import Parameters

#: Levels of the thick and of the thin bar.
THICK, THIN = (0.16, 0.84), (0.025, 0.975)
#: Experiments of Sec. VII: from what to what force, in particle weights; a caret is beyond the axis.
EXPERIMENTS = (
    ("photoelastic\ndisks, 2D:\nabout 150", 150.0, 150.0),
    ("sand, 3D:\na few", 2.0, 5.0),
    ("FCC and HCP,\n3D: thousands", 2e3, 5e3),
)
#: Forces of the diagram, as in the paper.
FORCES = 0.5, 500.0
#: A response leans visibly from this difference of mirror images on, per largest response.
ASYMMETRIC = 0.01
#: Friction and force at which the paper's lattice beside smooth walls becomes asymmetric (Sec. V.E).
SMOOTH_WALLS = 1.0, 91.0
#: Fill of the forces that were simulated, and that enough packings bear.
SIMULATED = "#EFF2F4"


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """Fig. 22 and what stands behind it, from the datasets of the study of the same name."""
    shown, shapes, others, realizations = (
        _usual(datasets[name]) for name in ("crossovers", "shapes", "definitions", "realizations")
    )
    return {
        "fig22_phase_diagram": _diagram(shown.isel(width=-1)),
        "crossover_intervals": _intervals(shown, shapes, realizations),
        "five_realizations": _few(shown, shapes),
        "peak_definitions": _definitions(shown, others, realizations),
        "starts": _starts(datasets["starts"]),
    }


def _usual(data: xr.Dataset) -> xr.Dataset:
    """The cases with the initial lattice of the first one."""
    return data.isel(case=data["lattice_constant"].values == data["lattice_constant"].values[0])


def _disorders(data: xr.Dataset) -> list[float]:
    """All polydispersities above 0."""
    return [delta for delta in different(data["polydispersity"]) if delta]


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    crossovers = _usual(datasets["crossovers"])
    frictions, deltas = (different(crossovers[name]) for name in ("friction", "polydispersity"))
    rubbing, disordered = [mu for mu in frictions if mu], {"polydispersity": _disorders(crossovers)}
    realizations = different(crossovers["realizations"][crossovers["polydispersity"].values > 0.0])
    given: dict[str, Value] = {
        "friction": frictions,
        "wall_friction": frictions,
        "polydispersity": deltas,
        "realizations": realizations or 1,
        "width": parameters.widths,
    }
    rows = len(parameters.widths)
    last, last_of_few = (chr(ord("a") - 1 + columns * rows) for columns in (len(deltas), len(deltas) - 1))
    return of_group(
        "phase_diagram",
        {
            "fig22_phase_diagram": given | {"width": parameters.widths[-1]},
            "crossover_intervals": given,
            "five_realizations": given | {"friction": rubbing, "wall_friction": rubbing} | disordered,
            "peak_definitions": given | disordered,
            "starts": {"friction": [0.0, 0.2]} | disordered,
        },
        p=parameters,
        last=last,
        last_of_few=last_of_few,
        dip=100 * parameters.tolerance,
    )


def _diagram(crossovers: xr.Dataset) -> Figure:
    """Fig. 22: the crossover force of every polydispersity in one plane, beside the forces of experiments."""
    figure, ((axes,),) = style.figure(width="double", height=3.9)
    axes.set(xlabel=f"${style.BOTH_FRICTIONS}$", ylabel=style.FORCE, **_FRICTION_AXES)
    axes.set(xlim=(-0.05, 1.14), ylim=FORCES)
    axes.yaxis.set_major_formatter("{x:g}")
    ends = []
    deltas = different(crossovers["polydispersity"])
    for k, (delta, look) in enumerate(family(deltas, of="polydispersity")):
        one = crossovers.isel(case=_of(crossovers, delta))
        friction, force, found = one["friction"].values, one["force"].values, one["kind"].values == FOUND
        low, high = one["interval"].sel(level=list(THICK)).values[found].T
        known = np.isfinite(high)  # a band to an open interval would say how the bound falls between two frictions
        axes.fill_between(
            friction[found], low, np.where(known, high, np.nan), color=look["color"], alpha=0.16, linewidth=0.0
        )
        for x, bottom in zip(friction[found][~known], low[~known], strict=True):
            bar = {"color": look["color"], "linestyle": "-", "linewidth": 1.0, "alpha": 0.6}
            axes.plot([x, x], [bottom, FORCES[1] / 1.1], marker="^", markevery=[1], markersize=5.0, **bar)
        axes.plot(friction[found], force[found], **look | {"linewidth": 1.4, "markersize": 4.5})
        ends += [(packing(delta), friction[found][-1], force[found][-1], look["color"])] if found.any() else []
        _bounds(axes, one, look["color"], 0.02 * (k - 0.5 * (len(deltas) - 1)), FORCES)
    for text, x, y in (("two peaks\n(hyperbolic-like)", 0.24, 0.83), ("one peak\n(elastic-like)", 0.62, 0.17)):
        axes.text(x, y, text, transform=axes.transAxes, va="center", style="italic", fontsize=10, color=style.MUTED)
    label_ends(axes, ends)
    for text, low, high in EXPERIMENTS:
        ends_at = np.clip([low, high], *FORCES)
        look = {"color": style.MUTED, "linestyle": "-", "clip_on": False, "transform": axes.get_yaxis_transform()}
        axes.plot([1.03, 1.03], ends_at, linewidth=3.0, marker="^" if low > FORCES[1] else "_", **look)
        label_ends(axes, [(text, 1.03, float(np.sqrt(ends_at.prod())), style.MUTED)], xycoords=look["transform"])
    return figure


def _bounds(axes: Axes, data: xr.Dataset, colour: str, shift: float, limits: tuple[float, float]) -> None:
    """A caret for each crossover force that is only known to lie below or above a force, to the side where it lies."""
    for x, bound, what in zip(data["friction"].values, data["force"].values, data["kind"].values, strict=True):
        if what != FOUND:
            at = float(np.clip(bound, 1.1 * limits[0], limits[1] / 1.1))
            axes.plot(x + shift, at, marker="^" if what == ABOVE else "v", color=colour, markersize=5.0, zorder=5)


def _intervals(crossovers: xr.Dataset, shapes: xr.Dataset, realizations: xr.Dataset) -> Figure:
    """A row for each smoothing width, a column for each polydispersity: 68 and 95 % of the draws."""
    applied = shapes["applied_force"].values
    limits = FORCES[0], 2.0 * float(np.nanmax(applied))
    deltas, widths = different(crossovers["polydispersity"]), crossovers["width"].values.tolist()
    colours = dict(zip(deltas, style.ordered_colours(len(deltas), of="polydispersity"), strict=True))
    figure, panels = _grid(widths, deltas, 0.5 + 1.85 * len(widths), f"${style.BOTH_FRICTIONS}$", style.FORCE)
    for (width, delta), axes in panels.items():
        here = _of(crossovers, delta)
        one, colour = crossovers.sel(width=width).isel(case=here), colours[delta]
        axes.set(ylim=limits, **_FRICTION_AXES)
        friction, found = one["friction"].values, one["kind"].values == FOUND
        smallest, largest = np.nanmin(applied[here], axis=1), np.nanmax(applied[here], axis=1)
        axes.fill_between(friction, smallest, largest, color=SIMULATED, linewidth=0.0, zorder=0)
        axes.plot(friction[found], one["force"].values[found], color=colour, linestyle="-", marker="o", markersize=4.0)
        for levels, linewidth in ((THIN, 0.7), (THICK, 2.4)):
            low, high = one["interval"].sel(level=list(levels)).transpose("level", ...).values
            for x, bottom, top in zip(friction, low, high, strict=True):
                if bottom < top:
                    _bar(axes, x, bottom, top, limits, linewidth, colour)
        _bounds(axes, one, colour, 0.0, limits)
        if not delta:
            _transitions(axes, realizations.sel(width=width).isel(case=here), applied[here])
    return figure


#: Axes of force against friction.
_FRICTION_AXES: dict[str, Any] = {
    "yscale": "log",
    "xlim": (-0.07, 1.07),
    "xticks": [0.0, 0.2, 0.5, 1.0],
    "xticklabels": ["0", "0.2", "0.5", "1"],
}


def _grid(
    widths: Sequence[float], deltas: Sequence[float], height: float, x: str, y: str
) -> tuple[Figure, dict[tuple[float, float], Axes]]:
    """A figure with a row for each smoothing width and a column for each polydispersity, named, and its panels."""
    figure, panels = style.figure(len(widths), len(deltas), width="double", height=height, sharex=True, sharey=True)
    found = dict(zip(product(widths, deltas), panels.flat, strict=True))
    titles(found.values(), [f"{packing(delta)}, $w = {width:g}\\,\\bar R$" for width, delta in found])
    outer(panels, x, y)
    return figure, found


def _of(crossovers: xr.Dataset, delta: float) -> NDArray[np.intp]:
    """The cases of a polydispersity in the order of friction."""
    here = np.flatnonzero(crossovers["polydispersity"].values == delta)
    return here[np.argsort(crossovers["friction"].values[here])]


def _transitions(axes: Axes, lattice: xr.Dataset, applied: FloatArray) -> None:
    """A cross between the last force under which a lattice is symmetric and the first under which it is not."""
    for case in range(lattice.sizes["case"]):
        lost = np.flatnonzero(lattice["asymmetry"].values[case, 0] > ASYMMETRIC)
        if lost.size and lost[0] > 0:
            ends = applied[case, lost[0] - 1 : lost[0] + 1]
            friction = float(lattice["friction"][case])
            axes.plot([friction] * 2, ends, color=style.BLUE, linewidth=1.6, linestyle="-", zorder=6)
            axes.plot(friction, np.sqrt(ends.prod()), marker="x", color=style.BLUE, markersize=6.0, zorder=6)
    axes.plot(*SMOOTH_WALLS, marker="*", color=style.BLUE, markerfacecolor="white", markersize=6.0, zorder=6)


def _bar(
    axes: Axes, x: float, low: float, high: float, limits: tuple[float, float], linewidth: float, colour: str
) -> None:
    """An interval in force; an end beyond every simulated force goes to the edge and has an arrow head there."""
    ends = np.clip([low, high], *limits)
    axes.plot([x, x], ends, color=colour, linewidth=linewidth, linestyle="-", solid_capstyle="butt", zorder=3)
    for end, edge, marker in ((low, limits[0], "v"), (high, limits[1], "^")):
        if not np.isfinite(end):
            axes.plot(x, edge, marker=marker, markersize=5.0, color=colour, zorder=6)


def _few(crossovers: xr.Dataset, shapes: xr.Dataset) -> Figure:
    """How often the mean of a few realizations has as many peaks as that of all, near the crossover and off it.

    A column for each polydispersity, a row for each smoothing width, a line for each friction.
    """
    deltas, widths = _disorders(crossovers), crossovers["width"].values.tolist()
    looks = dict(family(different(crossovers["friction"]), of="friction"))
    tolerance, few = float(shapes.attrs["tolerance"]), shapes.isel(number=0)
    what = f"fraction of means of {int(few['number'])}"
    figure, panels = _grid(widths, deltas, 0.6 + 1.7 * len(widths), "force over crossover force", what)
    drawn = {}
    for (width, delta), axes in panels.items():
        one = crossovers.sel(width=width)
        for case in np.flatnonzero((one["polydispersity"].values == delta) & (one["kind"].values == FOUND)):
            friction = float(one["friction"][case])
            row = few.sel(width=width).isel(case=case)
            two_peaked = row["two_peaked_means"].values
            agree = np.where(row["shape"].values > tolerance, two_peaked, 1.0 - two_peaked)
            force = shapes["applied_force"].values[case] / float(one["force"][case])
            (drawn[friction],) = axes.plot(force, agree, **looks[friction])
        axes.axvline(1.0, color=style.MUTED, linewidth=0.6, linestyle="-", zorder=0)
        axes.set(xscale="log", ylim=(0.2, 1.05))
    lines = {f"$\\mu = {friction:g}$": drawn[friction] for friction in sorted(drawn)}
    figure.legend(list(lines.values()), list(lines), loc="outside upper center", ncols=len(lines))
    return figure


def _definitions(crossovers: xr.Dataset, others: xr.Dataset, realizations: xr.Dataset) -> Figure:
    """Crossovers by what counts as two peaks; found ones alone, those of single realizations beside them."""
    deltas, widths = _disorders(crossovers), crossovers["width"].values.tolist()
    figure, panels = _grid(widths, deltas, 0.6 + 1.7 * len(widths), f"${style.BOTH_FRICTIONS}$", style.FORCE)
    tolerances = [(float(crossovers.attrs["tolerance"]), crossovers)]
    tolerances += [(t, others.sel({"tolerance": t})) for t in others["tolerance"].values.tolist()]
    handles = {}
    for (width, delta), axes in panels.items():
        here = _of(crossovers, delta)
        for (tolerance, data), look in family(sorted(tolerances, key=lambda pair: pair[0]), of="other"):
            one = data.sel(width=width).isel(case=here)
            found = one["kind"].values == FOUND
            friction, force = one["friction"].values[found], one["force"].values[found]
            (handles[f"{tolerance:.3g}"],) = axes.plot(friction, force, **look | {"markersize": 3.0})
        single = realizations.sel(width=width).isel(case=here)
        friction, median = single["friction"].values, single["median"].values
        known = np.isfinite(median)
        cross: dict[str, Any] = {"linestyle": "none", "marker": "x", "color": style.VERMILION, "markersize": 4.0}
        (handles["median of realizations"],) = axes.plot(friction[known], median[known], **cross)
        axes.set(**_FRICTION_AXES)
    figure.legend(list(handles.values()), list(handles), loc="outside upper center", ncols=len(handles), title="dip")
    return figure


def _starts(starts: xr.Dataset) -> Figure:
    """The dip under one force and the contacts at rest against the start; a column for each polydispersity."""
    deltas = different(starts["polydispersity"])
    frictions = [mu for mu in different(starts["friction"]) if mu <= 0.2 and mu != 0.05]
    figure, panels = style.figure(2, len(deltas), width="double", height=4.0, sharex="col")
    names: list[str] = []
    for column, delta in enumerate(deltas):
        touching = touching_largest(delta)
        dips, contacts = panels[:, column]
        for friction, look in family(frictions, of="friction"):
            here = (starts["polydispersity"].values == delta) & (starts["friction"].values == friction)
            one = starts.isel(case=here).sortby("distance")
            for axes, name, data in ((dips, "dip", one.isel(width=0)), (contacts, "contacts", one)):
                value, ends = data[name].values, data[f"{name}_interval"].sel(level=list(THIN)).values
                around = np.abs(ends.reshape(-1, 2).T - value)
                bars = {"markersize": 3.0, "elinewidth": 0.8, "capsize": 2.0, "label": f"$\\mu = {friction:g}$"}
                axes.errorbar(one["distance"].values, value, around, **look | bars)
            force = float(one["applied_force"].values[0])
        for axes in (dips, contacts):
            axes.axvline(touching, color=style.MUTED, linewidth=0.6, linestyle="--", zorder=0)
        dips.axhline(0.0, color=style.FAINT, linewidth=0.6, linestyle="-", zorder=0)
        names.append(f"{packing(delta)}, {style.equals(style.F_EXT, force, style.WEIGHT)}")
        contacts.set_xlabel("initial lattice constant / $\\bar R$")
    titles(panels.flat, [*names, *[""] * len(names)])
    panels[0, 0].set_ylabel("relative depth of the dip")
    panels[1, 0].set_ylabel("coordination number $z$, with walls")
    panels[0, 0].legend(loc="best")
    return figure
