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
from granular_response.state import FloatArray
from granular_response_paper.captions import Caption, Datasets, Value, of_group
from granular_response_paper.panels import DASHED, DOTTED, different, family, label_ends, note, packing, titles
from granular_response_paper.survey.crossover import ABOVE, FOUND

from .parameters import Parameters

#: Levels of the thick and of the thin bar.
THICK, THIN = (0.16, 0.84), (0.025, 0.975)
#: Experiments of Sec. VII: from what to what force, in particle weights.
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
#: Markers of the polydispersities, none of which could be an arrow.
MARKERS = ("o", "s", "D", "P")
#: The mark of what goes on beyond the axis.
UPWARDS, DOWNWARDS = r"$\uparrow$", r"$\downarrow$"


def draw(datasets: Datasets) -> dict[str, Figure]:
    shown, shapes, others, realizations = (
        _usual(datasets[name]) for name in ("crossovers", "shapes", "definitions", "realizations")
    )
    return {
        "fig22_phase_diagram": _diagram(shown.isel(width=-1)),
        "crossover_certainty": _certainty(*(one.isel(width=-1) for one in (shown, shapes, others, realizations))),
        "starts": _starts(datasets["starts"]),
    }


def _usual(data: xr.Dataset) -> xr.Dataset:
    """The cases with the initial lattice of the first one."""
    return data.isel(case=data["lattice_constant"].values == data["lattice_constant"].values[0])


def _disorders(data: xr.Dataset) -> list[float]:
    """All polydispersities above 0."""
    return [delta for delta in different(data["polydispersity"]) if delta]


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    crossovers = _usual(datasets["crossovers"])
    frictions, deltas = (different(crossovers[name]) for name in ("friction", "polydispersity"))
    realizations = different(crossovers["realizations"][crossovers["polydispersity"].values > 0.0])
    given: dict[str, Value] = {
        "friction": frictions,
        "wall_friction": frictions,
        "polydispersity": deltas,
        "realizations": realizations or 1,
        "width": parameters.widths[-1],
    }
    last, count = chr(ord("a") - 1 + len(deltas)), len(deltas)
    few = ", ".join(f"({chr(ord('a') + count + k)})" for k in range(len(_disorders(crossovers))))
    return of_group(
        "phase_diagram",
        {
            "fig22_phase_diagram": given,
            "crossover_certainty": given,
            "starts": {"friction": [0.0, 0.2], "polydispersity": _disorders(crossovers), "width": parameters.widths[0]},
        },
        p=parameters,
        last=last,
        few=few,
        tolerances=[100.0 * datasets["definitions"]["tolerance"].values[k] for k in (0, -1)],  # those that are drawn
        dip=100 * parameters.tolerance,
    )


