"""The loss of symmetry beside Fig. 16: when, to which side, and what it does to the contacts."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.network import draw_state_changes
from granular_response_paper.captions import WEIGHT, Caption, Datasets, bracket, of_group, of_scene, values
from granular_response_paper.panels import titles, zero

from .parameters import Parameters

STEM = "fig16s_symmetry_breaking"
#: A contact is marked when its tangential force is within this fraction of the Coulomb limit.
MARGIN = 0.05
#: A response is not symmetric from this difference of mirror images on, per largest response, as in Fig. 16.
ASYMMETRIC = 0.2
#: Part of the slab that profiles show, to both sides of the load (radii).
REACH = 30.0
#: The force at which the paper sees the symmetry lost, in mean disk weights (Sec. V.E).
PAPER = 91.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    states, copies = datasets["states"], datasets["copies"]
    figure, axes = style.figure(2, 2, height=4.7)
    _protocols(axes[0, 0], datasets["runs"], datasets["held"], datasets["equal_rows"])
    _copies(axes[0, 1], copies)
    loads = ["symmetric or not", f"a copy and its mirror image, {_load(float(copies['force']))}"]
    handles: dict[str, Any] = {}
    for panel, state in zip(axes[1], (1, 2), strict=True):
        if state >= states.sizes["state"]:  # symmetry is not lost between the forces that were tried
            panel.set_axis_off()
            continue
        handles |= _network(panel, states.isel(state=0), states.isel(state=state))
        loads.append(_load(float(states["force"][state])))
    if handles:
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles))
    titles(axes.flat[: len(loads)], loads, stem=STEM)
    return {STEM: figure}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    forces = sorted(set(datasets["runs"]["force"].values.tolist()))
    return of_group(
        "symmetry_breaking",
        {STEM: of_scene(parameters.scene, force=forces)},
        {STEM: _finding(datasets["runs"])},
        p=parameters,
        least=100.0 * ASYMMETRIC,
    )


def _protocols(panel: Axes, runs: xr.Dataset, held: xr.Dataset, equal_rows: xr.Dataset) -> None:
    """A row for each way to reach a force: grey where the response is symmetric, orange where it is not."""
    rows: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for ramp in sorted(set(runs["ramp_time"].values)):
        one = runs.isel(run=runs["ramp_time"].values == ramp)
        rows[rf"ramp of {ramp:g}$\,{style.TIME_UNIT}$"] = one["force"].values, one["asymmetry"].values > ASYMMETRIC
    shift = _power(float(held["displacement"]))
    rows[f"path, then moved\nby {shift}"] = held["force"].values, held["asymmetry"].values > ASYMMETRIC
    for low, high in zip(equal_rows["low"].values, equal_rows["high"].values, strict=True):
        if np.isfinite(high):
            rows["equal rows,\nbracket"] = np.array([low, high]), np.array([False, True])
    for row, (force, lost) in enumerate(rows.values()):
        for chosen, colour in ((~lost, style.MUTED), (lost, style.VERMILION)):
            face = "white" if colour == style.MUTED else colour
            panel.plot(force[chosen], np.full(int(chosen.sum()), row), "o", color=colour, markersize=5.0,
                       markerfacecolor=face)  # fmt: skip
    panel.set_yticks(range(len(rows)), list(rows), fontsize=7.5)
    panel.set(xlabel=style.FORCE, ylim=(len(rows) - 0.4, -0.9))
    panel.tick_params(axis="y", which="both", length=0.0)
    style.paper_value(panel, PAPER, f"paper: {PAPER:g}", at=0.34, side="behind")
    panel.plot([], [], "o", label="symmetric", markersize=5.0, color=style.MUTED, markerfacecolor="white")
    panel.plot([], [], "o", label="asymmetric", markersize=5.0, color=style.VERMILION)
    panel.legend(loc="upper left", ncols=2, columnspacing=1.0, handletextpad=0.2, borderaxespad=0.2)


def _copies(panel: Axes, copies: xr.Dataset) -> None:
    """Profiles of the last copy, which is the mirror image of the one before, and of that."""
    for k in (-2, -1):
        look = style.marked_line(k % 2) | {"markersize": 2.8}
        name = "copy" if k == -2 else "its mirror image"
        panel.plot(copies["x"], copies["floor_response"].isel(copy=k), label=name, **look)
    zero(panel)
    panel.set(xlabel=style.POSITION, ylabel=style.RESPONSE, xlim=(-REACH, REACH))
    panel.legend(loc="lower right")


def _finding(runs: xr.Dataset) -> str:
    """From which forces on the response is not symmetric."""
    said = []
    for ramp in sorted(set(runs["ramp_time"].values)):
        one = runs.isel(run=runs["ramp_time"].values == ramp)
        force, lost = one["force"].values, one["asymmetry"].values > ASYMMETRIC
        if lost.any():
            kept = force[force < force[lost].min()]
            first = float(force[lost].min())
            ends = bracket(float(kept.max()), first) if kept.size else f"{first:g} {WEIGHT}"
            said.append(f"is lost at {ends} with a ramp of {ramp:g} sqrt(R/g)")
        else:
            said.append(f"is kept up to {force.max():g} {WEIGHT} with a ramp of {ramp:g} sqrt(R/g)")
    return f"Symmetry {values(said)}."


def _network(panel: Axes, rest: xr.Dataset, loaded: xr.Dataset) -> dict[str, Any]:
    """The central third of the contact network, contacts near the Coulomb limit marked; lines for a key by name."""
    limit = (1.0 - MARGIN) * float(rest["friction_coefficient"]) * loaded["contact_normal_force"].values
    drawn = draw_state_changes(panel, rest, loaded, np.abs(loaded["contact_tangential_force"].values) >= limit)
    names = {"sliding": f"within {MARGIN:.0%} of the Coulomb limit"}
    return {names.get(kind, kind): line for kind, line in drawn.items()}


def _load(force: float) -> str:
    return style.equals(style.F_EXT, round(force, 2), style.WEIGHT)


def _power(value: float) -> str:
    """A power of ten as mathematics, another number as it is."""
    exponent = np.log10(value)
    whole = abs(exponent - round(exponent)) < 1e-9
    return rf"$10^{{{exponent:.0f}}}\,{style.RADIUS}$" if whole else rf"${value:g}\,{style.RADIUS}$"
