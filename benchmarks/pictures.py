"""Pictures that the documents show of benchmarks, one function for each JSON file."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from granular_response.plot import style

Metrics = dict[str, Any]
Rows = list[dict[str, Any]]


def pick(rows: Iterable[dict[str, Any]], **values: Any) -> Rows:
    """The records that have all these values."""
    return [row for row in rows if all(row.get(key) == value for key, value in values.items())]


def _logarithmic(panel: Axes, **labels: str) -> None:
    """Two logarithmic axes with labels at 1, 2 and 5 where decades are few, at decades alone otherwise."""
    panel.set(xscale="log", yscale="log", **labels)
    for axis, limits in ((panel.xaxis, panel.get_xlim()), (panel.yaxis, panel.get_ylim())):
        few = limits[1] < 300 * limits[0]
        axis.set_minor_formatter(NullFormatter())
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
        axis.set_major_formatter(FuncFormatter(_power))


def _power(value: float, _: int) -> str:
    """A tick of a logarithmic axis: as it is if short, with a power of ten otherwise."""
    if 0.01 <= value < 1e3:
        return f"{value:g}"
    exponent = int(np.floor(np.log10(value * 1.0001)))
    digit = round(value / 10**exponent)
    return f"$10^{{{exponent}}}$" if digit == 1 else f"${digit}\\times 10^{{{exponent}}}$"


@style.context()
def scale(metrics: Metrics) -> Figure:
    """Processor time, which other work on the machine disturbs less, and memory of whole runs against their disks."""
    figure, axes = style.figure(1, 3, height=2.7)
    labels = {
        "minimise": "no friction, minimisation",
        "path": "friction 0.2, load path",
        "dynamics": "friction 0.2, dynamics",
    }
    looks = {"minimise": (style.SKY, "s"), "path": (style.BLUE, "o"), "dynamics": (style.GREEN, "^")}
    time, memory, local = axes[0]
    for method in dict.fromkeys(row["method"] for row in metrics["runs"]):
        runs = sorted(pick(metrics["runs"], method=method), key=lambda row: row["disks"])
        colour, marker = looks[method]
        for other, processor in enumerate(dict.fromkeys(row["measured_on"] for row in runs)):
            mine = pick(runs, measured_on=processor)
            disks, seconds = (np.array([row[key] for row in mine], dtype=float) for key in ("disks", "cpu_seconds"))
            look = {"color": colour, "marker": marker, "linestyle": "-", "fillstyle": "none" if other else "full"}
            time.plot(disks, seconds, label=None if other else labels[method], **look)
            memory.plot(disks, [row["peak_gibibytes"] for row in mine], **look)
            # one power does not fit all sizes
            between = np.sqrt(disks[1:] * disks[:-1])
            local.plot(between, np.diff(np.log(seconds)) / np.diff(np.log(disks)), **look)
    for panel, text in ((time, "processor time [s]"), (memory, "peak memory [GiB]")):
        _logarithmic(panel, xlabel="disks", ylabel=text)
    local.set(xscale="log", xlabel="disks", ylabel="local exponent of the time", ylim=(0.0, None), xlim=time.get_xlim())
    local.axhline(1.0, color=style.FAINT, linewidth=0.8, linestyle="-", zorder=0)
    figure.legend(*time.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


@style.context()
def depth(metrics: Metrics) -> Figure:
    """Depth and width of the teardrop against the force, a curve for each slab; open where it reaches the floor."""
    figure, axes = style.figure(1, 2, height=2.7)
    slabs = list(dict.fromkeys(row["layers"] for row in metrics["runs"]))
    for place, (layers, colour) in enumerate(zip(slabs, style.ordered_colours(len(slabs), of="length"), strict=True)):
        runs = [row for row in pick(metrics["runs"], layers=layers) if row["depth"] > 0.0]
        drawn = style.marked_line(place, colour=colour)
        for panel, key in zip(axes[0], ("depth", "width"), strict=True):
            panel.plot([row["force"] for row in runs], [row[key] for row in runs], **drawn, label=f"{layers}")
            ends = pick(runs, reaches_floor=1)
            panel.plot(
                [row["force"] for row in ends],
                [row[key] for row in ends],
                linestyle="none",
                marker=drawn["marker"],
                markerfacecolor="white",
                markeredgecolor=colour,
            )
    for panel, key in zip(axes[0], ("depth", "width"), strict=True):
        _logarithmic(panel, xlabel=style.FORCE, ylabel=f"{key} of the region$\\,/\\,{style.RADIUS}$")
    axes[0, 0].legend(title="layers", loc="lower right")
    return figure


DRAWN: dict[str, Callable[[Metrics], Figure]] = {"scale": scale, "depth": depth}
