"""Claims F1 to F3, F11, F12, R1 to R12 but R5a, A1, A2, K4: ordered slabs with friction, growing forces (Sec. V)."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import xarray as xr

from granular_response.state import SLIDING

from ...claims import asked, preparations
from ...claims.claim import Claims, Condition, Data, Finding, Measure, Quantity, Reading, at
from ...claims.preparations import OWN
from ...claims.words import Bounds

GROUP = "friction_linear_range"
BREAKING = "symmetry_breaking"
CLAIMS = Claims(GROUP)


def _events(data: Data, name: str, *frictions: float) -> dict[float, Quantity]:
    """The brackets of an event by friction."""
    return {mu: data.event(GROUP, name, mu) for mu in frictions}


def at_force(
    event: str, friction: float, paper: float, *, what: str, text: str, first_sampled: bool = False
) -> Measure:
    """The paper's number for an event: "about" it, or the first of its sampled forces at or above it."""

    def measure(data: Data, words: Bounds) -> Finding:
        def wanted(end: Quantity) -> list[Condition]:
            if first_sampled:
                return [asked.sampled(what, end, paper, words)]
            return [asked.near(what, end, words, "about", paper, "mg")]

        own = "the first sampled force at or above it" if first_sampled else OWN
        found = _events(data, event, friction)
        readings = preparations.readings(data, event, found, wanted, own)
        if event == "crossover":
            readings.insert(1, Reading(asked.VISIBLE, *wanted(_visible_from(data, friction, words))))
        return Finding(f"{text} {found[friction].text('mg')}", readings)

    return measure


for _id, _friction, _force in (("F1", 0.0, 0.75), ("F2", 0.2, 4.0), ("F3", 1.0, 6.0)):
    CLAIMS.measures(_id)(
        at_force("first_opening", _friction, _force, what="first opening", text="opens at", first_sampled=True)
    )


def _visible_from(data: Data, friction: float, words: Bounds) -> Quantity:
    return asked.dips_from(_curve(data, friction, "central_dip"), "force", words)


#: Frictions of the paper (Fig. 6, Sec. V.B).
OWN_FRICTIONS = (0.0, 0.2, 1.0)
#: Ends of the linear range that other preparations have too, by event.
_EVENTS = {"response 1 % off": "linear_range", "first opening": "first_opening"}


def _ranges(data: Data, frictions: list[float]) -> dict[str, dict[float, Quantity]]:
    """The ends of the linear range at each friction, by what counts as its end."""
    curves = {mu: _curve(data, mu, "response_at_centre") for mu in frictions}
    further = {
        f"response {part:.0%} off".replace("%", " %"): {
            mu: asked.linear_until(curve, part) for mu, curve in curves.items()
        }
        for part in (0.02, 0.05)
    }
    one, opening = ({name: _events(data, event, *frictions)} for name, event in _EVENTS.items())
    return one | further | opening


def _by_end(
    data: Data, found: dict[str, dict[float, Quantity]], wanted: Callable[..., list[Condition]]
) -> list[Reading]:
    """What is asked of the ends at all frictions: each as the paper prepares the slab, then in the other ways."""
    others = []
    for name, event in _EVENTS.items():
        others += preparations.readings(data, event, found[name], wanted, named=f"{name}, ")[1:]
    return [Reading(name, *wanted(*ends.values())) for name, ends in found.items()] + others


@CLAIMS.measures("R1")
def linear_range(data: Data, words: Bounds) -> Finding:
    def wanted(without: Quantity, *ends: Quantity) -> list[Condition]:
        least, most = (10.0 ** (1.0 + sign * words["almost"]) for sign in (-1.0, 1.0))
        return [
            Condition(f"times larger at friction {mu:g}", end.per(without), least, most, ("almost",))
            for mu, end in zip((0.2, 1.0), ends, strict=True)
        ]

    found = _ranges(data, list(OWN_FRICTIONS))
    ratios = {
        name: " and ".join(f"{ends[mu].per(ends[0.0]).value:.3g}" for mu in (0.2, 1.0)) for name, ends in found.items()
    }
    return Finding(
        "at friction 0.2 and 1: " + ", ".join(f"{both} times ({name})" for name, both in ratios.items()),
        _by_end(data, found, wanted),
    )


