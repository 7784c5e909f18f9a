"""Figs. 6 to 9, 12 and 16: the response of a slab with friction, and what the force does to its contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.state import OPEN, SLIDING
from granular_response_paper.captions import RADIUS, WEIGHT, Caption, Datasets, Value, of_group, of_scene, peaks
from granular_response_paper.panels import among, contact_networks, family, grey_limit, label_ends, note, titles, zero

from .parameters import PROFILE_FRICTIONS, Parameters

#: Forces of the profiles (Fig. 7), of the pictures of contacts (Figs. 8 and 9) and of the large forces (Fig. 16).
PROFILE_FORCES = (4.0, 10.0, 20.0, 30.0, 50.0)
LARGE_FRICTION = 0.2
CONTACT_FORCES = (5.0, 12.0, 20.0)
CONTACTS = ((0.2, "fig08_contacts_mu02"), (1.0, "fig09_contacts_mu1"))
LARGE_FORCES = (20.0, 30.0, 40.0, 60.0, 80.0)
#: Responses that differ by less than this part of the peak lie on each other in print.
COINCIDE = 0.04
#: Frictions of Fig. 12.
AXIS_FRICTIONS = (0.0, 0.1, 0.15, 0.2, 0.5, 1.0)

#: Part of the slab that profiles show, to both sides of the load (radii): beyond it the walls matter.
REACH = 40.0

#: A response is not symmetric from this difference of mirror images on, per largest response.
ASYMMETRIC = 0.2
#: Change of the response that ends the linear range.
LINEAR = 0.01

#: Symbols of a profile stand at every so many disks.
SPREAD = 3

#: What the paper says, in mean disk weights: forces that open the first contact, by friction (Sec. V.B), crossover and
#: third peak at friction 0.2, and the last symmetric response at friction 1 (Sec. V.E).
PAPER_OPENINGS = {0.0: 0.75, 0.2: 4.0, 1.0: 6.0}
PAPER_CROSSOVER, PAPER_THIRD_PEAK, PAPER_SYMMETRIC = 20.0, 40.0, 91.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    response = datasets["response"]
    return {
        "fig06_linear_range": _linear_range(response),
        "fig07_friction_response": _profiles(response),
        **{stem: _contacts(datasets[f"states_mu_{friction:g}"], friction) for friction, stem in CONTACTS},
        "fig12_friction_crossover": _friction_axis(datasets["friction_axis"], response),
        "fig16_large_forces": _large_forces(response, datasets["large_forces"]),
    }


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    response, dynamic = datasets["response"], datasets["large_forces"]

    def said(force: Value, friction: Value) -> dict[str, Value]:
        return of_scene(parameters.scene, force=force, friction=friction)

    def drawn(wanted: Sequence[float]) -> list[float]:
        return at_forces(response.sel(friction=LARGE_FRICTION), wanted)["force"].values.tolist()

    axis = among(datasets["friction_axis"]["friction"], AXIS_FRICTIONS)
    large = sorted({*drawn(LARGE_FORCES), *_dynamic_forces(dynamic)})
    stops = (f" µ = {end.friction:g} is computed up to {end.force:g} {WEIGHT} only." for end in parameters.ends)
    return of_group(
        "friction_linear_range",
        {
            "fig06_linear_range": said(response["force"].values.tolist(), response["friction"].values.tolist()),
            "fig07_friction_response": said(drawn(PROFILE_FORCES), PROFILE_FRICTIONS),
            **{stem: said(contact_forces(datasets[f"states_mu_{mu:g}"]), mu) for mu, stem in CONTACTS},
            "fig12_friction_crossover": said(parameters.friction_axis.force, axis),
            "fig16_large_forces": said(large, [LARGE_FRICTION, float(dynamic["friction"])]),
        },
        _findings(datasets),
        crossover=PAPER_CROSSOVER,
        third=PAPER_THIRD_PEAK,
        symmetric=PAPER_SYMMETRIC,
        stops="".join(stops),
    )


def _findings(datasets: Datasets) -> dict[str, str]:
    """What the data show, a sentence for each picture."""
    response, axis, large = (datasets[name] for name in ("response", "friction_axis", "large_forces"))
    longest = []
    for part in (LINEAR, 0.05):
        ends = {mu: _linear_until(response.sel(friction=mu), part) for mu in response["friction"].values.tolist()}
        best = max(ends, key=lambda mu: ends[mu])
        longest.append(f"µ = {best:g} for {100.0 * part:g} %")
    two = axis["friction"].values[axis["peak_count"].values >= 2]
    found = {
        "fig06_linear_range": f"The response at x = 0 stays linear longest at {' and at '.join(longest)}.",
        "fig12_friction_crossover": (
            f"Two peaks or more up to µ = {two.max():g}, one peak at larger friction." if two.size
            else "One peak at every friction."
        ),
    }  # fmt: skip
    counts: list[str] = []
    for friction in PROFILE_FRICTIONS:
        one = response.sel(friction=friction).dropna("force", subset=["peak_count"])
        split = one["force"].values[one["peak_count"].values >= 2]
        until = f"two peaks or more from {split[0]:g}" if split.size else f"one peak up to {float(one['force'][-1]):g}"
        counts.append(f"{'at' if counts else 'At'} µ = {friction:g} {until} {WEIGHT}")
    found["fig07_friction_response"] = f"{', '.join(counts)}."
    for friction, stem in CONTACTS:
        states = datasets[f"states_mu_{friction:g}"]
        force = max(contact_forces(states))
        status = states["contact_status"].values
        touched, one = status[0] != OPEN, status[states["force"].values.tolist().index(force)]
        opened, slide = (int((touched & (one == kind)).sum()) for kind in (OPEN, SLIDING))
        found[stem] = f"At µ = {friction:g} and {force:g} {WEIGHT} {opened} contacts have opened and {slide} slide."
    kept, lost = _symmetric(large)
    left = response.sel(friction=LARGE_FRICTION)
    third = left["force"].values[left["peak_count"].values >= 3].tolist()
    found["fig16_large_forces"] = " ".join(
        [
            f"At µ = {LARGE_FRICTION:g} the response has three peaks from {third[0]:g} {WEIGHT}." if third else "",
            f"At µ = {float(large['friction']):g} it is symmetric up to {kept[-1]:.3g} {WEIGHT} and not at "
            f"{lost[0]:.3g} {WEIGHT}." if lost and kept else "",
            _on_the_floor_alone(datasets["large_force_states"], lost),
        ]
    ).strip()  # fmt: skip
    return found


def _linear_until(one: xr.Dataset, part: float) -> float:
    """The last force up to which the response at x = 0 differs by less than a ``part`` from that to the smallest."""
    curve = one["response_at_centre"].dropna("force")
    off = np.abs(curve.values / curve.values[0] - 1.0) > part
    return float(curve["force"][max(int(np.argmax(off)) - 1, 0)]) if off.any() else float(curve["force"][-1])


def _symmetric(dynamic: xr.Dataset) -> tuple[list[float], list[float]]:
    """The forces before symmetry is lost, and those from then on at which the response is not symmetric."""
    force, leans = dynamic["force"].values, dynamic["asymmetry"].values > ASYMMETRIC
    lost = force[leans].tolist()
    return force[force < min(lost, default=np.inf)].tolist(), lost


def _on_the_floor_alone(states: xr.Dataset, forces: Sequence[float]) -> str:
    """The disk that nothing but the floor holds in states at these forces, in words; empty where there is none."""
    alone: dict[float, int] = {}
    for state in np.flatnonzero(np.isin(states["force"].values, forces)):
        one = states.isel(state=state)
        touching = one["contact_status"].values != OPEN
        ends = [one[name].values[touching] for name in ("contact_disk", "contact_partner")]
        pairs = np.bincount(np.concatenate(ends), minlength=one.sizes["disk"])
        held = one["wall_disk"].values[one["wall_status"].values != OPEN]
        middle = float(one["position"].values[int(one["loaded_disk"]), 0])
        for disk in held[pairs[held] == 0]:
            place = round(float(one["position"].values[disk, 0]) - middle)
            alone[place] = alone.get(place, 0) + 1
    if not alone:
        return ""
    places = " or ".join(f"{place:g}".replace("-", "\N{MINUS SIGN}") for place in sorted(alone))
    count = sum(alone.values())
    which = f"all {count}" if count == len(forces) else f"{count} of {len(forces)}"
    return f"In {which} asymmetric states the floor alone holds a disk, at x = {places} {RADIUS}."


def _linear_range(response: xr.Dataset) -> Figure:
    """Fig. 6."""
    figure, ((panel,),) = style.figure(height=3.2)
    ends = []
    elastic = float(response["response_at_centre"].isel(friction=-1).dropna("force")[0])
    band = elastic * (1.0 - LINEAR), elastic * (1.0 + LINEAR)
    panel.axhspan(*band, color=style.FAINT, alpha=0.6, linewidth=0.0, zorder=0)
    for friction, look in family(response["friction"].values, of="friction"):
        curve = response["response_at_centre"].sel(friction=friction).dropna("force")
        panel.plot(curve["force"], curve, **look | {"markersize": 3.0})
        end = float(curve["force"][-1]), float(curve[-1])
        ends.append((style.equals(style.FRICTION, friction), *end, look["color"]))
    panel.set_xscale("log")
    panel.xaxis.set_major_formatter("{x:g}")
    panel.set(xlabel=style.FORCE, ylabel=style.RESPONSE_AT_CENTRE, ylim=(0.0, None))
    panel.set_xlim(right=2.0 * max(x for _, x, *_ in ends))
    within = rf"$\pm${LINEAR:.0%}".replace("%", r" %")
    note(panel, within, (panel.get_xlim()[0], band[1]), (4.0, 3.0), va="bottom", fontsize=8, color=style.MUTED)
    label_ends(panel, ends)
    for friction, force in PAPER_OPENINGS.items():
        last = force == max(PAPER_OPENINGS.values())
        text = f"paper, $\\mu = {friction:g}$: {force:g}"
        style.paper_value(panel, force, text, side="behind" if last else "before", at=0.6 if last else 0.36)
    return figure


def _profiles(response: xr.Dataset) -> Figure:
    """Fig. 7."""
    figure, axes = style.figure(1, 2, height=3.0, sharey=True)
    notes = {0.2: f"; paper: two peaks near {PAPER_CROSSOVER:g}", 1.0: ""}
    titles(axes[0], [style.equals(style.FRICTION, friction) + notes[friction] for friction in PROFILE_FRICTIONS])
    for panel, friction in zip(axes[0], PROFILE_FRICTIONS, strict=True):
        one = response.sel(friction=friction)
        _plot_profiles(panel, at_forces(one, PROFILE_FORCES), "force", one.isel(force=0))
    axes[0, 0].set(ylabel=style.RESPONSE, ylim=(0.0, None))
    for panel, friction in zip(axes[0], PROFILE_FRICTIONS, strict=True):
        panel.legend(title=style.FORCE, loc="upper right", handlelength=2.6, fontsize=7)
        alike = _coinciding(at_forces(response.sel(friction=friction), PROFILE_FORCES))
        if len(alike) > 2:
            text = f"{alike[0]:g} to {alike[-1]:g}\ncoincide"
            panel.text(0.03, 0.3, text, transform=panel.transAxes, fontsize=8, va="bottom")
    return figure


def _coinciding(curves: xr.Dataset) -> list[float]:
    """The largest forces whose responses differ by less than COINCIDE of the peak from that to the largest of them."""
    response = curves["floor_response"].values
    near = np.abs(response - response[-1]).max(axis=1) < COINCIDE * response[-1].max()
    first = len(near) - int(np.argmin(near[::-1])) if not near.all() else 0
    return curves["force"].values[first:].tolist()


def _friction_axis(axis: xr.Dataset, response: xr.Dataset) -> Figure:
    """Fig. 12."""
    figure, ((panel,),) = style.figure(height=2.8)
    curves = axis.sel(friction=among(axis["friction"], AXIS_FRICTIONS))
    _plot_profiles(panel, curves, "friction", response.isel(friction=-1, force=0))
    panel.set(ylabel=style.RESPONSE, ylim=(0.0, None))
    panel.legend(title=f"${style.FRICTION}$", loc="upper right", handlelength=2.8)
    return figure


def _large_forces(response: xr.Dataset, dynamic: xr.Dataset) -> Figure:
    """Fig. 16; the profile at the largest symmetric force of (b) is followed by those beyond the instability."""
    figure, axes = style.figure(1, 2, height=3.1)
    left, right = axes[0]
    one = response.sel(friction=LARGE_FRICTION)
    _plot_profiles(left, at_forces(one, LARGE_FORCES), "force", one.isel(force=0))
    _plot_profiles(right, at_forces(dynamic, _dynamic_forces(dynamic)), "force", response.isel(friction=-1, force=0))
    mu, other = (style.equals(style.FRICTION, friction) for friction in (LARGE_FRICTION, float(dynamic["friction"])))
    paper = f"{mu}; paper: two peaks from {PAPER_CROSSOVER:g}, third from {PAPER_THIRD_PEAK:g}"
    titles(axes[0], (paper, f"{other}; paper: symmetric at {PAPER_SYMMETRIC:g}"))
    zero(right)
    kept, lost = _symmetric(dynamic)
    if lost and kept:
        text = f"here symmetric up to {kept[-1]:g},\nsymmetry lost at {lost[0]:g}"
        right.text(0.03, 0.06, text, transform=right.transAxes, fontsize=8)
    left.set_ylim(bottom=0.0)
    for panel in (left, right):
        panel.set_ylabel(style.RESPONSE)
        panel.set_ylim(top=1.2 * panel.get_ylim()[1])
        panel.legend(title=style.FORCE, loc="upper right", handlelength=2.4, fontsize=7)
    return figure


def _dynamic_forces(dynamic: xr.Dataset) -> list[float]:
    """The last symmetric force, the first asymmetric one, the next that leans to the other side, and the largest."""
    kept, lost = _symmetric(dynamic)
    sign = dict(zip(dynamic["force"].values.tolist(), dynamic["asymmetry_sign"].values.tolist(), strict=True))
    other = [force for force in lost if sign[force] == -sign[lost[0]]]
    return sorted({*kept[-1:], *lost[:1], *other[:1], *lost[-1:]})


def contact_forces(states: xr.Dataset) -> list[float]:
    """The forces of Figs. 8 and 9 as far as they are stored, else the first ones."""
    stored = states["force"].values.tolist()
    return [force for force in CONTACT_FORCES if force in stored] or stored[1:4]


def at_forces(dataset: xr.Dataset, forces: Sequence[float]) -> xr.Dataset:
    """The given forces as far as they are stored; all of them if none is."""
    stored = dataset.dropna("force", subset=["response_at_centre"])
    return stored.sel(force=among(stored["force"], forces))


def _plot_profiles(panel: Axes, curves: xr.Dataset, along: Literal["force", "friction"], elastic: xr.Dataset) -> None:
    """Response against position, a curve for each value ``along`` a dimension, before the ``elastic`` one in grey."""
    grey_limit(panel, curves["x"].values, elastic["floor_response"].values)
    # symbols at other disks for each curve, and dashes, so that curves which cover each other are all seen
    for index, (value, look) in enumerate(family(curves[along].values, of=along, dashed=True)):
        look |= {"markersize": 3.2, "markevery": (index % SPREAD, SPREAD)}
        label = f"{value:g}: {peaks(int(curves['peak_count'].isel({along: index})))}"
        panel.plot(curves["x"], curves["floor_response"].isel({along: index}), label=label, **look)
    panel.set(xlabel=style.POSITION, xlim=(-REACH, REACH))


def _contacts(states: xr.Dataset, friction: float) -> Figure:
    """Figs. 8 and 9: the central third, one panel for each force."""
    stored, shown = states["force"].values.tolist(), contact_forces(states)
    loaded = [states.isel(state=stored.index(force)) for force in shown]
    mu = style.equals(style.FRICTION, friction)
    names = [f"{mu}, {style.equals(style.F_EXT, force, style.WEIGHT)}" for force in shown]
    return contact_networks(states.isel(state=0), loaded, names, height=2.1, columnspacing=1.2)
