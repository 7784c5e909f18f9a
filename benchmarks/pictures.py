"""Pictures of the stored benchmarks, one function for each JSON file."""

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

#: One colour and marker for each method in all pictures.
METHODS = {
    "path": (style.BLUE, "*"),
    "minimise": (style.BLUE, "*"),
    "beeman": (style.GREEN, "o"),
    "verlet": (style.ORANGE, "s"),
    "leapfrog": (style.SKY, "D"),
    "gear": (style.PURPLE, "^"),
    "dynamics": (style.GREEN, "o"),
    "lammps": (style.VERMILION, "X"),
}
NAMES = {"lammps": "LAMMPS", "path": "load path", "minimise": "minimisation", "gear": "Gear", "dynamics": "dynamics"}


def pick(rows: Iterable[dict[str, Any]], **values: Any) -> Rows:
    """The records that have all these values."""
    return [row for row in rows if all(row.get(key) == value for key, value in values.items())]


def name(method: str) -> str:
    return NAMES.get(method, method.capitalize())


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


def _points(panel: Axes, rows: Rows, x: str, y: str, method: str, label: str, *, open_: bool = False, **line) -> None:
    colour, marker = METHODS[method]
    rows = [row for row in rows if row.get(x) and row.get(y)]
    panel.plot(
        [row[x] for row in rows],
        [row[y] for row in rows],
        marker=marker,
        color=colour,
        markerfacecolor="white" if open_ else colour,
        markersize=8 if marker == "*" else 4.5,
        markeredgewidth=0.8 if open_ else 0.0,
        label=label,
        **{"linestyle": "none", **line},
    )


@style.context()
def precision(metrics: Metrics) -> Figure:
    """Run time against error of the floor response."""
    figure, axes = style.figure(1, 2, height=3.1)
    for panel, reference in zip(axes[0], metrics["references"], strict=True):
        known = reference["reference_change"]  # errors below it, that of the reference itself too, are drawn there
        runs = [{**r, "error": max(r["error"], known)} for r in pick(metrics["runs"], scene=reference["scene"])]
        for method in dict.fromkeys(row["method"] for row in runs):
            mine = pick(runs, method=method)
            if "static_finish" in mine[0]:
                _points(panel, pick(mine, static_finish=True), "seconds", "error", method, name(method))
                text = f"{name(method)}, no static finish"
                _points(panel, pick(mine, static_finish=False), "seconds", "error", method, text, open_=True)
            else:
                _points(panel, mine, "seconds", "error", method, name(method))
        own = [row for row in runs if row.get("error_from_own_limit")]
        _points(panel, own, "seconds", "error_from_own_limit", "lammps", "LAMMPS, from its own limit", open_=True)
        panel.axhline(known, color=style.MUTED, linewidth=0.8, linestyle=":")
        panel.annotate(
            "accuracy of the reference", (1.0, known), (-4, 2), xycoords=("axes fraction", "data"),
            textcoords="offset points", ha="right", fontsize=7, color=style.MUTED,
        )  # fmt: skip
        _logarithmic(panel, xlabel="run time [s]")
        title = style.equals(style.FRICTION, reference["friction"]), style.equals("F", reference["force"], style.WEIGHT)
        panel.set_title(", ".join(title), fontsize=9)
    axes[0, 0].set_ylabel("largest error of the response")
    handles = {}
    for panel in axes[0]:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=4)
    return figure


@style.context()
def kernel(metrics: Metrics) -> Figure:
    """Disk-steps per second against the number of disks."""
    figure, axes = style.figure(1, 2, height=2.6, sharey=True)
    for panel, friction in zip(axes[0], sorted({row["friction"] for row in metrics["runs"]}), strict=True):
        runs = pick(metrics["runs"], friction=friction)
        rate = [row["disk_steps_per_second"] for row in runs]
        panel.plot([row["disks"] for row in runs], rate, "o-", color=METHODS["dynamics"][0], label="ours")
        theirs = [row for row in runs if row["lammps_microseconds"]]
        if theirs:
            rate = [1e6 * row["disks"] / row["lammps_microseconds"] for row in theirs]
            panel.plot([row["disks"] for row in theirs], rate, "X-", color=METHODS["lammps"][0], label="LAMMPS")
        _logarithmic(panel, xlabel="disks")
        panel.set_title("without friction" if friction == 0 else f"friction {friction:g}", fontsize=9)
    axes[0, 0].set_ylabel("disk-steps per second, one core")
    axes[0, 0].legend()
    return figure


