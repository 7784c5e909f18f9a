"""Figs. 10 and 11: the response under large friction against k_T/k_N, and the spring model that explains it."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.groups.stiffness_ratio_crossover.spring_model import draw_spring_model
from granular_response_paper.panels import among, family, note, titles, zero

from .parameters import Parameters

#: Ratios whose simulated profiles are drawn, and those of the elastic bodies; others are in the dataset.
DRAWN = (0.0, 0.1, 0.3, 0.8)
#: Ratios in the panel about the depth of the dip.
NEAR = 0.2, 0.4
#: The crossover of the paper's half plane (Sec. V.C), and that of its simulations (Fig. 10).
PAPER = 0.2915, 0.3


def draw(datasets: Datasets) -> dict[str, Figure]:
    response, elastic, events = datasets["response"], datasets["elastic"], datasets["events"]
    figure, ((simulated, bodies, dips),) = style.figure(1, 3, height=3.1)
    force = float(response["force"])
    shown = among(response["stiffness_ratio"], DRAWN)
    looks = {ratio: look | {"linewidth": 1.2} for ratio, look in family(shown, of="other", marked=False, dashed=True)}
    profile = elastic["profile"].sel(body="smooth floor")
    for ratio in shown:
        curve = response["floor_response"].sel(stiffness_ratio=ratio)
        simulated.plot(response["x"], curve, **looks[ratio])
        solid = profile.sel(stiffness_ratio=ratio, method="nearest")
        bodies.plot(elastic["x"], solid, **looks[ratio])
        for axes, one in ((simulated, curve), (bodies, solid)):
            middle = float(one.values[np.argmin(np.abs(one["x"].values))])
            rim, colour = [withStroke(linewidth=2.0, foreground="white")], looks[ratio]["color"]
            text = {"ha": "center", "fontsize": 8, "color": colour, "path_effects": rim, "zorder": 5}
            note(axes, f"{ratio:g}", (0.0, middle), (0.0, 2.5), **text)
    _draw_dips(dips, response, elastic, events)
    load = f"simulation, {style.equals(style.F_EXT, force, style.WEIGHT)}"
    titles((simulated, bodies, dips), (load, "elastic slab", "depth of the dip"))

    reach = min(40.0, float(np.abs(response["x"]).max()))
    top = 1.17 * float(response["floor_response"].max())  # what the numbers are stands above the curves
    for axes in (simulated, bodies):
        zero(axes)
        axes.set(xlabel=style.POSITION, xlim=(-reach, reach), ylim=(-0.012 * top / 0.11, top))
    simulated.set_ylabel(style.RESPONSE)
    for axes in (simulated, bodies):
        axes.text(0.97, 0.95, f"numbers: ${style.STIFFNESS_RATIO}$", transform=axes.transAxes, ha="right", va="top",
                  fontsize=8)  # fmt: skip
    return {"fig10_stiffness_ratio": figure, **draw_spring_model()}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    events = datasets["events"]
    said = of_scene(parameters.scene, force=parameters.force, stiffness_ratio=parameters.ratios)
    return of_group(
        "stiffness_ratio_crossover",
        {"fig10_stiffness_ratio": said, "fig11_spring_model": {}},
        {"fig10_stiffness_ratio": _finding(events)},
    )


def _finding(events: xr.Dataset) -> str:
    low, high = float(events["low"].min()), float(events["high"].max())
    if not np.isfinite(high):
        return f"The simulated response has two peaks up to k_T/k_N = {low:.3g}."
    return f"The simulated response has two peaks below k_T/k_N = {low:.3g} and one above {high:.3g}."


def _draw_dips(axes: Axes, response: xr.Dataset, elastic: xr.Dataset, events: xr.Dataset) -> None:
    """The depth of the dip near the crossover, where the differences are small."""
    ratio, fine = response["stiffness_ratio"].values, elastic["stiffness_ratio"].values
    low, high = float(events["low"].min()), float(events["high"].max())
    dip = elastic["central_dip"]
    zero(axes)
    if np.isfinite(high):
        axes.axvspan(low, high, color=style.FAINT, linewidth=0.0, zorder=0)
    axes.plot(fine, dip.sel(body="half plane"), **style.line(1), label="half plane")
    axes.plot(fine, dip.sel(body="smooth floor"), **style.line(2), label="elastic slab")
    axes.plot(ratio, response["central_dip"], **{**style.marked_line(0), "color": style.BLACK}, label="simulation")
    axes.set(xlabel=f"${style.STIFFNESS_RATIO}$", ylabel="relative depth of the dip at $x = 0$", xlim=NEAR)
    seen = [np.asarray(line.get_xydata()) for line in axes.get_lines()[1:]]
    drawn = np.concatenate([curve[(curve[:, 0] >= NEAR[0]) & (curve[:, 0] <= NEAR[1]), 1] for curve in seen])
    if drawn.size:
        axes.set_ylim(min(-0.012, 1.1 * drawn.min()), 1.1 * drawn.max())
    axes.legend(loc="upper right", borderaxespad=0.3)
    style.paper_value(axes, PAPER[0], f"half plane {PAPER[0]:g}", at=0.62)
    style.paper_value(axes, PAPER[1], f"paper {PAPER[1]:g}", side="behind", at=0.62)