def _diagram(crossovers: xr.Dataset) -> Figure:
    """Fig. 22: the crossover force of every polydispersity in one plane, beside the forces of experiments."""
    figure, ((axes,),) = style.figure(height=3.9)
    axes.set(xlabel=f"${style.BOTH_FRICTIONS}$", ylabel=f"crossover force {style.FORCE}", **_FRICTION_AXES)
    axes.set(xlim=(-0.07, 1.16), ylim=FORCES)
    axes.yaxis.set_major_formatter("{x:g}")
    ends, looks = [], _by_disorder(crossovers)
    for delta, look in looks:
        one = crossovers.isel(case=_of(crossovers, delta))
        friction, force, found = one["friction"].values, one["force"].values, one["kind"].values == FOUND
        low, high = one["interval"].sel(level=list(THICK)).values[found].T
        known = np.isfinite(high)  # a band to an open interval would say how the bound falls between two frictions
        axes.fill_between(
            friction[found], low, np.where(known, high, np.nan), color=look["color"], alpha=0.16, linewidth=0.0
        )
        for x, bottom in zip(friction[found][~known], low[~known], strict=True):
            bar = {"color": look["color"], "linestyle": "-", "linewidth": 1.0, "alpha": 0.6}
            axes.plot([x, x], [bottom, FORCES[1] / 1.15], marker=UPWARDS, markevery=[1], markersize=7.0, **bar)
        axes.plot(friction[found], force[found], **look | {"linewidth": 1.4, "markersize": 4.5})
        ends += [(packing(delta), friction[found][-1], force[found][-1], look["color"])] if found.any() else []
    _bounds(axes, crossovers, looks)
    for text, x, y in (("two peaks\n(hyperbolic-like)", 0.24, 0.83), ("one peak\n(elastic-like)", 0.62, 0.2)):
        axes.text(x, y, text, transform=axes.transAxes, va="center", style="italic", fontsize=10, color=style.MUTED)
    for row, text in enumerate(
        ("paper: rises with friction, falls with disorder", "bands: 68 % of the bootstrap draws")
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
            inwards = (10.0 * row + 4.0) * (-1) ** above
            text, (ha, va) = (f"> {bound:g}", ("right", "top")) if above else (f"≤ {bound:g}", ("left", "bottom"))
            at_edge = {"xycoords": axes.get_xaxis_transform(), "ha": ha, "va": va, "color": look["color"]}
            place = (-5.0 if above else -1.0, inwards)
            note(axes, text, (friction, float(above)), place, fontsize=8, **at_edge)


def _certainty(crossovers: xr.Dataset, shapes: xr.Dataset, others: xr.Dataset, realizations: xr.Dataset) -> Figure:
    """How well each crossover force is known: a column for each polydispersity; keys stand below the lattice."""
    applied = shapes["applied_force"].values
    limits = FORCES[0], 2.0 * float(np.nanmax(applied))
    columns = _by_disorder(crossovers)
    figure, panels = style.figure(2, len(columns), height=4.2, sharey="row")
    handles: dict[str, Any] = {}
    for (delta, look), axes in zip(columns, panels[0], strict=True):
        here = _of(crossovers, delta)
        one, colour = crossovers.isel(case=here), look["color"]
        axes.set(ylim=limits, xlabel=f"${style.BOTH_FRICTIONS}$", **_FRICTION_AXES)
        friction, found = one["friction"].values, one["kind"].values == FOUND
        smallest, largest = np.nanmin(applied[here], axis=1), np.nanmax(applied[here], axis=1)
        handles["forces simulated"] = axes.fill_between(
            friction, smallest, largest, color=SIMULATED, linewidth=0.0, zorder=0
        )
        for width, low, high in ((0.7, *THIN), (2.4, *THICK)):
            ends = one["interval"].sel(level=[low, high]).transpose("level", ...).values
            for x, bottom, top in zip(friction, *ends, strict=True):
                if bottom < top:
                    _bar(axes, x, bottom, top, limits, width, colour)
        axes.plot(friction[found], one["force"].values[found], **look | {"markersize": 4.0})
        if delta:
            ways = others.isel(case=here)
            forces = np.where(
                ways["kind"].transpose("tolerance", ...) == FOUND, ways["force"].transpose("tolerance", ...), np.nan
            )
            for k, edge in ((0, DASHED), (-1, DOTTED)):
                percent = 100.0 * float(ways["tolerance"][k])
                (handles[f"dip of {percent:g} %"],) = axes.plot(
                    friction, forces[k], color=style.MUTED, linestyle=edge, linewidth=0.9
                )
            median = realizations.isel(case=here)["median"].values
            cross: dict[str, Any] = {"linestyle": "none", "marker": "x", "color": style.BLACK, "markersize": 4.0}
            (handles["median of realizations"],) = axes.plot(friction, median, zorder=7, **cross)
        else:
            handles |= _transitions(axes, realizations.isel(case=here), applied[here])
        _bounds(axes, one, [(delta, look)])
    few, keys = _few(panels[1, 1:], crossovers, shapes), panels[1, 0]
    keys.set_axis_off()
    keys.legend(
        [*handles.values(), *few.values()], [*handles, *few], loc="center left", fontsize=7.5, borderaxespad=0.0
    )
    panels[0, 0].set_ylabel(f"crossover force {style.FORCE}")
    panels[1, 1].tick_params(labelleft=True)
    panels[1, 1].set_ylabel(f"fraction of means of {int(shapes['number'][0])}")
    names = [packing(delta) for delta, _ in columns]
    titles([*panels[0], *panels[1, 1:]], [*names, *names[1:]])
    return figure


#: Axes of force against friction.
_FRICTION_AXES: dict[str, Any] = {
    "yscale": "log",
    "xlim": (-0.07, 1.07),
    "xticks": [0.0, 0.2, 0.5, 1.0],
    "xticklabels": ["0", "0.2", "0.5", "1"],
}


def _of(crossovers: xr.Dataset, delta: float) -> NDArray[np.intp]:
    """The cases of a polydispersity in the order of friction."""
    here = np.flatnonzero(crossovers["polydispersity"].values == delta)
    return here[np.argsort(crossovers["friction"].values[here])]


def _transitions(axes: Axes, lattice: xr.Dataset, applied: FloatArray) -> dict[str, Any]:
    """A cross between the last force under which a lattice is symmetric and the first under which it is not, and a star
    for the paper's; keys by name."""
    keys: dict[str, Any] = {}
    look: dict[str, Any] = {"color": style.BLUE, "markersize": 6.0, "zorder": 6, "linestyle": "none"}
    for case in range(lattice.sizes["case"]):
        lost = np.flatnonzero(lattice["asymmetry"].values[case] > ASYMMETRIC)
        if lost.size and lost[0] > 0:
            ends = applied[case, lost[0] - 1 : lost[0] + 1]
            friction = float(lattice["friction"][case])
            axes.plot([friction] * 2, ends, color=style.BLUE, linewidth=1.6, linestyle="-", zorder=6)
            (keys["symmetry lost"],) = axes.plot(friction, np.sqrt(ends.prod()), marker="x", **look)
    star = {**look, "marker": "*", "markerfacecolor": "white"}
    (keys["the same, paper, smooth walls"],) = axes.plot(*SMOOTH_WALLS, **star)
    return keys


def _bar(
    axes: Axes, x: float, low: float, high: float, limits: tuple[float, float], linewidth: float, colour: str
) -> None:
    """An interval in force; an end beyond every simulated force goes to the edge and has an arrow head there."""
    ends = np.clip([low, high], *limits)
    axes.plot([x, x], ends, color=colour, linewidth=linewidth, linestyle="-", solid_capstyle="butt", zorder=3)
    for end, edge, marker in ((low, 1.1 * limits[0], DOWNWARDS), (high, limits[1] / 1.1, UPWARDS)):
        if not np.isfinite(end):
            axes.plot(x, edge, marker=marker, markersize=7.0, color=colour, zorder=6)


def _few(panels: Iterable[Axes], crossovers: xr.Dataset, shapes: xr.Dataset) -> dict[str, Any]:
    """How often the mean of a few realizations has as many peaks as that of all, against the force per crossover force.

    A panel for each polydispersity, a line for each friction; the lines by name.
    """
    looks = dict(family(different(crossovers["friction"]), of="friction"))
    tolerance, few = float(shapes.attrs["tolerance"]), shapes.isel(number=0)
    drawn = {}
    for delta, axes in zip(_disorders(crossovers), panels, strict=True):
        for case in np.flatnonzero(
            (crossovers["polydispersity"].values == delta) & (crossovers["kind"].values == FOUND)
        ):
            friction, row = float(crossovers["friction"][case]), few.isel(case=case)
            two_peaked = row["two_peaked_means"].values
            agree = np.where(row["shape"].values > tolerance, two_peaked, 1.0 - two_peaked)
            force = shapes["applied_force"].values[case] / float(crossovers["force"][case])
            (drawn[friction],) = axes.plot(force, agree, **looks[friction] | {"markersize": 2.8})
        axes.axvline(1.0, color=style.MUTED, linewidth=0.6, linestyle="-", zorder=0)
        axes.set(xscale="log", xlim=(0.03, 8.0), ylim=(0.2, 1.05), xlabel="force / crossover force")
    return {style.equals(style.FRICTION, friction): drawn[friction] for friction in sorted(drawn)}


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
