"""How much each reading of the paper moves the floor response: a chart for docs/reproduction-notes.md."""

from __future__ import annotations

import re

import numpy as np
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import family, note

from .parameters import Parameters


def draw(datasets: Datasets) -> dict[str, Figure]:
    """Largest difference of the floor response from the reference, for every variant and friction."""
    figure, ((axes,),) = style.figure(height=3.2)
    # powers of ten as such
    texts = [str(text) for text in next(iter(datasets.values()))["text"].values[1:]]
    names = [_named(text) for text in texts]
    # the largest on top; for scale the peak of the response itself
    size = np.max([data["largest_difference"].values[1:] for data in datasets.values()], axis=0)
    places = np.argsort(np.argsort(size))
    for group, look in family(list(datasets), of="friction"):
        label = style.equals(style.FRICTION, float(group.removeprefix("mu_")))
        changes = datasets[group]["largest_difference"].values[1:]
        axes.plot(changes, places, label=label, **look | {"linestyle": "none"})
    axes.set(xscale="log", xlabel=f"largest change of the {style.RESPONSE}", yticks=places)
    axes.set_yticklabels(names)
    axes.grid(axis="y", linewidth=0.3)
    axes.legend(loc="lower right", frameon=True, facecolor="white", edgecolor="none", framealpha=1.0)
    peak = max(float(data["floor_response"].values[0].max()) for data in datasets.values())
    axes.axvline(peak, color=style.FAINT, linewidth=3.5, linestyle="-", zorder=0)
    look = {"xycoords": axes.get_xaxis_transform(), "rotation": 90, "ha": "right", "va": "center", "fontsize": 7}
    note(axes, "peak of the response", (peak, 0.5), (-3.0, 0.0), color=style.MUTED, **look)
    return {"sensitivity": figure}


def _named(text: str) -> str:
    """A variant with the units of its numbers, powers of ten as such."""
    time, energy = f"\\,{style.TIME_UNIT}$", f"\\,{style.ENERGY_UNIT}$"
    text = re.sub(r"gravity grows over (\S+) in place of at once", lambda m: f"gravity ramped over ${m[1]}{time}", text)
    text = re.sub(r"load ramp of (\S+) in place of \S+", lambda m: f"load ramped over ${m[1]}{time}", text)
    return re.sub(r"1e(-?\d+) per disk", lambda m: f"$10^{{{m[1]}}}{energy} per disk", text)


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    said = of_scene(parameters.scene, force=parameters.force, friction=parameters.friction)
    groups = list(datasets)
    first = datasets[groups[0]]
    size = np.max([datasets[name]["largest_difference"].values[1:] for name in groups], axis=0)
    largest, peak = float(size.max()), max(float(one["floor_response"].values[0].max()) for one in datasets.values())
    finding = (
        f"The largest change is {100.0 * largest / peak:.0f} % of the peak of the response "
        f"({first['text'].values[1:][int(size.argmax())]})."
    )
    return of_group("sensitivity", {"sensitivity": said}, {"sensitivity": finding})
