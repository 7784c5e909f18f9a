"""What became of random scenes, how certified results are balanced, and what a small displacement changes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group
from granular_response_paper.panels import titles

from .parameters import Parameters

#: Outcomes of random scenes in the order of their codes.
RANDOM = ("certified", "uncertified", "not settled", "no equilibrium", "time step refused", "scene refused", "wrong")


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``stability_scenes``; the limits of the time step and the energies are numbers of ``numbers.py``."""
    return {"stability_scenes": _scenes(datasets)}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    scenes = datasets["random_scenes"].sizes["scene"]
    return of_group("stability", {"stability_scenes": {}}, p=parameters, scenes=scenes)


def _scenes(datasets: Mapping[str, xr.Dataset]) -> Figure:
    figure, axes = style.figure(1, 3, width="double", height=3.2, width_ratios=[1.1, 1, 1])
    outcomes, residuals, rounding = axes[0]
    study = datasets["random_scenes"]
    code = study["outcome"].values
    count = np.bincount(code, minlength=len(RANDOM)).tolist()
    place = np.arange(len(RANDOM))[::-1]
    bars = outcomes.barh(place, count, color=[style.SKY, style.SKY, *[style.ORANGE] * 4, style.VERMILION])
    for bar in bars[2:]:
        bar.set(hatch="////", edgecolor="white", linewidth=0.0)
    for y, number in zip(place, count, strict=True):
        outcomes.annotate(str(number), (number, y), xytext=(3, 0), textcoords="offset points", va="center", fontsize=8)
    outcomes.set_yticks(place, RANDOM)
    step = 250 if max(count) > 500 else 10
    outcomes.set(xlim=(0, step * np.ceil(1.2 * max(count) / step)), xlabel="random scenes")
    outcomes.tick_params(axis="y", length=0.0)
    certified = study["force_residual"].values[code == 0]
    bins = np.logspace(-16, -3, 53)
    residuals.hist(np.maximum(certified, 1e-16), bins=bins, color=style.SKY)
    residuals.axvline(1e-9, color=style.MUTED, linewidth=0.8, linestyle="--")
    residuals.set(xscale="log", xlim=(1e-16, 1e-4 if certified.max(initial=0.0) < 1e-4 else 1e-2))
    residuals.set_xticks([1e-16, 1e-13, 1e-10, 1e-7, 1e-4])
    residuals.set(xlabel=f"unbalanced force [${style.WEIGHT}$]", ylabel="certified scenes")
    disturbed = datasets["rounding"]
    rows = np.arange(disturbed.sizes["case"])[::-1]
    rounding.plot(disturbed["response_change"].transpose("case", "kick"), rows, "o", color=style.BLUE)
    rounding.axvline(float(disturbed["displacement"]), color=style.MUTED, linewidth=0.8, linestyle="--")
    rounding.set(xscale="log", xlim=(1e-13, 1.0), xticks=[1e-12, 1e-9, 1e-6, 1e-3, 1.0])
    names = [str(case).replace(", ", ",\n", 1) for case in disturbed["case"].values]
    rounding.set_yticks(rows, names, fontsize=7, linespacing=0.9)
    rounding.set(ylim=(-0.7, len(rows) - 0.3), xlabel="change of the response")
    titles(axes.flat)
    return figure
