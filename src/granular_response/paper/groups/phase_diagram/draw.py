"""Fig. 22: the force at which one peak becomes two, against friction, for every polydispersity."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from granular_response.plot import style

#: Kinds of a crossover, as stored.
FOUND, BELOW, ABOVE = 0, 1, 2
#: Levels of the thick and of the thin bar.
THICK, THIN = (0.16, 0.84), (0.025, 0.975)
#: Shift along friction that keeps bars of neighbouring polydispersities apart.
SHIFT = 0.014


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig22_phase_diagram`` and ``five_realizations`` from the datasets of the study of the same name."""
    crossovers = datasets["crossovers"]
    usual = crossovers["lattice_constant"].values[0]
    shown = crossovers.isel(case=np.flatnonzero(crossovers["lattice_constant"].values == usual))
    force = shown["force"].values[np.isfinite(shown["force"].values)]
    limits = 0.5 * float(force.min()), 2.5 * float(force.max())
    widths = shown["width"].values
    figure, panels = style.figure(1, len(widths), width="double", height=3.1, sharey=True)
    for index, width in enumerate(widths):
        axes = panels[0, index]
        axes.set(xlabel="$\\mu = \\mu^{\\mathrm{wall}}$", yscale="log", ylim=limits)
        _diagram(axes, shown.isel(width=index), limits)
        style.letter(axes, "abcdefgh"[index], place="above", text=f"$w = {width:g}\\,\\bar R$")
    panels[0, 0].set_ylabel("$F_{\\mathrm{ext}}/mg$")
    panels[0, -1].legend(loc="lower center")
    for text, x, y in (("two peaks", 0.04, 0.93), ("one peak", 0.58, 0.08)):
        panels[0, 0].text(x, y, text, transform=panels[0, 0].transAxes, va="center", style="italic")
    return {"fig22_phase_diagram": figure, "five_realizations": _few(shown, datasets["shapes"])}


def _diagram(axes: Axes, data: xr.Dataset, limits: tuple[float, float]) -> None:
    """A line through the crossovers of each polydispersity; open triangles are bounds, pointing to where it is."""
    deltas = sorted(set(data["polydispersity"].values.tolist()))
    for index, delta in enumerate(deltas):
        here = np.flatnonzero(data["polydispersity"].values == delta)
        here = here[np.argsort(data["friction"].values[here])]
        friction, force, kind = (data[name].values[here] for name in ("friction", "force", "kind"))
        at = friction + SHIFT * (index - 0.5 * (len(deltas) - 1))
        look = style.marked_line(index)
        name = f"$\\delta = {delta:g}$" if delta else "lattice"
        found = kind == FOUND
        axes.plot(at, force, color=look["color"], linestyle=(0, (1.0, 2.0)), linewidth=0.7)  # to the bounds too
        axes.plot(at[found], force[found], color=look["color"], linestyle="-", linewidth=0.9)
        axes.plot([], [], **look, label=name)
        _marks(axes, at, force, kind, look)
        for (low, high), linewidth in ((THIN, 0.6), (THICK, 1.6)):
            ends = (data["interval"].sel(level=level).values[here].clip(*limits) for level in (low, high))
            for x, bottom, top, what in zip(at, *ends, kind, strict=True):
                if what == FOUND and delta:
                    axes.plot([x, x], [bottom, top], color=look["color"], linewidth=linewidth, linestyle="-")


def _marks(axes: Axes, at: NDArray[np.float64], force: NDArray[np.float64], kind: NDArray[np.int8], look: dict) -> None:
    for what, marker in ((FOUND, look["marker"]), (BELOW, "v"), (ABOVE, "^")):
        here = kind == what
        face = look["color"] if what == FOUND else "white"
        axes.plot(
            at[here],
            force[here],
            linestyle="none",
            marker=marker,
            markersize=3.5 if what == FOUND else 5.5,
            markerfacecolor=face,
            markeredgecolor=look["color"],
        )


def _few(shown: xr.Dataset, shapes: xr.Dataset) -> Figure:
    """How often the mean of a few realizations has as many peaks as that of all, near the crossover and off it."""
    figure, panels = style.figure(1, shown.sizes["width"], width="double", height=2.6, sharey=True)
    deltas = [delta for delta in sorted(set(shown["polydispersity"].values.tolist())) if delta]
    all_deltas = sorted(set(shown["polydispersity"].values.tolist()))
    for index, axes in enumerate(panels[0]):
        data = shown.isel(width=index)
        for delta in deltas:
            look = style.marked_line(all_deltas.index(delta))
            cases = np.flatnonzero((data["polydispersity"].values == delta) & (data["kind"].values == FOUND))
            for case in cases:
                force = shapes["applied_force"].values[case] / float(data["force"][case])
                axes.plot(
                    force, shapes["few_agree"].values[index, case], **{**look, "linewidth": 0.6, "markersize": 3.5}
                )
            axes.plot([], [], **look, label=f"$\\delta = {delta:g}$")
        axes.axvline(1.0, color=style.FAINT, linewidth=0.6, zorder=0)
        axes.set(xlabel="force over crossover force", xscale="log", ylim=(0.3, 1.03))
        style.letter(axes, "abcdefgh"[index], place="above", text=f"$w = {float(data['width']):g}\\,\\bar R$")
    panels[0, 0].set_ylabel(f"means of {int(shapes.attrs['few'])} that agree with all")
    panels[0, -1].legend(loc="lower left")
    return figure
