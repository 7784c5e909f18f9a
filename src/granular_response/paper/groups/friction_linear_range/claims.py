"""Claims F1 to F3, F11, R1 to R11 but R5a, A1, A2 and K4: ordered slabs with friction under growing forces (Sec. V)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from ...claims import preparations
from ...claims.claim import (
    Claim,
    Condition,
    Data,
    Finding,
    Measure,
    NotMeasured,
    Quantity,
    Reading,
    about,
    at,
    rises,
    sampled,
)
from ...claims.words import Bounds

GROUP = "friction_linear_range"
BREAKING = "symmetry_breaking"


def first_opening(friction: float, paper: float) -> Measure:
    def measure(data: Data, words: Bounds) -> Finding:
        event = data.event(GROUP, "first_opening", friction)
        return Finding(
            f"opens at {event.text('mg')}",
            [
                Reading("the first sampled force at or above it", sampled("first opening", event, paper, words)),
                *preparations.readings(
                    data, "first_opening", (friction,), lambda end: [sampled("first opening", end, paper, words)]
                ),
            ],
        )

    return measure


def _range_end(data: Data, friction: float, tolerance: float) -> Quantity:
    """Where the response at x = 0 is more than ``tolerance`` off that to the smallest force, between stored forces."""
    curve = at(data.get(GROUP, "response", "response_at_centre", "force", "friction"), friction=friction)
    value, force = curve["response_at_centre"].values, curve["force"].values
    known = np.isfinite(value)
    off = np.flatnonzero(np.abs(value[known] / value[0] - 1.0) > tolerance)
    if not off.size:
        return Quantity.bracket(float(force[known][-1]), float("nan"))
    return Quantity.bracket(float(force[known][off[0] - 1]), float(force[known][off[0]]))


def _ranges(data: Data, frictions: tuple[float, ...]) -> dict[str, list[Quantity]]:
    """The ends of the linear range at each friction, by what counts as its end."""
    return {
        "response 1 % off": [data.event(GROUP, "linear_range", mu) for mu in frictions],
        "response 2 % off": [_range_end(data, mu, 0.02) for mu in frictions],
        "response 5 % off": [_range_end(data, mu, 0.05) for mu in frictions],
        "first opening": [data.event(GROUP, "first_opening", mu) for mu in frictions],
    }


def linear_range(data: Data, words: Bounds) -> Finding:
    def asked(ratios: Sequence[Quantity]) -> list[Condition]:
        return [
            Condition(f"times larger at friction {mu:g}", ratio, (1.0 - words["almost"]) * 10.0, 10.0, ("almost",))
            for mu, ratio in zip((0.2, 1.0), ratios, strict=True)
        ]

    readings, texts = [], []
    for name, ends in _ranges(data, (0.0, 0.2, 1.0)).items():
        ratios = [end.per(ends[0]) for end in ends[1:]]
        texts.append(f"{ratios[0].value:.3g} and {ratios[1].value:.3g} times ({name})")
        readings.append(Reading(name, *asked(ratios)))
    for name, event in _OTHERWISE.items():
        without = data.event(GROUP, event, 0.0)
        readings += [
            Reading(f"{name}, {reading.name}", *reading.conditions)
            for reading in preparations.readings(
                data, event, (0.2, 1.0), lambda *ends, without=without: asked([end.per(without) for end in ends])
            )
        ]
    return Finding(
        "at friction 0.2 and 1: " + ", ".join(texts),
        readings,
        "The paper does not say how far off a response is no longer linear, nor how gravity came",
    )


#: Ends of the linear range that other preparations have too, by event.
_OTHERWISE = {"response 1 % off": "linear_range", "first opening": "first_opening"}


def range_grows(data: Data, words: Bounds) -> Finding:
    frictions = np.sort(np.unique(data.get(GROUP, "response", "friction")["friction"].values)).tolist()
    found = _ranges(data, tuple(frictions))
    return Finding(
        f"at friction {', '.join(f'{mu:g}' for mu in frictions)}: "
        + "; ".join(f"{name} at {', '.join(f'{e.value:.3g}' for e in ends)} mg" for name, ends in found.items()),
        [
            *(Reading(name, rises("range", ends)) for name, ends in found.items()),
            *(
                Reading(f"{name}, {reading.name}", *reading.conditions)
                for name, event in _OTHERWISE.items()
                for reading in preparations.readings(
                    data,
                    event,
                    tuple(frictions[1:]),
                    lambda *ends, without=found[name][0]: [rises("range", [without, *ends])],
                )
            ),
        ],
        "It grows up to friction 0.2 or 0.5 and is shorter at 1; at the paper's own three frictions the first opening "
        "grows",
    )


def smaller_anisotropy(data: Data, words: Bounds) -> Finding:
    axis = data.get(GROUP, "friction_axis", "central_dip", "friction").sortby("friction")
    dip = axis["central_dip"].values
    back = float(np.diff(dip).max())
    return Finding(
        f"dip at x = 0 at 15 mg from {dip[0]:.0%} without friction to {dip[-1]:.1%} at friction "
        f"{float(axis['friction'][-1]):g}; largest step back {back:.2%} of the largest response",
        [
            Reading(
                "floor response at 15 mg",
                Condition(
                    "largest growth of the dip with friction",
                    Quantity.exact(back),
                    most=words["visible"],
                    words=("visible",),
                    unit="%",
                ),
                Condition(
                    "fall of the dip over all", Quantity.exact(dip[0] - dip[-1]), words["marked"], words=("marked",)
                ),
            )
        ],
    )


def _curve(data: Data, friction: float, *names: str) -> xr.Dataset:
    curve = at(data.get(GROUP, "response", "force", "friction", *names), friction=friction)
    known = np.isfinite(curve[names[0]].values)
    return curve.isel(force=known)


def single_peak(data: Data, words: Bounds) -> Finding:
    curve = _curve(data, 1.0, "double_peaked")
    force = curve["force"].values
    if not force.size or force.max() < 50.0:
        raise NotMeasured(f"data/{GROUP}.nc: response does not reach 50 mg at friction 1")
    double = curve["double_peaked"].values[force <= 50.0]
    return Finding(
        f"one peak at {np.count_nonzero(double == 0)} of {double.size} forces up to 50 mg",
        [
            Reading(
                "gravity at once",
                Condition("forces up to 50 mg with two peaks", Quantity.exact(int(np.count_nonzero(double))), most=0.0),
            ),
            *(
                Reading(
                    way,
                    Condition(
                        "forces up to 50 mg with two peaks",
                        Quantity.exact(int(np.count_nonzero(values[force <= 50.0]))),
                        most=0.0,
                    ),
                )
                for way, (force, values) in preparations.curves(data, 1.0, "double_peaked").items()
            ),
            *preparations.one_peak_at_15(data, 1.0, words),
        ],
    )


def sharper(data: Data, words: Bounds) -> Finding:
    curve = _curve(data, 1.0, "half_maximum_width", "peak_height")
    force = curve["force"].values
    if not force.size or force.max() < 50.0:
        raise NotMeasured(f"data/{GROUP}.nc: response does not reach 50 mg at friction 1")
    last = int(np.flatnonzero(force <= 50.0)[-1])
    width, height = curve["half_maximum_width"].values, curve["peak_height"].values
    return Finding(
        f"from the smallest force to 50 mg the full width falls from {width[0]:.1f} to {width[last]:.1f} R, the height "
        f"grows from {height[0]:.4f} to {height[last]:.4f}",
        [
            Reading(
                "gravity at once",
                Condition(
                    "width at 50 mg per that at the smallest force",
                    Quantity.exact(width[last] / width[0]),
                    most=1.0 - words["visible"],
                    words=("visible",),
                ),
            )
        ],
    )


def crossover_at_20(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "crossover", 0.2)
    return Finding(
        f"two peaks from {event.text('mg')}",
        [
            Reading("gravity at once", about("crossover", event, 20.0, words, "mg")),
            *preparations.readings(data, "crossover", (0.2,), lambda end: [about("crossover", end, 20.0, words, "mg")]),
        ],
    )


def floor_at_20(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "reaches_floor", 0.2)
    return Finding(
        f"open region at the floor from {event.text('mg')}",
        [
            Reading("gravity at once", about("open region at the floor", event, 20.0, words, "mg")),
            *preparations.readings(
                data,
                "reaches_floor",
                (0.2,),
                lambda end: [about("open region at the floor", end, 20.0, words, "mg")],
            ),
        ],
    )


def third_peak(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "third_peak", 0.2)
    return Finding(
        f"from {event.text('mg')}",
        [
            Reading("the first sampled force at or above it", sampled("third peak", event, 40.0, words)),
            *preparations.readings(data, "third_peak", (0.2,), lambda end: [sampled("third peak", end, 40.0, words)]),
        ],
    )


def third_peak_small(data: Data, words: Bounds) -> Finding:
    curve = _curve(data, 0.2, "third_peak_prominence")
    force, size = curve["force"].values, curve["third_peak_prominence"].values
    beyond = np.flatnonzero((force >= 40.0) & (size > 0.0))
    if not beyond.size:
        raise NotMeasured(f"data/{GROUP}.nc: response holds no third peak from 40 mg on")
    return Finding(
        f"prominence {size[beyond[0]]:.3f} of the largest response at {force[beyond[0]]:g} mg, up to "
        f"{size[beyond].max():.3f} at {force[beyond][size[beyond].argmax()]:g} mg",
        [
            Reading(
                f"{force[k]:g} mg",
                Condition(
                    "prominence per largest response",
                    Quantity.exact(size[k]),
                    most=words["small"],
                    words=("small",),
                    unit="%",
                ),
            )
            for k in beyond
        ],
        "It keeps growing; the paper does not say up to which force it looked",
    )


def _jump(data: Data) -> tuple[xr.Dataset, int]:
    """The dynamic runs at large forces, in order, and the index of the first asymmetric one."""
    names = ("asymmetry", "force", "mobilised_contacts", "network_asymmetry", "floor_response", "asymmetry_sign")
    runs = data.get(GROUP, "large_forces", *names).sortby("force")
    lost = np.flatnonzero(runs["asymmetry"].values > 0.1)
    if not lost.size or lost[0] == 0:
        raise NotMeasured(f"data/{GROUP}.nc: large_forces holds no forces on both sides of the loss of symmetry")
    return runs, int(lost[0])


def sharp(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    asymmetry, force = runs["asymmetry"].values, runs["force"].values
    step = float(asymmetry[first] - asymmetry[first - 1])
    return Finding(
        f"asymmetry from {asymmetry[first - 1]:.1e} at {force[first - 1]:g} mg to {asymmetry[first]:.2f} at "
        f"{force[first]:g} mg",
        [
            Reading(
                "ramp of 20 sqrt(R/g)",
                Condition(
                    "change between two forces, per largest response",
                    Quantity.exact(step),
                    words["gradual"],
                    words=("gradual",),
                ),
            )
        ],
    )


def sliding_drops(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    sliding, margins = runs["mobilised_contacts"].transpose("force", "margin").values, runs["margin"].values
    readings = []
    for k, margin in enumerate(margins.tolist()):
        before, after = sliding[first - 1, k], sliding[first, k]
        if before > 0:
            readings.append(
                Reading(
                    f"within {margin:.0%} of the Coulomb limit",
                    Condition(
                        "sliding contacts after per before",
                        Quantity.exact(after / before),
                        most=1.0 - words["marked"],
                        words=("marked",),
                    ),
                )
            )
    if not readings:
        raise NotMeasured(f"data/{GROUP}.nc: large_forces holds no contact near the Coulomb limit before the change")
    return Finding(
        "contacts near the Coulomb limit before and after: "
        + ", ".join(
            f"{sliding[first - 1, k]:.0f} and {sliding[first, k]:.0f} (within {m:.0%})" for k, m in enumerate(margins)
        ),
        readings,
        "In equilibrium a contact that slid rests just below the limit; how near counts as sliding is a choice",
    )


def network_changes(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    network = runs["network_asymmetry"].values
    return Finding(
        f"contacts without a mirror image: {network[first - 1]:.1%} before, {network[first]:.1%} after",
        [
            Reading(
                "ramp of 20 sqrt(R/g)",
                Condition("contacts without a mirror image before", Quantity.exact(network[first - 1]), most=0.0),
                Condition(
                    "smallest part without a mirror image after",
                    Quantity.exact(network[first:].min()),
                    0.0,
                    strict=True,
                ),
            )
        ],
    )


def mirror_images(data: Data, words: Bounds) -> Finding:
    runs, first = _jump(data)
    after = runs.isel(force=slice(first, None))
    response, force = after["floor_response"].values, after["force"].values
    sign, x = after["asymmetry_sign"].values, after["x"].values
    if np.abs(x + x[::-1]).max() > 0.1:
        raise NotMeasured(f"data/{GROUP}.nc: the floor disks are not symmetric about x = 0")
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
        copies = data.get(BREAKING, "copies", "asymmetry_sign")["asymmetry_sign"].values
        turned = (
            f"; copies of the packing that differ by rounding: {(copies > 0).sum()} to the right, "
            f"{(copies < 0).sum()} to the left"
        )
    seen = f"{best[1]:g} and {best[2]:g} mg, difference {best[0]:.1%}" if pairs else "no pair of opposite sign"
    return Finding(
        f"{seen}{turned}",
        [
            Reading(
                "ramp of 20 sqrt(R/g)",
                Condition(
                    "difference of one response and the mirrored other, per largest response",
                    Quantity.exact(best[0]),
                    most=words["holds"],
                    words=("holds",),
                    unit="%",
                ),
            )
        ],
    )


def floor_earlier(data: Data, words: Bounds) -> Finding:
    low, high = data.event(GROUP, "reaches_floor", 1.0), data.event(GROUP, "reaches_floor", 0.2)
    return Finding(
        f"at the floor from {low.text('mg')} (friction 1) and {high.text('mg')} (friction 0.2)",
        [
            Reading(
                "gravity at once",
                Condition("force at friction 1 per that at 0.2", low.per(high), most=1.0, strict=True),
            ),
            *preparations.readings(
                data,
                "reaches_floor",
                (1.0, 0.2),
                lambda low, high: [
                    Condition("force at friction 1 per that at 0.2", low.per(high), most=1.0, strict=True)
                ],
            ),
        ],
    )


def one_peak_beyond(data: Data, words: Bounds) -> Finding:
    floor = data.event(GROUP, "reaches_floor", 1.0)
    curve = _curve(data, 1.0, "double_peaked")
    beyond = curve["force"].values >= floor.high
    if not beyond.any():
        raise NotMeasured(f"data/{GROUP}.nc: response ends before the open region reaches the floor")
    double = int(np.count_nonzero(curve["double_peaked"].values[beyond]))
    return Finding(
        f"two peaks at {double} of {beyond.sum()} forces beyond {floor.high:.4g} mg",
        [Reading("gravity at once", Condition("forces beyond it with two peaks", Quantity.exact(double), most=0.0))],
    )


def smaller_region(data: Data, words: Bounds) -> Finding:
    names = ("teardrop_depth", "teardrop_width", "reaches_floor", "opened_contacts")
    without, full = _curve(data, 0.0, *names), _curve(data, 0.2, *names)
    shared = [f for f in without["force"].values if f in full["force"].values]
    without, full = without.sel(force=shared), full.sel(force=shared)
    open_ = (without["teardrop_depth"].values > 2.0) & (full["reaches_floor"].values == 0)
    if not open_.any():
        raise NotMeasured(f"data/{GROUP}.nc: response holds no force at which the regions can be compared")
    ratio = full["opened_contacts"].values[open_] / without["opened_contacts"].values[open_]
    return Finding(
        f"opened contacts at friction 0.2 per those without, until the region reaches the floor: {ratio.min():.2f} to "
        f"{ratio.max():.2f}",
        [
            Reading(
                "gravity at once",
                Condition(
                    "opened contacts per those without friction, same force",
                    Quantity.range(ratio, float(np.median(ratio))),
                    most=1.0 - words["marked"],
                    words=("marked",),
                ),
            )
        ],
    )


def floor_later(data: Data, words: Bounds) -> Finding:
    late, early = data.event(GROUP, "reaches_floor", 0.2), data.event(GROUP, "reaches_floor", 0.0)
    return Finding(
        f"at the floor from {late.text('mg')} (friction 0.2) and {early.text('mg')} (without)",
        [
            Reading(
                "gravity at once",
                Condition("force with friction per without", late.per(early), 1.0 + words["marked"], words=("marked",)),
            ),
            *preparations.readings(
                data,
                "reaches_floor",
                (0.2,),
                lambda late: [
                    Condition(
                        "force with friction per without", late.per(early), 1.0 + words["marked"], words=("marked",)
                    )
                ],
            ),
        ],
    )


def elastic_without_friction(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "first_opening", 0.0)
    curve = _curve(data, 0.0, "response_at_centre")
    before = curve["response_at_centre"].values[curve["force"].values <= event.low]
    if before.size < 2:
        raise NotMeasured(f"data/{GROUP}.nc: response holds too few forces before the first opening")
    change = float(np.ptp(before) / before[0])
    return Finding(
        f"the response at x = 0 changes by {change:.2%} up to the first opening at {event.text('mg')}",
        [
            Reading(
                "gravity at once",
                Condition(
                    "change of the response before a contact opens",
                    Quantity.exact(change),
                    most=words["visible"],
                    words=("visible",),
                    unit="%",
                ),
            )
        ],
    )


def crossover_rises(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "response", "double_peaked", "force", "friction").sortby("friction")
    ends, texts = [], []
    for mu in study["friction"].values.tolist():
        curve = _curve(data, mu, "double_peaked")
        force, double = curve["force"].values, curve["double_peaked"].values
        first = np.flatnonzero(double > 0)
        if first.size and first[0] == 0:
            raise NotMeasured(f"data/{GROUP}.nc: response has two peaks at the smallest force, friction {mu:g}")
        k = int(first[0]) if first.size else len(force)
        ends.append(Quantity.bracket(force[k - 1], force[k] if first.size else float("nan")))
        texts.append(f"{ends[-1].text('mg')} ({mu:g})")
    return Finding(
        "two peaks from, by friction: " + ", ".join(texts),
        [
            Reading("gravity at once", rises("crossover force", ends)),
            *preparations.readings(
                data,
                "crossover",
                tuple(study["friction"].values[1:].tolist()),
                lambda *after: [rises("crossover force", [ends[0], *after])],
            ),
        ],
    )


def friction_crossover(data: Data, words: Bounds) -> Finding:
    event = data.event(GROUP, "friction_crossover")
    axis = data.get(GROUP, "friction_axis", "central_dip", "friction").sortby("friction")
    first, last = float(axis["central_dip"][0]), float(axis["central_dip"][-1])

    def asked(at_most: float) -> list[Condition]:
        return [
            Condition("dip without friction", Quantity.exact(first), words["visible"], words=("visible",), unit="%"),
            Condition(
                "dip with much friction", Quantity.exact(at_most), most=words["visible"], words=("visible",), unit="%"
            ),
        ]

    largest = float(axis["friction"][-1])
    readings = [Reading("gravity at once", Condition("friction", event, 0.0, largest), *asked(last))]
    if preparations.LOADING in data.groups:
        readings += [Reading(name, *asked(dip)) for name, dip in preparations.dips(data, 1.0).items()]
    return Finding(f"two peaks up to friction {event.text()}, one above", readings)


CLAIMS = (
    *(
        Claim(
            f"F{k}",
            "V.B",
            f"friction {mu:g}: smallest force that opens a contact in the central third of the slab, by bisection on "
            "the load path",
            f"{paper:g} mg",
            first_opening(mu, paper),
            figures,
            GROUP,
        )
        for k, mu, paper, figures in ((1, 0.0, 0.75, (4, 6)), (2, 0.2, 4.0, (8,)), (3, 1.0, 6.0, (9,)))
    ),
    Claim(
        "R1",
        "V.A, Fig. 6",
        "end of the linear range at x = 0, and first opening, at friction 0.2 and 1 over those without",
        "almost ten times larger",
        linear_range,
        (6,),
        GROUP,
    ),
    Claim(
        "R2a",
        "V.A, Fig. 7",
        "friction 1: forces up to 50 mg with two peaks",
        "a single peak up to 50 mg",
        single_peak,
        (7,),
        GROUP,
    ),
    Claim(
        "R2b",
        "V.B, Fig. 7",
        "friction 1: full width at half maximum at 50 mg over that at the smallest force",
        "its shape becomes sharper",
        sharper,
        (7,),
        GROUP,
    ),
    Claim(
        "R3a",
        "V.E, Fig. 16a",
        "friction 0.2: force of the crossover to two peaks",
        "about 20 mg",
        crossover_at_20,
        (7, 16),
        GROUP,
    ),
    Claim(
        "R3b",
        "V.E, Fig. 8",
        "friction 0.2: force at which the open region reaches the lowest row",
        "about 20 mg",
        floor_at_20,
        (8,),
        GROUP,
    ),
    Claim(
        "R4a",
        "V.E, Fig. 16a",
        "friction 0.2: force from which the response with two peaks has a third one at x = 0, by bisection",
        "from about 40 mg",
        third_peak,
        (16,),
        GROUP,
    ),
    Claim(
        "R4b",
        "V.E, Fig. 16a",
        "prominence of that peak at each stored force from 40 mg on",
        "small",
        third_peak_small,
        (16,),
        GROUP,
    ),
    Claim(
        "R5b",
        "V.E, Fig. 16b",
        "change of the asymmetry between the two neighbouring forces around that event",
        "a sharp transition",
        sharp,
        (16,),
        GROUP,
    ),
    Claim(
        "R6a",
        "V.E",
        "contacts near the Coulomb limit on both sides of that change",
        "a marked reduction in the number of sliding contacts",
        sliding_drops,
        (16,),
        GROUP,
    ),
    Claim(
        "R6b",
        "V.E",
        "contacts without a mirror image on both sides of that change",
        "the contact network becomes asymmetric",
        network_changes,
        (16,),
        GROUP,
    ),
    Claim(
        "R7",
        "V.E",
        "beyond that change: responses at nearly equal forces that lean to opposite sides, one mirrored",
        "very close forces can give almost exactly the reflected response",
        mirror_images,
        (16,),
        GROUP,
    ),
    Claim(
        "R8a",
        "V.B, Fig. 9",
        "force at which the open region reaches the lowest row at friction 1 over that at 0.2",
        "smaller than for 0.2",
        floor_earlier,
        (8, 9),
        GROUP,
    ),
    Claim("R8b", "V.B, Fig. 9", "peaks beyond it at friction 1", "one peak remains", one_peak_beyond, (9,), GROUP),
    Claim(
        "R9",
        "V.A, Fig. 7",
        "force of the crossover to two peaks against friction",
        "rapidly increases with friction",
        crossover_rises,
        (7,),
        GROUP,
    ),
    Claim(
        "R10",
        "V.B, Figs. 4, 8",
        "opened contacts at friction 0.2 over those without friction under the same force",
        "the region of open contacts is considerably smaller",
        smaller_region,
        (4, 8),
        GROUP,
    ),
    Claim(
        "R11",
        "V.B, Figs. 4, 8",
        "force at which the open region reaches the lowest row at friction 0.2 over that without friction",
        "it reaches the floor only for a much larger force",
        floor_later,
        (4, 8),
        GROUP,
    ),
    Claim(
        "F11",
        "V.A, Fig. 6",
        "without friction: change of the response at x = 0 over the forces at which no contact has opened",
        "a linear range even for frictionless particles",
        elastic_without_friction,
        (6,),
        GROUP,
    ),
    Claim(
        "A1",
        "abstract",
        "end of the linear range, and first opening, against friction from 0 to 1",
        "the larger the friction, the more extended the range of forces with an elastic response",
        range_grows,
        (6,),
        GROUP,
    ),
    Claim(
        "A2",
        "abstract",
        "dip of the floor response at x = 0 under 15 mg against friction",
        "the larger the friction, the smaller the anisotropy",
        smaller_anisotropy,
        (12,),
        GROUP,
    ),
    Claim(
        "K4",
        "V.D, Fig. 12",
        "F = 15 mg, k_T/k_N = 0.8: dip at x = 0 without and with much friction; friction at which two peaks turn into "
        "one, by bisection",
        "a crossover from two peaks to one",
        friction_crossover,
        (12,),
        GROUP,
    ),
)