@style.context()
def trajectory(metrics: Metrics) -> Figure:
    """Error of trajectories against the time step, with the order of each integrator."""
    figure, axes = style.figure(1, 2, height=2.7)
    titles = {"swing": "a disk swings on the floor", "fall": "a slab with friction falls"}
    for panel, (problem, title) in zip(axes[0], titles.items(), strict=True):
        for method in dict.fromkeys(row["integrator"] for row in metrics["runs"]):
            runs = sorted(pick(metrics["runs"], problem=problem, integrator=method), key=lambda row: row["time_step"])
            (fit,) = pick(metrics["orders"], problem=problem, integrator=method) or [None]
            label = name(method) + (f", order {fit['measured_order']:.1f}" if fit else "")
            _points(panel, runs, "time_step", "error", method, label, linestyle="-")
        _logarithmic(panel, xlabel=f"time step [${style.TIME_UNIT}$]")
        panel.set_title(title, fontsize=9)
        panel.legend()
    axes[0, 0].set_ylabel(f"largest error of positions [${style.RADIUS}$]")
    return figure


@style.context()
def convergence(metrics: Metrics) -> Figure:
    """Difference of dynamics from the quasi-static path against the ramp time."""
    figure, axes = style.figure(1, 1, width=5.2, height=2.9)
    panel = axes[0, 0]
    cases = list(dict.fromkeys((row["friction"], row["force"]) for row in metrics["runs"]))
    for k, (friction, force) in enumerate(cases):
        runs = pick(metrics["runs"], friction=friction, force=force)
        ramps = np.array([row["ramp_time"] for row in runs])
        label = f"{style.equals(style.FRICTION, friction)}, {style.equals('F', force, style.WEIGHT)}"
        panel.plot(ramps, [row["symmetric_difference"] for row in runs], label=label, **style.marked_line(k))
        whole = np.array([row["difference"] for row in runs])
        if (whole > 1.2 * np.array([row["symmetric_difference"] for row in runs])).any():
            panel.plot(ramps, whole, color=style.COLOURS[k], linestyle=":", linewidth=1.0)
    ends = np.array([20.0, 400.0])
    panel.plot(ends, 2e-5 * ends[0] / ends, color=style.MUTED, linestyle="--", linewidth=0.8)
    panel.annotate("1 / ramp time", (60, 4.6e-6), fontsize=7, color=style.MUTED, ha="right")
    _logarithmic(panel, xlabel=f"ramp time [${style.TIME_UNIT}$]", ylabel="difference from the path")
    figure.legend(loc="outside right upper")
    return figure


#: Of old styles of codes.
OLD_MARKS = {"X": "x", "P": "+"}


def _codes(rows: Rows) -> dict[str, dict[str, Any]]:
    """How each code is drawn in all pictures of the arena: ours first, full; styles of one code in one colour."""
    colours = {
        "granular_response": style.GREEN, "LAMMPS": style.VERMILION, "newest LAMMPS": style.ORANGE,
        "LIGGGHTS": style.PURPLE, "YADE": style.SKY,
    }  # fmt: skip
    marks = {"granular_response": "o", "LAMMPS": "X", "newest LAMMPS": "P", "LIGGGHTS": "s", "YADE": "^"}
    drawn = {}
    for code in dict.fromkeys(row["code"] for row in rows):
        family, _, kind = code.partition(", ")
        mark = marks.get(family, "v")
        old = kind in ("hooke/history", "dynamics")
        label = {"granular_response": "ours"}.get(family, family) + (f", {kind}" if kind else "")
        drawn[code] = {
            "color": colours.get(family, style.MUTED), "label": label,
            "marker": OLD_MARKS.get(mark, mark) if old else mark, "linestyle": "--" if old else "-",
            "markerfacecolor": "white" if old else colours.get(family, style.MUTED),
            "markersize": 4.5, "linewidth": 1.0,
        }  # fmt: skip
    return drawn


@style.context()
def arena(metrics: Metrics) -> Figure:
    """Processor time of a step, and peak memory, against the number of disks."""
    figure, axes = style.figure(1, 2, height=3.2)
    drawn = _codes(metrics["runs"])
    for panel, key in zip(axes[0], ("processor_microseconds", "peak_mebibytes"), strict=True):
        for code, look in drawn.items():
            rows = [row for row in pick(metrics["runs"], code=code) if row[key]]
            panel.plot([row["disks"] for row in rows], [row[key] for row in rows], **look)
        text = {"processor_microseconds": "processor time of a step [µs]", "peak_mebibytes": "peak memory [MiB]"}[key]
        _logarithmic(panel, xlabel="disks", ylabel=text)
    style.letter(axes[0, 0], "a", place="above", text="time")
    style.letter(axes[0, 1], "b", place="above", text="memory")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


