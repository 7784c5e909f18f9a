"""Figs. 3, 4 and 5 and the stiffness study: ordered slabs without friction under a growing force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator

from granular_response.plot import style
from granular_response_paper.captions import WEIGHT, Caption, Datasets, bracket, of_group, of_scene, peaks, values
from granular_response_paper.panels import contact_networks, family, grey_limit, label_ends, note, titles, zero

from .parameters import Parameters

#: Forces of the profiles and of the contact networks; the nearest stored ones are drawn.
PROFILE_FORCES = (0.25, 2.0, 3.0, 3.5, 5.0, 15.0, 50.0)
NETWORK_FORCES = (2.0, 3.0, 5.0)
#: Forces in the panels about stiffness and about the depth of the slab.
STIFFNESS_FORCES = (0.25, 1.0, 2.0, 3.0, 15.0)
TEARDROP_FORCES = (2.0, 3.0)
COMPARED_FORCE = 5.0
#: Slabs whose profiles are compared.
PROFILE_LAYERS = (15, 30, 60)

#: The marker of a region that reaches the floor.
AT_FLOOR: dict[str, Any] = {"linestyle": "none", "markersize": 5.0, "markerfacecolor": "white"}

EVENTS = {
    "first_opening": "first opening",
    "crossover": "one peak to two",
    "teardrop_reaches_floor": "region at the floor",
}
#: What the paper says: first opening (Sec. V.B); the response changes by 2 % between two stiffnesses, and the region
#: saturates from a third one on (Sec. IV.C).
PAPER_OPENING, PAPER_CHANGE, PAPER_STIFFNESSES, PAPER_SATURATION = 0.75, 0.02, (1e3, 1e5), 2e3


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {
        "fig03_frictionless_response": _response(datasets["response"], datasets["events"]),
        "fig04_frictionless_contacts": _contacts(datasets["rest"], datasets["states"]),
        "fig05_teardrop": _teardrop(datasets["sizes"]),
        "fig05b_stiffness": _stiffness(datasets["stiffness"]),
        "fig05c_depth": _slabs(datasets["sizes"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    def drawn(wanted: tuple[float, ...], dataset: str) -> list[float]:
        stored = datasets[dataset]["force"].values
        return stored[nearest(stored, wanted)].tolist()

    depths, stiffnesses = [n for n, _ in parameters.sizes], parameters.size_stiffnesses
    slab = of_scene(parameters.scene)
    deep = {**slab, "normal_stiffness": stiffnesses, "packing": f"slabs of {values(depths)} layers"}
    of_stiffness = {"force": drawn(STIFFNESS_FORCES, "stiffness"), "normal_stiffness": parameters.stiffnesses}
    return of_group(
        "frictionless_crossover",
        {
            "fig03_frictionless_response": {**slab, "force": drawn(PROFILE_FORCES, "response")},
            "fig04_frictionless_contacts": {**slab, "force": drawn(NETWORK_FORCES, "states")},
            "fig05_teardrop": deep,
            "fig05b_stiffness": slab | of_stiffness,
            "fig05c_depth": {**deep, "force": parameters.size_forces},
        },
        _findings(datasets),
        compared=drawn((COMPARED_FORCE,), "sizes"),
    )


def _findings(datasets: Datasets) -> dict[str, str]:
    """What the data show, a sentence for each picture."""
    events, sizes, stiffness = (datasets[name] for name in ("events", "sizes", "stiffness"))
    ends = dict(zip(events["name"].values.tolist(), np.stack([events["low"], events["high"]], axis=1), strict=True))

    def at(name: str) -> str:
        low, high = ends[name]
        return f"at {bracket(low, high)}" if np.isfinite(high) else f"not up to {low:.3g} {WEIGHT}"

    chosen = datasets["states"].isel(force=nearest(datasets["states"]["force"].values, NETWORK_FORCES))
    opened = ((datasets["rest"]["contact_status"].values[0] != 0) & (chosen["contact_status"].values == 0)).sum(axis=1)
    held = np.flatnonzero(stiffness["new_neighbours"].values == 0)
    centre = stiffness["response_at_centre"].values[held]
    last = float(np.nanmax(np.abs(centre[-2] / centre[-1] - 1.0))) if len(held) > 1 else np.nan
    softest = next(iter(_by_stiffness(sizes).values()))
    found = np.nanmean(softest["crossover_bracket"].values, axis=1)
    deep = {int(n): force for n, force in zip(softest["layers"].values, found, strict=True) if np.isfinite(force)}
    least, most = min(deep, default=0), max(deep, default=0)
    reached = softest["reaches_floor"].values.any(axis=1)
    depths = values(softest["layers"].values[reached].tolist()) if reached.any() else "no"
    return {
        "fig03_frictionless_response": f"The single peak of the floor response becomes two {at('crossover')}.",
        "fig04_frictionless_contacts": (
            f"The load opens {values(opened.tolist())} contacts; the region below it reaches the floor "
            f"{at('teardrop_reaches_floor')}."
        ),
        "fig05_teardrop": f"The open region reaches the floor in slabs of {depths} layers (softer disks).",
        "fig05b_stiffness": (
            f"Between the two largest stiffnesses the response at x = 0 changes by {100.0 * last:.1g} % at most."
        ),
        "fig05c_depth": (
            f"Two peaks appear at {deep[least]:.2g} {WEIGHT} in {least} layers, at {deep[most]:.2g} {WEIGHT} in {most}."
            if deep
            else "No slab has two peaks under the forces simulated."
        ),
    }


def nearest(stored: np.ndarray, wanted: Sequence[float]) -> list[int]:
    """Indices of the stored values nearest to the wanted ones, each once."""
    return sorted({int(np.argmin(np.abs(stored - value))) for value in wanted})


def _by_stiffness(slabs: xr.Dataset) -> dict[float, xr.Dataset]:
    """The slabs of each stiffness, the softest first."""
    stiffness = slabs["normal_stiffness"].values
    return {k: slabs.isel(slab=np.flatnonzero(stiffness == k)) for k in np.unique(stiffness).tolist()}


def _stiffness_is(value: float) -> str:
    return style.equals("k_N", value, style.STIFFNESS_UNIT)


def _response(data: xr.Dataset, events: xr.Dataset) -> Figure:
    figure, ((profiles, centre),) = style.figure(1, 2, height=2.7, width_ratios=[1.45, 1.0])
    data = data.isel(floor_disk=np.flatnonzero(data["interior"].values))  # ten radii from the side walls and more
    x = data["x"].values
    chosen = nearest(data["force"].values, PROFILE_FORCES)
    grey_limit(profiles, x, data["floor_response"].values[0])
    for at, (k, look) in enumerate(family(chosen, of="force", dashed=True)):
        one = data.isel(force=k)
        look |= {"markersize": 3.0, "markevery": (at % 3, 3)}
        label = f"{float(one['force']):g}: {peaks(int(one['peak_count']))}"
        profiles.plot(x, one["floor_response"], **look, label=label)
    zero(profiles)
    profiles.set(xlabel=style.POSITION, ylabel=style.RESPONSE, xlim=(x[0], x[-1]))
    profiles.legend(title=style.FORCE, loc="upper right")

    centre.plot(data["force"], data["response_at_centre"], **style.marked_line(0), label="at $x=0$")
    centre.plot(data["force"], data["peak_height"], **style.marked_line(1), label="largest")
    highest = float(data["peak_height"].max())
    for at, (name, low, high) in enumerate(zip(events["name"].values, events["low"], events["high"], strict=True)):
        if np.isfinite(high):
            middle = float(0.5 * (low + high))
            centre.axvline(middle, color=style.MUTED, linewidth=0.6, linestyle=(0, (4, 2)), zorder=0)
            # the last one is close to the one before, so its name goes to the other side
            side, shift = ("left", 2.0) if at == events.sizes["event"] - 1 else ("right", -1.5)
            upright: dict[str, Any] = {"rotation": 90, "ha": side, "va": "top", "fontsize": 7, "color": style.MUTED}
            text, upper = f"{EVENTS[str(name)]}, {middle:.2f}", centre.get_xaxis_transform()
            note(centre, text, (middle, 1.0), (shift, -4.0), xycoords=upper, **upright)
    style.paper_value(centre, PAPER_OPENING, f"paper: opening, {PAPER_OPENING:g}", side="behind")
    centre.set_ylim(0.0, 1.65 * highest)
    centre.set(xscale="log", xlabel=style.FORCE, ylabel=style.RESPONSE)
    centre.xaxis.set_major_formatter("{x:g}")
    centre.legend(loc="lower left", frameon=True, facecolor="white", edgecolor="none", framealpha=1.0)
    titles((profiles, centre))
    return figure


def _contacts(rest: xr.Dataset, states: xr.Dataset) -> Figure:
    loaded = [states.isel(force=k) for k in nearest(states["force"].values, NETWORK_FORCES)]
    names = [style.equals(style.F_EXT, float(one["force"]), style.WEIGHT) for one in loaded]
    return contact_networks(rest.isel(state=0), loaded, names, height=2.05)


def _teardrop(sizes: xr.Dataset) -> Figure:
    each = _by_stiffness(sizes)
    figure, panels = style.figure(len(each), 2, height=0.3 + 2.2 * len(each), sharex=True)
    for (deep, wide), slabs in zip(panels, each.values(), strict=True):
        for axes, name, label in ((deep, "teardrop_depth", style.DEPTH), (wide, "teardrop_width", style.WIDTH)):
            _growth(axes, slabs, name)
            axes.set_ylabel(label)
    handles, names = panels[-1, -1].get_legend_handles_labels()
    handles.append(Line2D([], [], color=style.MUTED, **AT_FLOOR, marker="o"))
    panels[-1, -1].legend(handles, [*names, "open: at the floor"], title="layers", loc="lower right")
    for axes in panels[-1]:
        axes.set(xlabel=style.FORCE)
    for axes in panels.flat:
        style.logarithmic(axes)
        axes.minorticks_off()
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter("{x:g}")
    titles(panels.flat, [_stiffness_is(k) for k in each for _ in range(2)])
    return figure


def _growth(axes: Axes, slabs: xr.Dataset, name: str) -> None:
    """A measure of the teardrop against the force, up to where it reaches the floor (open marker)."""
    for at, look in family(range(slabs.sizes["slab"]), of="length"):
        one = slabs.isel(slab=at)
        reached = np.flatnonzero(one["reaches_floor"].values > 0)
        end = int(reached[0]) + 1 if len(reached) else one.sizes["force"]
        force, values = one["force"].values[:end], one[name].values[:end]
        force, values = force[values > 0.0], values[values > 0.0]
        axes.plot(force, values, **look, label=f"{int(one['layers'])}")
        if len(reached):
            axes.plot(force[-1:], values[-1:], **AT_FLOOR, marker=look["marker"], color=look["color"], zorder=4)


def _stiffness(data: xr.Dataset) -> Figure:
    figure, ((centre, size, events),) = style.figure(1, 3, height=2.5)
    k = data["normal_stiffness"].values
    held = data["new_neighbours"].values == 0

    for index, look in family(nearest(data["force"].values, STIFFNESS_FORCES), of="force"):
        response = data["response_at_centre"].isel(force=index).values
        centre.plot(k[held], (response / response[-1])[held], **look, label=f"{data['force'].values[index]:g}")
    low, high = PAPER_STIFFNESSES
    centre.fill_between(
        [low, high], 1.0 - PAPER_CHANGE, 1.0 + PAPER_CHANGE, color=style.PAPER_BAND, linewidth=0.0, zorder=0
    )
    said = f"paper: {PAPER_CHANGE:.0%}".replace("%", " %")
    note(centre, said, (high, 1.0 + PAPER_CHANGE), (0.0, 1.5), ha="right", fontsize=7, color=style.PAPER)
    centre.set_ylabel("response at $x = 0$ / stiffest")
    centre.legend(title=style.FORCE, loc="upper right")

    ends = []
    for index, look in family(nearest(data["force"].values, TEARDROP_FORCES), of="force"):
        force = style.equals(style.F_EXT, data["force"].values[index], style.WEIGHT)
        for name, dash in (("depth", "-"), ("width", (0, (4, 1.5)))):
            values = data[f"teardrop_{name}"].isel(force=index).values[held]
            size.plot(k[held], values, **look | {"linestyle": dash})
            ends.append((f"{name}, {force}", float(k[held][-1]), float(values[-1]), look["color"]))
    size.set_ylabel(f"size of the region$\\,/\\,{style.RADIUS}$")
    style.paper_value(size, PAPER_SATURATION, f"paper: {PAPER_SATURATION:g}", at=0.3)

    for at, (name, label) in enumerate(EVENTS.items()):
        bracket = data[f"{name}_bracket"].values
        known = held & np.isfinite(bracket).all(axis=1)
        events.plot(k[known], bracket[known].mean(axis=1), **style.marked_line(at), label=label)
    events.set(ylabel=f"onset force, {style.FORCE}", ylim=(0.0, 1.35 * events.get_ylim()[1]))
    events.legend()
    for axes in (centre, size, events):
        axes.set(xscale="log", xlabel=style.STIFFNESS)
    size.set_ylim(top=1.15 * size.get_ylim()[1])
    label_ends(size, ends[:2], ha="right", va="top")  # right above them lies the width under the larger force
    label_ends(size, ends[2:], ha="right", va="bottom")
    titles((centre, size, events), stem="fig05b_stiffness")
    return figure


def _slabs(sizes: xr.Dataset) -> Figure:
    figure, ((profiles, events),) = style.figure(1, 2, height=2.9)
    each = _by_stiffness(sizes)
    softest, slabs = next(iter(each.items()))
    at_force = slabs.isel(force=nearest(slabs["force"].values, [COMPARED_FORCE])[0])
    shown = [at for at in range(slabs.sizes["slab"]) if int(slabs["layers"][at]) in PROFILE_LAYERS]
    for at, look in family(shown or range(slabs.sizes["slab"]), of="length", marked=False, dashed=True):
        one = at_force.isel(slab=at)
        height = 2.0 + np.sqrt(3.0) * (float(one["layers"]) - 1.0)
        seen = np.abs(one["x"].values) <= 1.5 * height
        x, response = one["x"].values[seen] / height, one["floor_response"].values[seen] * height
        profiles.plot(x, response, **look, label=f"{int(one['layers'])}")
    label = f"{style.RESPONSE}$\\,\\times\\,h/{style.RADIUS}$"
    profiles.set(xlabel=style.SCALED_POSITION, ylabel=label, xlim=(-1.5, 1.5))
    profiles.legend(title="layers", loc="upper right")

    hollow = {"markeredgewidth": 0.8, "markerfacecolor": "white"}
    for (stiffness, slabs), face in zip(each.items(), (hollow, {}), strict=False):  # colours as in (g)
        for at, name in list(enumerate(EVENTS))[1:]:
            bracket = slabs[f"{name}_bracket"].values
            known = np.isfinite(bracket).all(axis=1)
            label = f"{EVENTS[name]}, {_stiffness_is(stiffness)}"
            middle = bracket[known].mean(axis=1)
            events.plot(slabs["layers"].values[known], middle, label=label, **style.marked_line(at) | face)
    events.set(xlabel="layers", ylabel=f"onset force, {style.FORCE}")
    events.set_ylim(0.0, 1.4 * events.get_ylim()[1])
    events.legend(loc="upper left")
    load = f"{style.equals(style.F_EXT, float(at_force['force']), style.WEIGHT)}, {_stiffness_is(softest)}"
    titles((profiles, events), (load, ""), stem="fig05c_depth")
    return figure
