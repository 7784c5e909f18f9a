"""Which time steps of the dynamics are stable."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from granular_response.plot import style
from granular_response.state import FloatArray
from granular_response_paper.captions import Caption, Datasets, of_group
from granular_response_paper.panels import titles

from .parameters import BLOWS_UP, SETTLES, Parameters

#: Axes of the study of time steps with their labels.
AXES = {
    "normal_stiffness": style.STIFFNESS,
    "stiffness_ratio": f"${style.STIFFNESS_RATIO}$",
    "damping_ratio": r"damping ratio $\zeta$",
    "friction": f"${style.FRICTION}$",
    "wall_friction": f"${style.WALL_FRICTION}$",
    "wall_stiffness": f"{style.STIFFNESS} of walls",
    "polydispersity": f"${style.POLYDISPERSITY}$",
    "load": style.FORCE,
}


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"stability_steps": _steps(datasets)}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    axes = sum(f"time_step_{name}" in datasets for name in AXES)
    return of_group("stability", {"stability_steps": {}}, p=parameters, last=chr(ord("a") + axes - 1))


def _steps(datasets: Datasets) -> Figure:
    """A panel for each property of the scene: where settling ends for each integrator, and where energy explodes."""
    studies = {name: datasets[f"time_step_{name}"] for name in AXES if f"time_step_{name}" in datasets}
    columns = min(4, len(studies))
    rows = -(-len(studies) // columns)
    figure, panels = style.figure(rows, columns, height=0.5 + 1.9 * rows, sharey=True)
    for axes in panels.flat[len(studies) :]:
        axes.set_axis_off()
    for axes, (name, study) in zip(panels.flat, studies.items(), strict=False):
        for k, integrator in enumerate(study["integrator"].values.tolist()):
            outcome = study["outcome"].sel(integrator=integrator).transpose(name, "ratio").values
            shift = 0.22 * (k - 0.5 * (study.sizes["integrator"] - 1))
            _limits(axes, study["ratio"].values, outcome, shift, style.marked_line(k), integrator.capitalize())
        axes.axhline(1.0, color=style.BLACK, linestyle="-", linewidth=0.8, zorder=0, label="predicted limit")
        axes.set(yscale="log", xlabel=AXES[name], xlim=(-0.6, study.sizes[name] - 0.4), ylim=(0.7, 4.6))
        axes.set_xticks(range(study.sizes[name]), [_short(value) for value in study[name].values], rotation=90)
        axes.set_yticks([1.0, 2.0, 4.0], ["1", "2", "4"])
        axes.minorticks_off()
        axes.tick_params(axis="x", top=False, length=2.0)
    titles(panels.flat[: len(studies)])
    for axes in panels[:, 0]:
        axes.set_ylabel("time step / limit")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    handles.append(Line2D([], [], linestyle="none", marker="x", color=style.BLACK))
    figure.legend(handles, [*labels, "blows up from here"], loc="outside upper center", ncols=len(handles))
    return figure


def _limits(
    axes: Axes, ratio: FloatArray, outcome: NDArray[Any], shift: float, look: dict[str, Any], name: str
) -> None:
    """Brackets of the step up to which all settle; a cross at the smallest step that blows up.

    ``outcome`` (value, ratio) are codes of :data:`OUTCOMES` for growing ``ratio``. There is no bracket where the
    smallest step does not settle, or the largest does.
    """
    settled = np.logical_and.accumulate(outcome == SETTLES, axis=1).sum(axis=1)
    here = np.flatnonzero((settled > 0) & (settled < len(ratio)))
    low, high = ratio[settled[here] - 1], ratio[settled[here]]
    middle = np.sqrt(low * high)
    marks = look | {"linestyle": "none", "markersize": 4.5}
    axes.errorbar(here + shift, middle, [middle - low, high - middle], elinewidth=1.2, label=name, **marks)
    for index, row in enumerate(outcome):
        exploding = np.flatnonzero(row == BLOWS_UP)
        if exploding.size:
            axes.plot(index + shift, ratio[exploding[0]], marker="x", color=look["color"], markersize=4.5)


def _short(value: float) -> str:
    exponent = round(np.log10(value)) if value else 0
    return rf"$10^{exponent}$" if exponent > 2 and value == 10.0**exponent else f"{value:g}"