def _curve(data: Data, friction: float, name: str) -> xr.Dataset:
    """The response at a friction, at the forces at which this is measured."""
    curve = at(data.get(GROUP, "response"), friction=friction)
    return curve.isel(force=np.isfinite(curve[name].values))


def _up_to_50(data: Data, name: str) -> xr.Dataset:
    """The curve at friction 1."""
    curve = _curve(data, 1.0, name)
    force = curve["force"].values
    CLAIMS.needs(force.max(initial=0.0) >= 50.0, "response does not reach 50 mg at friction 1")
    return curve.isel(force=force <= 50.0)


@CLAIMS.measures("R2a")
def single_peak(data: Data, words: Bounds) -> Finding:
    curves = {OWN: _up_to_50(data, "double_peaked"), **preparations.responses(data, 1.0)}
    readings = []
    for way, curve in curves.items():
        double = curve["double_peaked"].values[curve["force"].values <= 50.0] > 0.0
        none = asked.none_of("forces up to 50 mg with two peaks", int(double.sum()))
        readings.append(Reading(way, none, change="" if way == OWN else preparations.CHANGE))
    size, two = curves[OWN].sizes["force"], readings[0].conditions[0].found.value
    return Finding(
        f"one peak at {size - two:.0f} of {size} forces up to 50 mg",
        [*readings, *preparations.one_peak_at_15(data, 1.0, words)],
    )


@CLAIMS.measures("R2b")
def sharper(data: Data, words: Bounds) -> Finding:
    curve = _up_to_50(data, "half_maximum_width")
    width, height = curve["half_maximum_width"].values, curve["peak_height"].values
    return asked.one_reading(
        f"from the smallest force to 50 mg the full width falls from {width[0]:.1f} to {width[-1]:.1f} R, the height "
        f"grows from {height[0]:.4f} to {height[-1]:.4f}",
        OWN,
        asked.lower("width at 50 mg per that at the smallest force", width[-1] / width[0], words, "visible"),
    )


CLAIMS.measures("R3a")(at_force("crossover", 0.2, 20.0, what="crossover", text="two peaks from"))
CLAIMS.measures("R3b")(
    at_force("reaches_floor", 0.2, 20.0, what="open region at the floor", text="open region at the floor from")
)
CLAIMS.measures("R4a")(at_force("third_peak", 0.2, 40.0, what="third peak", text="from", first_sampled=True))


@CLAIMS.measures("R4b")
def third_peak_small(data: Data, words: Bounds) -> Finding:
    curve = _curve(data, 0.2, "third_peak_prominence")
    force, size = curve["force"].values, curve["third_peak_prominence"].values
    beyond = np.flatnonzero((force >= 40.0) & (size > 0.0))
    return Finding(
        f"prominence {size[beyond[0]]:.3f} of the largest response at {force[beyond[0]]:g} mg, up to "
        f"{size[beyond].max():.3f} at {force[beyond][size[beyond].argmax()]:g} mg",
        [
            Reading(f"{force[k]:g} mg", asked.at_most("prominence per largest response", size[k], words, "small", "%"))
            for k in beyond
        ],
    )


def _jump(data: Data) -> tuple[xr.Dataset, int]:
    """The dynamic runs at large forces, in order, and the index of the first asymmetric one."""
    runs = data.get(GROUP, "large_forces").sortby("force")
    lost = np.flatnonzero(runs["asymmetry"].values > 0.1)
    CLAIMS.needs(lost[:1].any(), "large_forces holds no forces on both sides of the loss of symmetry")
    return runs, int(lost[0])


#: How the force of those runs grows.
RAMP = "ramp of 20 sqrt(R/g)"


