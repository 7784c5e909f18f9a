"""Fig. 22: the force at which one peak becomes two, against friction, for every polydispersity."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from granular_response.plot import style
from granular_response.scene.lattice import touching_largest
from granular_response_paper.captions import WEIGHT, Caption, Datasets, Value, of_group
from granular_response_paper.panels import different, family, label_ends, note, packing, titles
from granular_response_paper.survey.crossover import ABOVE, CONFIDENCE, FOUND
from granular_response_paper.survey.datasets import usual

from .parameters import Parameters

#: Experiments of Sec. VII: from what to what force, in particle weights.
EXPERIMENTS = (
    ("photoelastic\ndisks, 2D:\nabout 150", 150.0, 150.0),
    ("sand, 3D:\na few", 2.0, 5.0),
    ("FCC and HCP,\n3D: thousands", 2e3, 5e3),
)
#: Forces of the diagram, as in the paper.
FORCES = 0.5, 500.0
#: Distance in friction of symbols of two polydispersities.
APART = 0.012
#: Markers of the polydispersities, none of which could be an arrow.
MARKERS = ("o", "s", "D", "P")
#: The mark of what goes on beyond the axis.
UPWARDS, DOWNWARDS = r"$\uparrow$", r"$\downarrow$"


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {
        "fig22_phase_diagram": _diagram(usual(datasets["crossovers"]).isel(width=-1)),
        "initial_lattice": _starts(datasets["starts"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    crossovers = usual(datasets["crossovers"])
    frictions, deltas = (different(crossovers[name]) for name in ("friction", "polydispersity"))
    realizations = different(crossovers["realizations"][crossovers["polydispersity"].values > 0.0])
    given: dict[str, Value] = {
        "friction": frictions,
        "wall_friction": frictions,
        "polydispersity": deltas,
        "realizations": realizations or 1,
        "width": parameters.widths[-1],
    }
    return of_group(
        "phase_diagram",
        {
            "fig22_phase_diagram": given,
            "initial_lattice": {
                "friction": [0.0, 0.2], "polydispersity": [d for d in deltas if d], "width": parameters.widths[0]
            },
        },
        _findings(crossovers.isel(width=-1), datasets["starts"]),
        dip=100 * parameters.tolerance,
    )  # fmt: skip


def _findings(crossovers: xr.Dataset, starts: xr.Dataset) -> dict[str, str]:
    """What the data show, a sentence for each picture."""
    said = []
    deltas = different(crossovers["polydispersity"])
    for delta in dict.fromkeys((deltas[0], deltas[-1])):
        one = crossovers.isel(case=_of(crossovers, delta))
        known = one["kind"].values == FOUND
        if known.any():
            friction, force = one["friction"].values[known], one["force"].values[known]
            name = f"δ = {delta:g}" if delta else "the lattice"
            rises = f"{force[0]:.2g} {WEIGHT} at µ = {friction[0]:g}"
            said.append(f"{name}: {rises}" + (f" and {force[-1]:.2g} at {friction[-1]:g}" if known.sum() > 1 else ""))
    bare = starts.isel(case=starts["friction"].values == 0.0, width=0)
    rubbed = starts.isel(case=starts["friction"].values > 0.0, width=0)
    spans = [
        float(np.nanmax(one["dip"]) - np.nanmin(one["dip"])) if one.sizes["case"] else np.nan for one in (bare, rubbed)
    ]
    return {
        "fig22_phase_diagram": f"Crossover force of {'; '.join(said)}.",
        "initial_lattice": (
            f"With the initial lattice constant the dip changes by up to {spans[0]:.2g} without friction and by "
            f"{spans[1]:.2g} with it."
        ),
    }


def _diagram(crossovers: xr.Dataset) -> Figure:
    """Fig. 22: the crossover force of every polydispersity in one plane, beside the forces of experiments."""
    figure, ((axes,),) = style.figure(height=3.9)
    axes.set(xlabel=f"${style.BOTH_FRICTIONS}$", ylabel=f"crossover force {style.FORCE}", yscale="log")
    axes.set(xlim=(-0.07, 1.16), ylim=FORCES, xticks=[0.0, 0.2, 0.5, 1.0], xticklabels=["0", "0.2", "0.5", "1"])
    axes.yaxis.set_major_formatter("{x:g}")
    ends, looks = [], _by_disorder(crossovers)
    for k, (delta, look) in enumerate(looks):
        one = crossovers.isel(case=_of(crossovers, delta))
        # side by side, so that bars at one friction do not cover each other
        friction, force = one["friction"].values + APART * (k - 0.5 * (len(looks) - 1)), one["force"].values
        found = one["kind"].values == FOUND
        bars = one["interval"].sel(level=list(CONFIDENCE)).transpose("level", ...).values
        for x, low, high in zip(friction[found], *bars[:, found], strict=True):
            if low < high:
                _bar(axes, x, low, high, FORCES, 0.9, look["color"])
        axes.plot(friction[found], force[found], **look | {"linewidth": 1.4, "markersize": 4.5})
        ends += [(packing(delta), friction[found][-1], force[found][-1], look["color"])] if found.any() else []
    _bounds(axes, crossovers, looks)
    for text, x, y in (("two peaks\n(hyperbolic-like)", 0.24, 0.83), ("one peak\n(elastic-like)", 0.62, 0.2)):
        axes.text(x, y, text, transform=axes.transAxes, va="center", style="italic", fontsize=10, color=style.MUTED)
    for row, text in enumerate(
        ("paper: rises with friction, falls with disorder", "bars: 95 % of the bootstrap draws")
    ):
        colour = style.MUTED if row else style.PAPER
        axes.text(0.985, 0.09 - 0.05 * row, text, transform=axes.transAxes, ha="right", fontsize=8, color=colour)
    label_ends(axes, ends)
    for text, low, high in EXPERIMENTS:
        ends_at = np.clip([low, high], *FORCES)
        look = {"color": style.MUTED, "linestyle": "-", "clip_on": False, "transform": axes.get_yaxis_transform()}
        axes.plot(
            [1.03, 1.03], ends_at, linewidth=3.0, marker=UPWARDS if low > FORCES[1] else "_", markersize=7.0, **look
        )
        label_ends(axes, [(text, 1.03, float(np.sqrt(ends_at.prod())), style.MUTED)], xycoords=look["transform"])
    return figure


def _by_disorder(crossovers: xr.Dataset) -> list[tuple[float, dict[str, Any]]]:
    """Each polydispersity and the look of its curve."""
    deltas = different(crossovers["polydispersity"])
    looks = family(deltas, of="polydispersity")
    return [(delta, look | {"marker": MARKERS[k % len(MARKERS)]}) for k, (delta, look) in enumerate(looks)]


def _bounds(axes: Axes, crossovers: xr.Dataset, looks: Iterable[tuple[float, dict[str, Any]]]) -> None:
    """Crossover forces that are only known to lie below or above a force, as text at the lower or upper edge.

    Of several polydispersities at one friction the texts stand above each other.
    """
    rows: dict[tuple[float, bool], int] = {}
    for delta, look in looks:
        one = crossovers.isel(case=_of(crossovers, delta))
        for friction, bound, what in zip(one["friction"].values, one["force"].values, one["kind"].values, strict=True):
            if what == FOUND:
                continue
            above = what == ABOVE
            row = rows[friction, above] = rows.get((friction, above), -1) + 1
            inwards = (10.0 * row + 8.0) * (-1) ** above
            text, (ha, va) = (f"> {bound:g}", ("right", "center")) if above else (f"≤ {bound:g}", ("left", "center"))
            leader = {"arrowstyle": "-", "color": look["color"], "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 0.0}
            leader |= {"relpos": (float(above), 0.5)}  # to the near end of the text, beside those of other rows
            at_edge = {"xycoords": axes.get_xaxis_transform(), "ha": ha, "va": va, "color": look["color"]}
            place = (-14.0 if above else 14.0, inwards)
            note(axes, text, (friction, float(above)), place, fontsize=8, arrowprops=leader, **at_edge)


def _of(crossovers: xr.Dataset, delta: float) -> NDArray[np.intp]:
    """The cases of a polydispersity in the order of friction."""
    here = np.flatnonzero(crossovers["polydispersity"].values == delta)
    return here[np.argsort(crossovers["friction"].values[here])]


def _bar(
    axes: Axes, x: float, low: float, high: float, limits: tuple[float, float], linewidth: float, colour: str
) -> None:
    """An interval in force; an end beyond every simulated force goes to the edge and has an arrow head there."""
    ends = np.clip([low, high], *limits)
    axes.plot([x, x], ends, color=colour, linewidth=linewidth, linestyle="-", solid_capstyle="butt", zorder=3)
    for end, edge, marker in ((low, 1.1 * limits[0], DOWNWARDS), (high, limits[1] / 1.1, UPWARDS)):
        if not np.isfinite(end):
            axes.plot(x, edge, marker=marker, markersize=7.0, color=colour, zorder=6)


def _starts(starts: xr.Dataset) -> Figure:
    """The dip under one force and the contacts at rest against the start; a column for each polydispersity."""
    deltas = different(starts["polydispersity"])
    frictions = [mu for mu in different(starts["friction"]) if mu <= 0.2 and mu != 0.05]
    figure, panels = style.figure(2, len(deltas), height=4.0, sharex="col", sharey="row")
    names: list[str] = []
    for column, delta in enumerate(deltas):
        touching = touching_largest(delta)
        dips, contacts = panels[:, column]
        for friction, look in family(frictions, of="friction"):
            here = (starts["polydispersity"].values == delta) & (starts["friction"].values == friction)
            one = starts.isel(case=here).sortby("distance")
            for axes, name, data in ((dips, "dip", one.isel(width=0)), (contacts, "contacts", one)):
                value, ends = data[name].values, data[f"{name}_interval"].sel(level=list(CONFIDENCE)).values
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
