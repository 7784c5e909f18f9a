"""Figs. 10 and 11: the response under large friction against k_T/k_N, and the spring model that explains it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.paper.groups.stiffness_ratio_crossover.spring_model import draw_spring_model
from granular_response.plot import style

#: Ratios whose simulated profiles are drawn, and those of the elastic bodies; others are in the dataset.
DRAWN = (0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.6, 1.0)
ELASTIC = (0.1, 0.2, 0.3, 0.6)


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig10_stiffness_ratio`` from the datasets of the study of the same name, and ``fig11_spring_model``.

    Fig. 10: (a) simulated profiles; (b) profiles of elastic bodies without horizontal springs; (c) how far the
    profile at x = 0 is below the peaks beside it, with the ratios between which the simulated one changes its
    form.
    """
    response, elastic, events = datasets["response"], datasets["elastic"], datasets["events"]
    figure, ((simulated, bodies, dips),) = style.figure(1, 3, width="double", height=2.85)
    force = float(response["force"])
    available = response["stiffness_ratio"].values
    shown = _among(available, DRAWN)
    colour = dict(zip(shown, style.ordered_colours(len(shown)), strict=True))
    for ratio in shown:
        one = response["floor_response"].sel(stiffness_ratio=ratio)
        simulated.plot(response["x"], one, color=colour[ratio], linestyle="-", linewidth=1.0, label=f"{ratio:g}")
    simulated.legend(title="$k_T/k_N$", loc="upper right", borderaxespad=0.3, handlelength=1.2)
    style.letter(simulated, "a", place="above", text=f"simulation, $F_{{\\mathrm{{ext}}}} = {force:g}\\,mg$")

    profile = elastic["profile"].sel(rotations="free")
    for ratio in _among(available, ELASTIC):
        for body, line in (("smooth floor", "-"), ("half plane", (0, (3, 1.5)))):
            one = profile.sel(body=body).sel(stiffness_ratio=ratio, method="nearest")
            bodies.plot(elastic["x"], one, color=colour[ratio], linestyle=line, linewidth=1.0)
    for name, line in (("slab", "-"), ("half plane", (0, (3, 1.5)))):
        bodies.plot([], [], color=style.MUTED, linestyle=line, linewidth=1.0, label=name)
    bodies.legend(loc="upper right", borderaxespad=0.3)
    style.letter(bodies, "b", place="above", text="elastic, no horizontal springs")

    _draw_dips(dips, response, elastic, events)
    style.letter(dips, "c", place="above", text="depth of the dip")

    reach = min(40.0, float(np.abs(response["x"]).max()))
    top = 1.08 * float(response["floor_response"].max())
    for axes in (simulated, bodies):
        axes.axhline(0.0, color=style.FAINT, linewidth=0.5, zorder=0)
        axes.set(xlabel="$x/R$", xlim=(-reach, reach), ylim=(-0.012 * top / 0.11, top))
    simulated.set_ylabel("$F_z/F_{\\mathrm{ext}}$")
    return {"fig10_stiffness_ratio": figure, **draw_spring_model()}


def _draw_dips(axes: Axes, response: xr.Dataset, elastic: xr.Dataset, events: xr.Dataset) -> None:
    ratio = response["stiffness_ratio"].values
    low, high = float(events["low"].min()), float(events["high"].max())
    axes.axhline(0.0, color=style.FAINT, linewidth=0.5, zorder=0)
    if np.isfinite(high):
        axes.axvspan(low, high, color=style.FAINT, linewidth=0.0, zorder=0)
    dip = elastic["central_dip"].sel(rotations="free")
    fine = elastic["stiffness_ratio"].values
    axes.plot(fine, dip.sel(body="half plane"), **style.line(1), label="half plane")
    axes.plot(fine, dip.sel(body="smooth floor"), **style.line(2), label="slab")
    look = {**style.marked_line(0), "color": style.BLACK}
    axes.plot(ratio, response["central_dip"], **look, label="simulation")
    axes.set(xlabel="$k_T/k_N$", ylabel="dip at $x = 0$ per largest response", xlim=(-0.03, 1.03))
    axes.legend(loc="upper right", borderaxespad=0.3)
    # the same near the crossover, where the differences are small
    inset = axes.inset_axes((0.44, 0.3, 0.53, 0.33))
    near = (ratio >= 0.19) & (ratio <= 0.45)
    close = (fine >= 0.19) & (fine <= 0.45)
    inset.axhline(0.0, color=style.FAINT, linewidth=0.5, zorder=0)
    if np.isfinite(high):
        inset.axvspan(low, high, color=style.FAINT, linewidth=0.0, zorder=0)
    inset.plot(fine[close], dip.sel(body="half plane")[close], **style.line(1))
    inset.plot(fine[close], dip.sel(body="smooth floor")[close], **style.line(2))
    inset.plot(ratio[near], response["central_dip"][near], **look)
    inset.set(xlim=(0.24, 0.41), ylim=(-0.012, 0.045))
    inset.tick_params(labelsize=7)


def _among(available: np.ndarray, wanted: tuple[float, ...]) -> list[float]:
    """Those of ``wanted`` that the dataset has; all that it has if it has none of them."""
    found = [ratio for ratio in wanted if np.any(np.isclose(available, ratio))]
    return found or available.tolist()