@style.context()
def responses(metrics: Metrics) -> Figure:
    """Error of the floor response against processor time."""
    scenes = list(dict.fromkeys(row["scene"] for row in metrics["runs"]))
    figure, axes = style.figure(1, len(scenes), height=3.2, sharey=True)
    drawn = _codes(metrics["runs"])
    for panel, scene in zip(axes[0], scenes, strict=True):
        for code, look in drawn.items():
            rows = pick(metrics["runs"], scene=scene, code=code)
            key = "processor" if all(row["processor"] for row in rows) else "seconds"
            panel.plot([row[key] for row in rows], [max(row["error"], LEAST_DRAWN) for row in rows], **look)
        _logarithmic(panel, xlabel="processor time [s]")
        panel.set_title(
            {"friction": "friction 0.2, " + style.equals("F", 15, style.WEIGHT)}.get(
                scene, "no friction, " + style.equals("F", 4, style.WEIGHT)
            ),
            fontsize=9,
        )
    axes[0, 0].set_ylabel("largest error of the response")
    handles = {}
    for panel in axes[0]:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=4)
    return figure


#: Errors below it are drawn there.
LEAST_DRAWN = 1e-7


@style.context()
def bounces(metrics: Metrics) -> Figure:
    """Energy that a disk keeps in a bounce against its angle from the normal."""
    dashpots = list(dict.fromkeys(row["damping_ratio"] for row in metrics["runs"]))
    figure, axes = style.figure(1, len(dashpots), height=3.2, sharey=True)
    drawn = _codes(metrics["runs"])
    for panel, damping in zip(axes[0], dashpots, strict=True):
        for place, (code, look) in enumerate(drawn.items()):
            rows = pick(metrics["runs"], damping_ratio=damping, code=code)
            if code == "granular_response":
                look = {**look, "zorder": 3, "markersize": 3}
            else:  # open, without lines and of growing size: most lie on ours and on each other
                look = {**look, "linestyle": "none", "markerfacecolor": "none", "markersize": 4.0 + 1.3 * place}
            panel.plot([row["angle"] for row in rows], [row["energy_kept"] for row in rows], **look)
        if damping == min(dashpots):
            rows = pick(metrics["runs"], damping_ratio=damping, code="granular_response")
            panel.plot(
                [row["angle"] for row in rows], [row["if_it_slid"] for row in rows], color=style.BLACK, linestyle=":",
                linewidth=1.0, label="slides all the time",
            )  # fmt: skip
        panel.set(xlabel="angle from the normal [°]", xlim=(0, 90), ylim=(0, 1.02))
        panel.set_title(f"dashpots {damping:g} of critical", fontsize=9)
    axes[0, 0].set_ylabel("energy after / before")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


@style.context()
def skipping(metrics: Metrics) -> Figure:
    """How much longer a step takes when an unneeded part is forced on."""
    figure, axes = style.figure(1, 1, height=2.3)
    panel = axes[0, 0]
    again = [{**row, "part": "a second relaxation of a state at rest"} for row in metrics["second_relaxation"]]
    rows = []
    for row in [*metrics["runs"], *again]:
        friction = f"friction {row['friction']:g}" if row["friction"] else "no friction"
        rows.append((f"{row['part']}\n({friction})", row["cost"]))
    place = np.arange(len(rows))[::-1]
    panel.barh(place, [cost for _, cost in rows], color=style.SKY, height=0.6)
    for y, (_, cost) in zip(place, rows, strict=True):
        panel.annotate(f"{cost:.2f}", (cost, y), (3, 0), textcoords="offset points", va="center", fontsize=8)
    panel.axvline(1.0, color=style.BLACK, linewidth=0.8, linestyle="-")
    panel.set_yticks(place, [text for text, _ in rows], fontsize=7)
    panel.set_xlim(0.0, 1.12 * max(cost for _, cost in rows))
    panel.tick_params(axis="y", length=0)
    panel.set_xlabel("time with the part forced on / time without it")
    return figure


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


DRAWN: dict[str, Callable[[Metrics], Figure]] = {
    "precision": precision,
    "kernel": kernel,
    "arena": arena,
    "responses": responses,
    "bounces": bounces,
    "trajectory": trajectory,
    "convergence": convergence,
    "skipping": skipping,
    "scale": scale,
    "depth": depth,
}
