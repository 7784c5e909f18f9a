"""Figs. 10 and 11: the response under large friction against k_T/k_N, and the spring model that explains it."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.groups.stiffness_ratio_crossover.spring_model import draw_spring_model
from granular_response_paper.panels import among, family, note, titles, zero

from .parameters import Parameters

#: Ratios whose simulated profiles are drawn, and those of the elastic bodies; others are in the dataset.
DRAWN = (0.0, 0.1, 0.2, 0.3, 0.6, 1.0)
ELASTIC = (0.1, 0.3, 0.6)
#: The crossover of the paper's half plane (Sec. V.C), and that of its simulations (Fig. 10).
PAPER = 0.2915, 0.3


def draw(datasets: Datasets) -> dict[str, Figure]:
    response, elastic, events = datasets["response"], datasets["elastic"], datasets["events"]
    figure, ((simulated, bodies, dips),) = style.figure(1, 3, height=3.1)
    force = float(response["force"])
    shown = among(response["stiffness_ratio"], DRAWN)
    looks = {ratio: look | {"linewidth": 1.1} for ratio, look in family(shown, of="other", marked=False, dashed=True)}
    for ratio in shown:
        one = response["floor_response"].sel(stiffness_ratio=ratio)
        simulated.plot(response["x"], one, **looks[ratio], label=f"{ratio:g}")

    profile = elastic["profile"].sel(rotations="free")
    marks: dict[str, dict[str, Any]] = {
        "slab": {},
        "half plane": {"marker": "o", "markerfacecolor": "white", "markersize": 3.0, "markevery": 3},
    }
    for ratio in among(shown, ELASTIC):
        for name, body in (("slab", "smooth floor"), ("half plane", "half plane")):
            one = profile.sel(body=body).sel(stiffness_ratio=ratio, method="nearest")
            bodies.plot(elastic["x"], one, **looks[ratio], **marks[name])
    keys = [Line2D([], [], color=style.MUTED, linestyle="-", **marks[name]) for name in marks]
    bodies.legend(keys, list(marks), loc="upper right", borderaxespad=0.3)
    _draw_dips(dips, response, elastic, events)
    load = f"simulation, {style.equals(style.F_EXT, force, style.WEIGHT)}"
    titles((simulated, bodies, dips), (load, "elastic, no horizontal springs", "depth of the dip"))

    reach = min(40.0, float(np.abs(response["x"]).max()))
    top = 1.08 * float(response["floor_response"].max())
    for axes in (simulated, bodies):
        zero(axes)
        axes.set(xlabel=style.POSITION, xlim=(-reach, reach), ylim=(-0.012 * top / 0.11, top))
    simulated.set_ylabel(style.RESPONSE)
    figure.legend(
        *simulated.get_legend_handles_labels(),
        title=f"${style.STIFFNESS_RATIO}$",
        loc="outside upper center",
        ncols=len(shown),
    )
    return {"fig10_stiffness_ratio": figure, **draw_spring_model()}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    events = datasets["events"]
    said = of_scene(parameters.scene, force=parameters.force, stiffness_ratio=parameters.ratios)
    return of_group(
        "stiffness_ratio_crossover",
        {"fig10_stiffness_ratio": said, "fig11_spring_model": {}},
        bracket=f"{float(events['low'].min()):.3g} to {float(events['high'].max()):.3g}",
        paper=PAPER,
    )


def _draw_dips(axes: Axes, response: xr.Dataset, elastic: xr.Dataset, events: xr.Dataset) -> None:
    """The depth of the dip, and below it the same near the crossover, where the differences are small."""
    inset = axes.inset_axes((0.36, 0.25, 0.61, 0.36))
    ratio, fine = response["stiffness_ratio"].values, elastic["stiffness_ratio"].values
    low, high = float(events["low"].min()), float(events["high"].max())
    dip = elastic["central_dip"].sel(rotations="free")
    simulated = {**style.marked_line(0), "color": style.BLACK}
    for panel in (axes, inset):
        zero(panel)
        if np.isfinite(high):
            panel.axvspan(low, high, color=style.FAINT, linewidth=0.0, zorder=0)
        panel.plot(fine, dip.sel(body="half plane"), **style.line(1), label="half plane")
        panel.plot(fine, dip.sel(body="smooth floor"), **style.line(2), label="slab")
        panel.plot(ratio, response["central_dip"], **simulated, label="simulation")
    axes.set(xlabel=f"${style.STIFFNESS_RATIO}$", ylabel="relative depth of the dip at $x = 0$", xlim=(-0.03, 1.03))
    axes.legend(loc="upper right", borderaxespad=0.3)
    inset.set(xlim=(0.24, 0.41), ylim=(-0.012, 0.045))
    inset.tick_params(labelsize=7)
    for value, side in zip(PAPER, ("right", "left"), strict=True):
        style.paper_value(inset, value)
        note(inset, f"{value:g}", (value, inset.get_ylim()[1]), (0.0, 2.0), ha=side, fontsize=7, color=style.PAPER)
