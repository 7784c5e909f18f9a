"""Figs. 6 to 9, 12 and 16: the response of a slab with friction, and what the force does to its contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.network import draw_state_changes
from granular_response.state import SLIDING
from granular_response_paper.captions import WEIGHT, Caption, of_group, of_scene, panels
from granular_response_paper.panels import among, family, titles, zero

from .parameters import Parameters

#: Forces of the profiles (Fig. 7), of the pictures of contacts (Figs. 8 and 9) and of the large forces (Fig. 16).
PROFILE_FRICTIONS, PROFILE_FORCES = (0.2, 1.0), (4.0, 10.0, 20.0, 30.0, 50.0)
LARGE_FRICTION = 0.2
CONTACT_FORCES = (6.0, 12.0, 20.0)
CONTACTS = ((0.2, "fig08_contacts_mu02"), (1.0, "fig09_contacts_mu1"))
LARGE_FORCES = (20.0, 30.0, 40.0, 60.0, 80.0)
DYNAMIC_FORCES = (91.0, 93.0, 95.0, 100.0)
#: Frictions of Fig. 12.
AXIS_FRICTIONS = (0.0, 0.1, 0.15, 0.2, 0.5, 1.0)

#: Part of the slab that profiles show, to both sides of the load (radii): beyond it the walls matter.
REACH = 40.0

#: Symbols of a profile stand at every so many disks; half of the width of the enlarged part of Fig. 7b.
SPREAD, CLOSE = 3, 8.0

#: What the paper says, in mean disk weights: forces that open the first contact, by friction (Sec. V.B), crossover and
#: third peak at friction 0.2, and the last symmetric response at friction 1 (Sec. V.E).
PAPER_OPENINGS = {0.0: 0.75, 0.2: 4.0, 1.0: 6.0}
PAPER_CROSSOVER, PAPER_THIRD_PEAK, PAPER_SYMMETRIC = 20.0, 40.0, 91.0


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """Figures by file stem, from the datasets of the study of the same name."""
    response = datasets["response"]
    figures = {
        "fig06_linear_range": _linear_range(response),
        "fig12_friction_crossover": _friction_axis(datasets["friction_axis"]),
    }
    stored = response["friction"].values
    if np.isin(PROFILE_FRICTIONS, stored).all():
        figures["fig07_friction_response"] = _profiles(response)
    for friction, stem in CONTACTS:
        states = datasets.get(f"states_mu_{friction:g}")
        if states is not None:
            figures[stem] = _contacts(states, friction)
    if "large_forces" in datasets and LARGE_FRICTION in stored:
        figures["fig16_large_forces"] = _large_forces(response, datasets["large_forces"])
    return figures


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    response, scene = datasets["response"], parameters.scene
    frictions = response["friction"].values.tolist()
    axis = among(datasets["friction_axis"]["friction"], AXIS_FRICTIONS)
    given = {
        "fig06_linear_range": of_scene(scene, force=response["force"].values.tolist(), friction=frictions),
        "fig12_friction_crossover": of_scene(scene, force=parameters.friction_axis.force, friction=axis),
    }
    fields: dict[str, Any] = {"crossover": PAPER_CROSSOVER, "third": PAPER_THIRD_PEAK, "symmetric": PAPER_SYMMETRIC}
    fields["stops"] = "".join(
        f" µ = {end.friction:g} is computed up to {end.force:g} {WEIGHT} only." for end in parameters.ends
    )
    if np.isin(PROFILE_FRICTIONS, frictions).all():
        force = at_forces(response.sel(friction=0.2), PROFILE_FORCES)["force"].values.tolist()
        given["fig07_friction_response"] = of_scene(scene, force=force, friction=list(PROFILE_FRICTIONS))
    if "large_forces" in datasets and LARGE_FRICTION in frictions:
        dynamic = datasets["large_forces"]
        beyond = at_forces(dynamic, DYNAMIC_FORCES)["force"].values.tolist()
        left = at_forces(response.sel(friction=LARGE_FRICTION), LARGE_FORCES)["force"].values.tolist()
        given["fig16_large_forces"] = of_scene(
            scene, force=sorted({*left, *beyond}), friction=[0.2, float(dynamic["friction"])]
        )
        fields |= {"left": left, "beyond": beyond}
    found = of_group("friction_linear_range", given, **fields)
    for friction, stem in CONTACTS:
        if f"states_mu_{friction:g}" in datasets:
            shown = contact_forces(datasets[f"states_mu_{friction:g}"])
            said = {stem: of_scene(scene, force=shown, friction=friction)}
            found |= of_group("friction_linear_range", said, friction=friction, panels=panels(shown))
    return found


def _linear_range(response: xr.Dataset) -> Figure:
    """Fig. 6."""
    figure, axes = style.figure(height=3.0)
    panel = axes[0, 0]
    frictions = response["friction"].values
    for friction, look in family(frictions, of="friction"):
        curve = response["response_at_centre"].sel(friction=friction).dropna("force")
        panel.plot(curve["force"], curve, label=f"{friction:g}", **look | {"markersize": 3.0})
    panel.set_xscale("log")
    panel.xaxis.set_major_formatter("{x:g}")
    panel.set_ylim(bottom=0.0, top=1.1 * float(response["response_at_centre"].max()))
    for friction, force in PAPER_OPENINGS.items():
        name = f"paper, $\\mu = {friction:g}$: {force:g}"
        style.paper_value(panel, force, name, side="behind" if force == max(PAPER_OPENINGS.values()) else "before")
    panel.set(xlabel=style.FORCE, ylabel=style.RESPONSE_AT_CENTRE)
    panel.legend(title=f"${style.FRICTION}$", loc="lower left", ncols=2, columnspacing=1.0)
    return figure


def _profiles(response: xr.Dataset) -> Figure:
    """Fig. 7."""
    figure, axes = style.figure(1, 2, width="double", height=2.7, sharey=True)
    extents = []
    titles(axes[0], [style.equals(style.FRICTION, friction) for friction in PROFILE_FRICTIONS])
    for panel, friction in zip(axes[0], PROFILE_FRICTIONS, strict=True):
        curves = at_forces(response.sel(friction=friction), PROFILE_FORCES)
        extents.append(_plot_profiles(panel, curves, _labels(curves["force"]), style.FORCE))
        if friction == 1.0:
            _enlarge(panel, curves)
        else:
            style.paper_note(panel, f"paper:\n{PAPER_CROSSOVER:g} crossover")
    _fit(axes[0, 0], *extents)
    axes[0, 0].set_ylabel(style.RESPONSE)
    return figure


def _friction_axis(axis: xr.Dataset) -> Figure:
    """Fig. 12."""
    figure, axes = style.figure(height=2.6)
    curves = axis.sel(friction=among(axis["friction"], AXIS_FRICTIONS))
    _fit(axes[0, 0], _plot_profiles(axes[0, 0], curves, _labels(curves["friction"]), f"${style.FRICTION}$"))
    axes[0, 0].set_ylabel(style.RESPONSE)
    return figure


def _large_forces(response: xr.Dataset, dynamic: xr.Dataset) -> Figure:
    """Fig. 16; the profile at the largest symmetric force of (b) is followed by those beyond the instability."""
    figure, axes = style.figure(1, 2, width="double", height=2.9)
    left, right = axes[0]
    curves = at_forces(response.sel(friction=LARGE_FRICTION), LARGE_FORCES)
    _fit(left, _plot_profiles(left, curves, _labels(curves["force"]), style.FORCE))
    style.paper_note(left, f"paper:\n{PAPER_CROSSOVER:g} crossover\n{PAPER_THIRD_PEAK:g} third peak")
    curves = at_forces(dynamic, DYNAMIC_FORCES)
    _fit(right, _plot_profiles(right, curves, _labels(curves["force"]), style.FORCE, categorical=True))
    style.paper_note(right, f"paper:\n{PAPER_SYMMETRIC:g} symmetric")
    titles(axes[0], [style.equals(style.FRICTION, friction) for friction in (0.2, float(dynamic["friction"]))])
    zero(right)
    for panel in (left, right):
        panel.set_ylabel(style.RESPONSE)
    return figure


def _labels(values: xr.DataArray) -> list[str]:
    return [f"{value:g}" for value in values.values]


def contact_forces(states: xr.Dataset) -> list[float]:
    """The forces of Figs. 8 and 9 as far as they are stored, else the first ones."""
    stored = states["force"].values.tolist()
    return [force for force in CONTACT_FORCES if force in stored] or stored[1:4]


def at_forces(dataset: xr.Dataset, forces: Sequence[float]) -> xr.Dataset:
    """The given forces as far as they are stored; all of them if none is."""
    stored = dataset.dropna("force", subset=["response_at_centre"])
    return stored.sel(force=among(stored["force"], forces))


def _plot_profiles(
    panel: Axes, curves: xr.Dataset, labels: Sequence[str], title: str, *, categorical: bool = False
) -> tuple[float, float]:
    """Response against position, one curve for each label along the dimension that is not the floor's.

    Returns the smallest and the largest response shown.
    """
    dimension = next(str(dim) for dim in curves["floor_response"].dims if dim != "floor_disk")
    # symbols at other disks for each curve, and dashes, so that curves which cover each other are all seen
    for index, (label, look) in enumerate(family(labels, dashed=True)):
        look |= {"markersize": 3.2, "markevery": (index % SPREAD, SPREAD)}
        if categorical:
            look |= {"color": style.line(index)["color"]}
        panel.plot(curves["x"], curves["floor_response"].isel({dimension: index}), label=label, **look)
    panel.set(xlabel=style.POSITION, xlim=(-REACH, REACH))
    panel.legend(title=title, loc="upper right", handlelength=2.8)
    shown = curves["floor_response"].where(abs(curves["x"]) <= REACH)
    return float(shown.min()), float(shown.max())


def _fit(panel: Axes, *extents: tuple[float, float]) -> None:
    """Limits of the vertical axis that leave a margin around all ``extents``."""
    low, high = min(low for low, _ in extents), max(high for _, high in extents)
    panel.set_ylim(low - 0.06 * (high - low), high + 0.06 * (high - low))


def _enlarge(panel: Axes, curves: xr.Dataset) -> None:
    """The tops of curves that nearly cover each other, in the upper left corner."""
    inside = panel.inset_axes((0.09, 0.5, 0.28, 0.46))
    near = curves.isel(floor_disk=np.flatnonzero(np.abs(curves["x"].values) <= CLOSE))
    for top, look in family(near["floor_response"].values, dashed=True):
        inside.plot(near["x"], top, **look | {"markersize": 2.6})
    inside.set_xlim(-CLOSE, CLOSE)
    inside.tick_params(labelsize=6)


def _contacts(states: xr.Dataset, friction: float) -> Figure:
    """Figs. 8 and 9: the central third, one panel for each force."""
    stored, shown = states["force"].values, contact_forces(states)
    figure, axes = style.figure(len(shown), 1, height=2.5 * len(shown) + 0.3)
    rest = states.isel(state=0)
    handles: dict[str, Any] = {}
    for index, force in enumerate(shown):
        loaded = states.isel(state=int(np.flatnonzero(stored == force)[0]))
        panel = axes[index, 0]
        drawn = draw_state_changes(panel, rest, loaded, loaded["contact_status"].values == SLIDING)
        handles.update({name: line for name, line in drawn.items() if name not in handles})
        text = f"{style.equals(style.FRICTION, friction)}, {style.equals(style.F_EXT, force, style.WEIGHT)}"
        style.letter(panel, "abcdefgh"[index], place="above", text=text)
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles), columnspacing=1.2)
    return figure
