"""Figs. 23 and 24: two forces at once against the sum of each alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.figures import style

#: Forces and realization of the two figures.
FORCES = {"fig23_superposition": 0.2, "fig24_superposition_large": 1.0}
REALIZATION = 0


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig23_superposition`` and ``fig24_superposition_large`` from the datasets of the study of the same name."""
    figures = {}
    for stem, force in FORCES.items():
        with_errors = stem == "fig24_superposition_large"
        figures[stem] = _superposition(datasets, force, with_errors)
    return figures


def _superposition(datasets: Mapping[str, xr.Dataset], force: float, with_errors: bool) -> Figure:
    data = datasets["responses"].isel(realization=REALIZATION)
    distances = data["distance"].values
    rows = (len(distances) + 1) // 2
    extra = 1 if with_errors else 0
    figure, panels = style.figure(
        rows + extra, 2, width="double", height=0.5 + 1.95 * (rows + extra)
    )
    step = int(np.argmin(np.abs(data["force"].values - force)))
    responses = data["floor_response"].values[:, step]
    x = data["x"].values
    order = np.argsort(x)
    arrow = {"arrowstyle": "-|>", "linewidth": 0.8, "color": style.BLACK}
    low, high = min(0.0, responses.min()), responses.max()
    for k, distance in enumerate(distances):
        axes = panels[k // 2, k % 2]
        left, right, both = responses[k][:, order]
        thin = {"linewidth": 0.8, "marker": None}
        axes.plot(x[order], left, **{**style.line(0), **thin}, label="Left")
        axes.plot(x[order], right, **{**style.line(1), **thin}, label="Right")
        axes.plot(x[order], both, color=style.BLACK, linestyle="-", linewidth=1.2, label="(Left+Right)")
        axes.plot(
            x[order], left + right, linestyle="none", marker="o", markersize=3.4, markerfacecolor="none",
            markeredgecolor=style.VERMILION, markeredgewidth=0.8, label="(Left)+(Right)",
        )  # fmt: skip
        for at in data["load_x"].values[k]:
            axes.annotate("", (at, high * 1.0), (at, high * 1.14), arrowprops=arrow)
        axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)
        axes.set(xlim=(-45.0, 45.0), ylim=(1.15 * low if low < 0.0 else -0.03 * high, 1.25 * high))
        style.letter(axes, chr(ord("a") + k), text=f"$d = {distance:g}$ diameters")
        if k % 2 == 0:
            axes.set_ylabel("added floor force / $F_{\\mathrm{ext}}$")
        if k // 2 == rows - 1:
            axes.set_xlabel("$x/R$")
    panels[0, 1].legend(loc="upper right", fontsize=7)
    if with_errors:
        _errors(panels[rows, 0], datasets, "floor_error")
        _errors(panels[rows, 1], datasets, "contact_error")
        for k, (axes, text) in enumerate(zip(panels[rows], ("floor forces", "all contact forces"), strict=True)):
            style.letter(axes, chr(ord("a") + len(distances) + k), text=text)
        panels[rows, 0].set_ylabel("superposition error")
        panels[rows, 1].legend(title="$d$", loc="lower right", fontsize=7, title_fontsize=7, ncols=2)
    return figure


def _errors(axes: Axes, datasets: Mapping[str, xr.Dataset], name: str) -> None:
    """Error against force: geometric mean over realizations thick, each realization thin; end of the linear range."""
    data = datasets["errors"]
    force = data["force"].values
    colours = style.ordered_colours(data.sizes["distance"])
    for k, distance in enumerate(data["distance"].values):
        rows = np.maximum(data[name].values[:, k], 1e-6)
        axes.plot(force, rows.T, color=colours[k], linewidth=0.4, linestyle="-")
        look = {**style.marked_line(k), "color": colours[k]}
        axes.plot(force, np.exp(np.log(rows).mean(axis=0)), **look, label=f"{distance:g}")
    end = float(datasets["linear_range"]["linear_until"][REALIZATION])
    axes.axvline(end, color=style.MUTED, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
    axes.set(xscale="log", yscale="log", xlabel="$F_{\\mathrm{ext}}/mg$", ylim=(1e-4, 2.0))
