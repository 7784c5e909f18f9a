"""Which time steps of the dynamics are stable."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granular_response.plot import style
from granular_response.state import FloatArray
from granular_response_paper.captions import Caption, Datasets, of_group

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
    found = {"stability_steps": _finding(datasets)}
    return of_group("stability", {"stability_steps": {}}, found, p=parameters)


def _finding(datasets: Datasets) -> str:
    """The least step over the limit up to which all settle, of each integrator."""
    least: dict[str, float] = {}
    for name in _studied(datasets):
        for integrator, (low, *_) in _limits(datasets[f"time_step_{name}"], name).items():
            least[integrator] = min(least.get(integrator, np.inf), float(np.min(low, initial=np.inf)))
    said = [f"{integrator.capitalize()} {ratio:.2f}" for integrator, ratio in least.items() if np.isfinite(ratio)]
    return f"Largest time step with which all scenes settle, over the predicted limit: {', '.join(said)}."


def _studied(datasets: Datasets) -> list[str]:
    return [name for name in AXES if f"time_step_{name}" in datasets]


def _steps(datasets: Datasets) -> Figure:
    """A column for each property of the scene, over all of its values: where settling ends, where energy explodes."""
    names = _studied(datasets)
    figure, ((axes,),) = style.figure(height=3.0)
    labels: set[str] = set()
    for column, name in enumerate(names):
        limits = _limits(datasets[f"time_step_{name}"], name)
        for k, (integrator, (low, high, exploding)) in enumerate(limits.items()):
            x, look = column + 0.18 * (k - 0.5 * (len(limits) - 1)), style.marked_line(k)
            label = integrator.capitalize()
            if len(low):
                middle = np.sqrt(low * high)
                axes.plot([x, x], [low.min(), high.max()], color=look["color"], linewidth=1.2, linestyle="-")
                marks = look | {"linestyle": "none", "markersize": 3.5, "label": None if label in labels else label}
                axes.plot(np.full(len(middle), x), middle, **marks)
                labels.add(label)
            if len(exploding):
                axes.plot(x, exploding.min(), marker="x", color=look["color"], markersize=4.5)
    axes.axhline(1.0, color=style.BLACK, linestyle="-", linewidth=0.8, zorder=0, label="predicted limit")
    axes.set(yscale="log", ylabel="time step / limit", xlim=(-0.6, len(names) - 0.4), ylim=(0.7, 5.5))
    axes.set_xticks(range(len(names)), [AXES[name] for name in names])
    axes.set_yticks([1.0, 2.0, 4.0], ["1", "2", "4"])
    axes.minorticks_off()
    axes.tick_params(axis="x", top=False, length=0.0)
    handles, texts = axes.get_legend_handles_labels()
    handles.append(Line2D([], [], linestyle="none", marker="x", color=style.BLACK))
    figure.legend(handles, [*texts, "blows up from here"], loc="outside upper center", ncols=len(handles))
    return figure


def _limits(study: xr.Dataset, name: str) -> dict[str, tuple[FloatArray, FloatArray, FloatArray]]:
    """By integrator: brackets of the steps up to which all settle, over the values of a property, and smallest steps
    that blow up. There is no bracket where the smallest step does not settle, or the largest does.
    """
    ratio, found = study["ratio"].values, {}
    for integrator in study["integrator"].values.tolist():
        outcome = study["outcome"].sel(integrator=integrator).transpose(name, "ratio").values
        settled = np.logical_and.accumulate(outcome == SETTLES, axis=1).sum(axis=1)
        here = settled[(settled > 0) & (settled < len(ratio))]
        exploding = (outcome == BLOWS_UP).argmax(axis=1)[(outcome == BLOWS_UP).any(axis=1)]
        found[integrator] = ratio[here - 1], ratio[here], ratio[exploding]
    return found
