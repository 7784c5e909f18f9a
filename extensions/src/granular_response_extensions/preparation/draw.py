"""When a growing force does what, for each way to prepare the slab: by friction, and by the contacts at the limit."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import family, outer, titles

from .parameters import Parameters

#: Events in the order of the panels, with what they are called there.
PANELS = {
    "first_opening": "first opening",
    "linear_range": "1 % departure from linearity",
    "reaches_floor": "open region at the floor",
    "crossover": "onset of two peaks",
    "third_peak": "third peak",
    "loss_of_symmetry_path": "loss of symmetry",
}
#: How each way to prepare is named and marked, by how gravity comes; ramps of several times share a colour.
WAYS = {
    "at-once": ("gravity switched on", style.BLUE, "o"),
    "slow": ("gravity ramped over", style.VERMILION, "sDvph"),
    "frictionless": ("prepared frictionless", style.GREEN, "^"),
}
#: Of those whose dashpots are weaker or stronger than those of the first way.
WEAKER, STRONGER = "P", "X"
#: Of those tapped, the gentlest first.
TAPPED = "v*X"
#: Below so many per cent of the contacts, less than one of all, the axis is linear: those without stand there, side by
#: side by their preparation.
LEAST_PART = 0.03


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {
        "preparation": _onsets(datasets["events"]), "preparation_mobilized": _against_mobilized(datasets["mobilized"])
    }  # fmt: skip


def _onsets(events: xr.Dataset) -> Figure:
    """A panel for each event, a row for each slab."""
    slabs = sorted(set(zip(events["wall_friction"].values.tolist(), events["friction"].values.tolist(), strict=True)))
    figure, panels = style.figure(2, 3, height=4.8, sharex=True, sharey=True)
    titles(panels.flat, PANELS.values())
    for axes, name in zip(panels.flat, PANELS, strict=True):
        _event(axes, events.isel(event=np.flatnonzero(events["name"].values == name)), slabs)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.set_ylim(len(slabs) - 0.5, -0.5)
    names = [f"${style.FRICTION} = {mu:g}$" + (", rough walls" if wall else "") for wall, mu in slabs]
    panels[0, 0].set_yticks(range(len(slabs)), names)
    outer(panels, style.FORCE, "")
    handles = {
        text: handle for axes in panels.flat for handle, text in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=4)
    return figure


def _against_mobilized(data: xr.Dataset) -> Figure:
    """A panel for each event: its force against the part of the contacts that are fully mobilized at rest."""
    names = data["name"].values.tolist()
    figure, (panels,) = style.figure(1, len(names), height=3.2, sharex=True, sharey=True)
    titles(panels, [PANELS[name] for name in names])
    part, delta = 100.0 * data["mobilized_part"].isel(margin=0).values, data["polydispersity"].values
    taps, gravity = data["tap_amplitude"].values, data["gravity"].values
    frictions = list(family(np.unique(data["friction"].values), of="friction", marked=False))
    ways = [
        (text.removesuffix(" over"), markers[0], (taps == 0.0) & (gravity == name))
        for name, (text, _, markers) in WAYS.items()
    ]
    ways += [
        (rf"tapped by ${most:g}\,g$", TAPPED[k % len(TAPPED)], taps == most)
        for k, most in enumerate(np.unique(taps[taps > 0.0]))
    ]
    for axes, name in zip(panels, names, strict=True):
        force = data["force"].sel(name=name).values
        axes.axvspan(-LEAST_PART, LEAST_PART, color=style.FAINT, alpha=0.4, linewidth=0.0)
        for friction, look in frictions:
            for place, (_, marker, prepared) in zip(np.linspace(-0.8, 0.8, len(ways)), ways, strict=True):
                beside = np.where(part == 0.0, place * LEAST_PART, part)
                alike = prepared & (data["friction"].values == friction)
                for chosen, face in ((alike & (delta == 0.0), look["color"]), (alike & (delta > 0.0), "none")):
                    axes.plot(
                        beside[chosen], force[chosen], marker=marker, color=look["color"], markerfacecolor=face,
                        markersize=4.5, linestyle="none",
                    )  # fmt: skip
        axes.set_xscale("symlog", linthresh=LEAST_PART)
        axes.set(yscale="log", xlabel="fully mobilized contacts [%]", xlim=(-LEAST_PART, 100.0))
        axes.set_xticks([0.0, 0.1, 1.0, 10.0, 100.0])
        axes.tick_params(axis="x", which="minor", top=False, bottom=False)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_major_formatter("{x:g}")
    panels[0].set_ylabel(style.FORCE)
    shown = [(style.equals(style.FRICTION, mu), {"marker": "s", **look}) for mu, look in frictions]
    shown += [(text, {"marker": marker, "color": style.BLACK}) for text, marker, _ in ways]
    shown += [("disorder", {"marker": "o", "color": style.BLACK, "markerfacecolor": "none"})]
    handles = [Line2D([], [], linestyle="none", markersize=4.5, label=text, **look) for text, look in shown]
    figure.legend(handles=handles, loc="outside lower center", ncols=5)
    return figure


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    frictions = sorted({part.friction for part in parameters.parts})
    said = of_scene(parameters.scene, force=parameters.forces, friction=frictions, wall_friction=None)
    disorder = sorted({part.polydispersity for part in parameters.parts if part.polydispersity})
    return of_group("preparation", {"preparation": said, "preparation_mobilized": said | {"polydispersity": disorder}})


def _event(axes: Axes, events: xr.Dataset, slabs: list[tuple[float, float]]) -> None:
    """A row for each slab: the onset force by every way to prepare it, and how far they lie apart."""
    usual = float(events["damping_ratio"][0])
    ramps = sorted(set(events["ramp_time"].values[events["gravity"].values == "slow"].tolist()))
    for row, (wall, friction) in enumerate(slabs):
        mine = events.isel(event=(events["wall_friction"].values == wall) & (events["friction"].values == friction))
        low, high = mine["low"].values, mine["high"].values
        come = np.isfinite(high)
        # an event at the first force of all has no lower end
        middle = np.where(come, np.sqrt(np.where(low > 0.0, low, high) * np.where(come, high, 1.0)), low)
        axes.plot([middle.min(), middle.max()], [row, row], color=style.FAINT, linewidth=2.0, linestyle="-", zorder=1)
        columns = (mine[name].values.tolist() for name in ("way", "gravity", "ramp_time", "damping_ratio"))
        for force, there, way, gravity, ramp, damping in zip(middle, come, *columns, strict=True):
            name, colour, markers = WAYS[gravity]
            marker = markers[0]
            if gravity == "slow":
                marker, name = markers[ramps.index(ramp) % len(markers)], rf"{name} ${ramp:g}\,{style.TIME_UNIT}$"
            if damping != usual:
                marker, name, colour = STRONGER if damping > usual else WEAKER, way, style.BLACK
            look: dict[str, Any] = {"color": colour, "markersize": 4.0, "linestyle": "none"}
            if there:
                axes.plot(force, row, marker=marker, label=name, **look)
            else:
                axes.plot(force, row, marker=">", markerfacecolor="none", **look)
