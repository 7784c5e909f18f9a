"""The loss of symmetry beside Fig. 16: when, to which side, and what it does to the contacts."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.network import draw_state_changes
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import family, titles, zero

from .parameters import Parameters

#: A contact is marked when its tangential force is within this fraction of the Coulomb limit.
MARGIN = 0.05
#: A response is not symmetric from this difference of mirror images on, per largest response.
ASYMMETRIC = 0.01
#: Part of the slab that profiles show, to both sides of the load (radii).
REACH = 30.0
#: The force at which the paper sees the symmetry lost, in mean disk weights (Sec. V.E).
PAPER = 91.0
#: Legends stand over their panel.
OVER: dict[str, Any] = {
    "loc": "lower center",
    "bbox_to_anchor": (0.5, 1.11),
    "fontsize": 7.5,
    "labelspacing": 0.2,
    "borderaxespad": 0.0,
}


def draw(datasets: Datasets) -> dict[str, Figure]:
    states, copies = datasets["states"], datasets["copies"]
    with_states = states.sizes["state"] == 3
    rows = 2 if with_states else 1
    figure, axes = style.figure(rows, 2, height=3.3 + 2.3 * (rows - 1), height_ratios=[1.3, 1.0][:rows])
    _protocols(axes[0, 0], datasets["runs"], datasets["held"])
    _copies(axes[0, 1], copies)
    loads = [_lost(datasets["runs"]), f"copies, {_load(float(copies['force']))}"]
    handles: dict[str, Any] = {}
    if with_states:
        for panel, state in zip(axes[1], (1, 2), strict=True):
            handles |= _network(panel, states.isel(state=0), states.isel(state=state))
            loads.append(_load(float(states["force"][state])))
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles))
    titles(axes.flat, loads, stem="fig16s_symmetry_breaking")
    return {"fig16s_symmetry_breaking": figure}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    steps = {step for protocol in parameters.protocols for step in protocol.time_steps}
    contacts = (
        " (e), (f) Contact network at the last symmetric and the first asymmetric force, ramp of "
        f"{parameters.protocols[0].ramp_time:g}."
    )
    forces = sorted(set(datasets["runs"]["force"].values.tolist()))
    return of_group(
        "symmetry_breaking",
        {"fig16s_symmetry_breaking": of_scene(parameters.scene, force=forces)},
        p=parameters,
        ramps=sorted({protocol.ramp_time for protocol in parameters.protocols}),
        steps=(max(steps), min(steps)),
        paper=PAPER,
        contacts=contacts if datasets["states"].sizes["state"] == 3 else "",
    )


def _protocols(panel: Axes, runs: xr.Dataset, held: xr.Dataset) -> None:
    """Asymmetry against force: colours for ramps, full and hollow markers for time steps."""
    ramps = sorted(set(runs["ramp_time"].values))
    steps = sorted(set(runs["time_step"].values), reverse=True)
    hollow: dict[str, Any] = {
        "linestyle": "none", "markersize": 6.0, "markerfacecolor": "none", "markeredgewidth": 0.8,
    }  # fmt: skip
    for ramp, look in family(ramps, of="other"):
        for column, step in enumerate(steps):
            chosen = (runs["ramp_time"].values == ramp) & (runs["time_step"].values == step)
            curve = runs.isel(run=np.flatnonzero(chosen)).sortby("force")
            label = "" if column else rf"gravity, then a ramp of {ramp:g}$\,{style.TIME_UNIT}$"
            panel.plot(curve["force"], curve["asymmetry"], label=label, **look | (hollow if column else {}))
    if len(steps) > 1:
        panel.plot([], [], color=style.MUTED, label=f"open symbols: time step {steps[-1]:g}", **hollow, marker="o")
    cross: dict[str, Any] = {"color": style.BLACK, "linestyle": "none", "marker": "x", "markersize": 4.5}
    text = f"path, then displaced by {_power(float(held['displacement']))}"
    panel.plot(held["force"], held["asymmetry"], label=text, **cross)
    panel.set_yscale("log")
    style.paper_value(panel, PAPER, f"paper: {PAPER:g}", at=0.8)
    panel.set(xlabel=style.FORCE, ylabel="asymmetry of the floor response")
    panel.legend(**OVER)


def _lost(runs: xr.Dataset) -> str:
    """From which force on the response is asymmetric, after the ramps under which that is soonest and latest."""
    lost = runs.isel(run=runs["asymmetry"].values >= ASYMMETRIC).to_dataframe().groupby("ramp_time")["force"].min()
    ends = sorted({float(lost.min()), float(lost.max())}) if len(lost) else []
    return rf"symmetry lost at {' to '.join(f'{force:.0f}' for force in ends)}$\,{style.WEIGHT}$" if ends else ""


def _copies(panel: Axes, copies: xr.Dataset) -> None:
    """Profiles of the copies; those that lie on each other have markers of different size."""
    for k, name in enumerate(copies["name"].values):
        look = style.marked_line(k)
        look |= {"markersize": 2.6} if k < 2 else {"markersize": 5.0, "markerfacecolor": "none"}
        look["markeredgewidth"] = 0.0 if k < 2 else 0.8
        panel.plot(copies["x"], copies["floor_response"].isel(copy=k), label=name, **look)
    zero(panel)
    panel.set(xlabel=style.POSITION, ylabel=style.RESPONSE, xlim=(-REACH, REACH))
    panel.legend(**OVER)


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