@CLAIMS.measures("R5b")
def sharp(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    asymmetry, force = runs["asymmetry"].values, runs["force"].values
    step = float(asymmetry[first] - asymmetry[first - 1])
    return asked.one_reading(
        f"asymmetry from {asymmetry[first - 1]:.1e} at {force[first - 1]:g} mg to {asymmetry[first]:.2f} at "
        f"{force[first]:g} mg",
        RAMP,
        asked.at_least("change between two forces, per largest response", step, words, "gradual"),
    )


@CLAIMS.measures("R6a")
def sliding_drops(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    sliding, margins = runs["mobilised_contacts"].transpose("force", "margin").values, runs["margin"].values
    readings, texts = [], []
    for margin, before, after in zip(margins.tolist(), sliding[first - 1], sliding[first], strict=True):
        texts.append(f"{before:.0f} and {after:.0f} (within {margin:.0%})")
        if before > 0:
            fewer = asked.lower("sliding contacts after per before", after / before, words, "marked")
            readings.append(Reading(f"within {margin:.0%} of the Coulomb limit", fewer))
    return Finding("contacts near the Coulomb limit before and after: " + ", ".join(texts), readings)


@CLAIMS.measures("R6b")
def network_changes(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    network = runs["network_asymmetry"].values
    after = Quantity.exact(network[first:].min())
    return asked.one_reading(
        f"contacts without a mirror image: {network[first - 1]:.1%} before, {network[first]:.1%} after",
        RAMP,
        asked.none_of("contacts without a mirror image before", network[first - 1]),
        Condition("smallest part without a mirror image after", after, 0.0, strict=True),
    )


@CLAIMS.measures("R7")
def mirror_images(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    after = runs.isel(force=slice(first, None))
    response, force = after["floor_response"].values, after["force"].values
    sign = after["asymmetry_sign"].values
    # the paper's pair lies between 91 and 95 mg
    pairs = [
        (float(np.abs(response[a] - response[b][::-1]).max() / response[a].max()), force[a], force[b])
        for a in range(len(force))
        for b in range(a + 1, len(force))
        if sign[a] * sign[b] < 0 and force[b] - force[a] <= 4.0
    ]
    best = min(pairs, default=(1.0, float("nan"), float("nan")))
    turned = ""
    if BREAKING in data.groups:
        copies = data.get(BREAKING, "copies")["asymmetry_sign"].values
        turned = (
            f"; copies of the packing that differ by rounding: {(copies > 0).sum()} to the right, "
            f"{(copies < 0).sum()} to the left"
        )
    seen = f"{best[1]:g} and {best[2]:g} mg, difference {best[0]:.1%}" if pairs else "no pair of opposite sign"
    what = "difference of one response and the mirrored other, per largest response"
    return asked.one_reading(f"{seen}{turned}", RAMP, asked.at_most(what, best[0], words, "holds", "%"))


@CLAIMS.measures("R8a")
def floor_earlier(data: Data, words: Bounds) -> Finding:
    event, what = "reaches_floor", "force at friction 1 per that at 0.2"
    found = _events(data, event, 1.0, 0.2)
    return Finding(
        f"at the floor from {found[1.0].text('mg')} (friction 1) and {found[0.2].text('mg')} (friction 0.2)",
        preparations.readings(
            data, event, found, lambda one, other: [Condition(what, one.per(other), most=1.0, strict=True)]
        ),
    )


@CLAIMS.measures("R8b")
def one_peak_beyond(data: Data, words: Bounds) -> Finding:
    floor = data.event(GROUP, "reaches_floor", 1.0)
    curve = _curve(data, 1.0, "double_peaked")
    beyond = curve["force"].values >= floor.high
    CLAIMS.needs(beyond.any(), "response ends before the open region reaches the floor")
    double = int(np.count_nonzero(curve["double_peaked"].values[beyond]))
    return asked.one_reading(
        f"two peaks at {double} of {beyond.sum()} forces beyond {floor.high:.4g} mg",
        OWN,
        asked.none_of("forces beyond it with two peaks", double),
    )


@CLAIMS.measures("R9")
def crossover_rises(data: Data, words: Bounds) -> Finding:
    found, visible = {}, []
    for mu in np.sort(data.get(GROUP, "response")["friction"].values).tolist():
        curve = _curve(data, mu, "double_peaked")
        found[mu] = asked.first(curve, "force", curve["double_peaked"].values > 0.0)
        visible.append(_visible_from(data, mu, words))
    what = "crossover force"
    readings = preparations.readings(data, "crossover", found, lambda *ends: [asked.rises(what, ends)])
    readings.insert(1, Reading(asked.VISIBLE, asked.rises(what, visible)))
    texts = asked.listed({f"{mu:g}": end for mu, end in found.items()}, unit="mg")
    return Finding("two peaks from, by friction: " + texts, readings)


@CLAIMS.measures("R10")
def smaller_region(data: Data, words: Bounds) -> Finding:
    without, full = (_curve(data, mu, "teardrop_depth") for mu in (0.0, 0.2))
    shared = [f for f in without["force"].values if f in full["force"].values]
    without, full = without.sel(force=shared), full.sel(force=shared)
    open_ = (without["teardrop_depth"].values > 2.0) & (full["reaches_floor"].values == 0)
    ratio = full["opened_contacts"].values[open_] / without["opened_contacts"].values[open_]
    found = Quantity.range(ratio, float(np.median(ratio)))
    return asked.one_reading(
        f"opened contacts at friction 0.2 per those without, until the region reaches the floor: {ratio.min():.2f} to "
        f"{ratio.max():.2f}",
        OWN,
        asked.lower("opened contacts per those without friction, same force", found, words, "marked"),
    )


@CLAIMS.measures("R11")
def floor_later(data: Data, words: Bounds) -> Finding:
    event, what = "reaches_floor", "force with friction per without"
    found = _events(data, event, 0.0, 0.2)
    return Finding(
        f"at the floor from {found[0.2].text('mg')} (friction 0.2) and {found[0.0].text('mg')} (without)",
        preparations.readings(
            data, event, found, lambda early, late: [asked.higher(what, late.per(early), words, "marked")]
        ),
    )


@CLAIMS.measures("F11")
def elastic_without_friction(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "first_opening", 0.0)
    curve = _curve(data, 0.0, "response_at_centre")
    before = curve["response_at_centre"].values[curve["force"].values <= event.low]
    CLAIMS.needs(before.size > 1, "response holds too few forces before the first opening")
    change = float(np.ptp(before) / before[0])
    return asked.one_reading(
        f"the response at x = 0 changes by {change:.2%} up to the first opening at {event.text('mg')}",
        OWN,
        asked.at_most("change of the response before a contact opens", change, words, "visible", "%"),
    )


@CLAIMS.measures("F12")
def region_and_friction(data: Data, words: Bounds) -> Finding:
    """Where the region has not reached the floor, and at the force of Fig. 12."""
    sizes = {"contacts": "opened_contacts", "depth": "teardrop_depth", "width": "teardrop_width"}
    axis, response = (data.get(GROUP, name).sortby("friction") for name in ("friction_axis", "response"))
    inside = (response["opened_contacts"].values[0] > 0.0) & (response["reaches_floor"].values[0] == 0.0)
    CLAIMS.needs(inside.any(), "response holds no open region without friction that has not reached the floor")
    last = float(response["force"].values[inside].max())
    studies = {f"up to {last:g} mg": response.isel(force=inside), "15 mg": axis}
    readings = []
    for (force, study), (what, name) in product(studies.items(), sizes.items()):
        size = study[name].transpose("friction", ...).values
        CLAIMS.needs((size[0] > 0.0).all(), "friction_axis holds no open region without friction")
        growth = float((np.diff(size, axis=0) / size[0]).max())
        condition = asked.at_most("largest growth with friction, per size without", growth, words, "visible", "%")
        readings.append(Reading(f"{what}, {force}", condition))
    return Finding(
        "opened contacts at 15 mg: " + asked.listed(asked.by_friction(axis, "opened_contacts"), ".0f"), readings
    )


#: "Near the point of application": within this distance (mean radii).
NEAR = 6.0


@CLAIMS.measures("R12")
def sliding_near(data: Data, words: Bounds) -> Finding:
    """At forces below that of the paper's crossover."""
    states = data.get(GROUP, "states_mu_0.2")
    first, second = states["contact_disk"].values, states["contact_partner"].values
    near = {}
    for k, force in enumerate(states["force"].values.tolist()):
        position = states["position"].values[k]
        slides = states["contact_status"].values[k] == SLIDING
        away = 0.5 * (position[first] + position[second])[slides] - position[int(states["loaded_disk"])]
        if 0.0 < force < 20.0 and away.size:
            near[f"{force:g} mg"] = float((np.hypot(*away.T) < NEAR).mean())
    what = f"sliding contacts within {NEAR:g} radii of the load"
    return asked.each(f"{what}: ", near, lambda part: asked.at_least(what, part, words, "marked", "%"), "%")


@CLAIMS.measures("A1")
def range_grows(data: Data, words: Bounds) -> Finding:
    frictions = np.unique(data.get(GROUP, "response")["friction"].values).tolist()
    found = _ranges(data, frictions)
    texts = {name: ", ".join(f"{end.value:.3g}" for end in ends.values()) for name, ends in found.items()}
    own = {name: asked.rises("range", [ends[mu] for mu in OWN_FRICTIONS]) for name, ends in found.items()}
    return Finding(
        f"at friction {', '.join(f'{mu:g}' for mu in frictions)}: "
        + "; ".join(f"{name} at {ends} mg" for name, ends in texts.items()),
        _by_end(data, found, lambda *ends: [asked.rises("range", ends)])
        + [Reading(f"{name}, the paper's three frictions", rises) for name, rises in own.items()],
    )


@CLAIMS.measures("A2")
def smaller_anisotropy(data: Data, words: Bounds) -> Finding:
    axis = data.get(GROUP, "friction_axis").sortby("friction")
    dip = axis["central_dip"].values
    largest = float(data.get(GROUP, "response")["friction"].max())
    elastic = _curve(data, largest, "response_at_centre")
    small = elastic["floor_response"].transpose("force", "floor_disk").values[0]
    response = axis["floor_response"].transpose("friction", "floor_disk").values
    off = np.sqrt(((response - small) ** 2).sum(axis=1) / (small**2).sum())
    apart = dict(zip((f"{mu:g}" for mu in axis["friction"].values), off, strict=True))
    return Finding(
        f"dip at x = 0 at 15 mg from {dip[0]:.0%} without friction to {dip[-1]:.1%} at friction "
        f"{float(axis['friction'][-1]):g}; rms difference from the elastic response " + asked.listed(apart, ".1%"),
        [
            Reading(
                "dip at x = 0",
                asked.at_most("largest growth of the dip with friction", np.diff(dip).max(), words, "visible", "%"),
                asked.at_least("fall of the dip over all", dip[0] - dip[-1], words, "marked"),
            ),
            Reading(
                "difference from the elastic response",
                asked.at_most(
                    "largest growth of the difference with friction", np.diff(off).max(), words, "visible", "%"
                ),
                asked.lower("the difference with the largest friction per without", off[-1] / off[0], words, "marked"),
            ),
        ],
    )


@CLAIMS.measures("K4")
def friction_crossover(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "friction_crossover")
    axis = data.get(GROUP, "friction_axis").sortby("friction")
    first, last = float(axis["central_dip"][0]), float(axis["central_dip"][-1])

    without = asked.at_least("dip without friction", first, words, "visible", "%")

    def one_peak(dip: float) -> Condition:
        return asked.at_most("dip with much friction", dip, words, "visible", "%")

    largest = float(axis["friction"][-1])
    visible = asked.dips_from(axis.isel(friction=slice(None, None, -1)), "friction", words)
    readings = [
        Reading(name, Condition("friction", found, 0.0, largest), without, one_peak(last))
        for name, found in ((OWN, event), (asked.VISIBLE, visible))
    ]
    if preparations.LOADING in data.groups:
        readings += [
            Reading(name, without, one_peak(dip), change=preparations.change(name))
            for name, dip in preparations.dips(data, 1.0).items()
        ]
    return Finding(f"two peaks up to friction {event.text()}, one above", readings)
