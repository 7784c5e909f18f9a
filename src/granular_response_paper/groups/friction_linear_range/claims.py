"""Claims of Secs. I and V: ordered slabs with friction under growing forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
import xarray as xr

from granular_response.state import OPEN, SLIDING, FloatArray
from granular_response_paper.claims import bounds, preparations
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP = "friction_linear_range"
CLAIMS = Claims(__package__)

#: Frictions of the paper (Fig. 6, Sec. V.B), and how far off a response may no longer be linear.
FRICTIONS, TOLERANCES = (0.0, 0.2, 1.0), (0.01, 0.02, 0.05)


def _curve(data: Data, friction: float, name: str) -> xr.Dataset:
    """The response at a friction, at the forces at which this is measured."""
    curve = at(data.get(GROUP, "response"), friction=friction)
    return curve.isel(force=np.isfinite(curve[name].values))


def _linear(data: Data, friction: float, tolerance: float) -> Quantity:
    """The end of the linear range: located to 1 %, else between two stored forces."""
    if tolerance == TOLERANCES[0]:
        return data.event(GROUP, "linear_range", friction)
    return bounds.linear_until(_curve(data, friction, "response_at_centre"), tolerance)


@CLAIMS.measures("R1")
def linear_range(data: Data, words: Words) -> list[Test]:
    least, most = (10.0 ** (1.0 + sign * words["almost"]) for sign in (-1.0, 1.0))

    def tests(without: Quantity, *ends: Quantity, case: str = "") -> list[Test]:
        return [
            Test(f"times longer at friction {mu:g}", end.per(without), Bound(least, most, "almost"), case)
            for mu, end in zip(FRICTIONS[1:], ends, strict=True)
        ]

    own = {part: {mu: _linear(data, mu, part) for mu in FRICTIONS} for part in TOLERANCES}
    found = [one for part, ends in own.items() for one in tests(*ends.values(), case=f"response {part:.0%} off")]
    return found + preparations.tested(data, "linear_range", FRICTIONS, own[TOLERANCES[0]], tests)


@CLAIMS.measures("A1")
def range_grows(data: Data, words: Words) -> list[Test]:
    every = np.unique(data.get(GROUP, "response")["friction"].values).tolist()
    tests = []
    for name, frictions in (("frictions 0, 0.2 and 1", list(FRICTIONS)), ("all frictions", every)):
        for part in TOLERANCES:
            ends = [_linear(data, mu, part) for mu in frictions]
            tests.append(bounds.rises("range", ends, f"response {part:.0%} off, {name}"))
        ends = [data.event(GROUP, "first_opening", mu) for mu in frictions]
        tests.append(bounds.rises("range", ends, f"first opening, {name}"))
    for event in ("first_opening", "linear_range"):
        own = {mu: data.event(GROUP, event, mu) for mu in FRICTIONS}
        tests += preparations.tested(data, event, FRICTIONS, own, lambda *ends: [bounds.rises("range", ends)])
    return tests


@CLAIMS.measures("A2")
def smaller_anisotropy(data: Data, words: Words) -> list[Test]:
    axis = data.get(GROUP, "friction_axis").sortby("friction")
    largest = float(data.get(GROUP, "response")["friction"].max())
    elastic = _curve(data, largest, "response_at_centre")["floor_response"].transpose("force", "floor_disk").values[0]
    response = axis["floor_response"].transpose("friction", "floor_disk").values
    off = np.sqrt(((response - elastic) ** 2).sum(axis=1) / (elastic**2).sum())
    tests = []
    for case, size in (("dip at x = 0", axis["central_dip"].values), ("difference from the elastic response", off)):
        growth, fall = Quantity.exact(np.diff(size).max()), Quantity.exact(1.0 - size[-1] / size[0])
        tests.append(Test("largest growth with friction", growth, bounds.at_most(words, "visible"), case, "%"))
        tests.append(Test("fall over all frictions", fall, bounds.at_least(words, "marked"), case, "%"))
    return tests


@CLAIMS.measures("F11")
def elastic_without_friction(data: Data, words: Words) -> list[Test]:
    curve = _curve(data, 0.0, "response_at_centre")
    until = data.event(GROUP, "first_opening", 0.0).low
    before = curve["response_at_centre"].values[curve["force"].values <= until]
    CLAIMS.needs(before.size > 1, "response holds too few forces before the first opening")
    change = Quantity.exact(np.ptp(before) / before[0])
    return [Test("change of the response before a contact opens", change, bounds.at_most(words, "visible"), unit="%")]


def _slides(states: xr.Dataset, force: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Which contacts of disks slide under a force; where contacts that touch are, from the load; and if horizontal."""
    one = at(states.assign_coords(force=states["force"]), force=force)
    position, first, second = (one[name].values for name in ("position", "contact_disk", "contact_partner"))
    touching = one["contact_status"].values != OPEN
    away = 0.5 * (position[first] + position[second]) - position[int(one["loaded_disk"])]
    level = np.abs(position[first, 1] - position[second, 1]) < 0.5 * np.sqrt(3.0)
    return (one["contact_status"].values == SLIDING)[touching], away[touching], level[touching]


@CLAIMS.measures("I1")
def far_from_the_load(data: Data, words: Words) -> list[Test]:
    tests = []
    for force in (5.0, 15.0):
        slides, away, _ = _slides(data.get(GROUP, "states_mu_0.2"), force)
        far = np.hypot(*away.T) > 20.0
        CLAIMS.needs(far.any(), "states_mu_0.2 holds no contact farther than 20 radii from the load")
        parts = {
            "per contact there": slides[far].mean(),
            "per sliding contact": far[slides].sum() / max(slides.sum(), 1),
        }
        for per, part in parts.items():
            none, case = bounds.at_most(words, "few per cent"), f"{per}, {force:g} mg"
            tests.append(Test("sliding contacts far from the load", Quantity.exact(part), none, case, "%"))
    return tests


@CLAIMS.measures("R12")
def sliding_near(data: Data, words: Words) -> list[Test]:
    tests = []
    for radius, force in product((6.0, 10.0, 15.0), (3.0, 5.0, 10.0, 15.0)):
        slides, away, _ = _slides(data.get(GROUP, "states_mu_0.2"), force)
        CLAIMS.needs(slides.any(), f"states_mu_0.2 holds no sliding contact under {force:g} mg")
        part = Quantity.exact((np.hypot(*away[slides].T) < radius).mean())
        case = f"within {radius:g} R at {force:g} mg"
        tests.append(Test("part of the sliding contacts", part, bounds.at_least(words, "marked"), case, "%"))
    return tests


@CLAIMS.measures("R13")
def spreads_downward(data: Data, words: Words) -> list[Test]:
    depths = []
    for force in (2.0, 5.0, 10.0, 15.0):
        slides, away, _ = _slides(data.get(GROUP, "states_mu_0.2"), force)
        depths.append(Quantity.exact(-np.quantile(away[slides, 1], 0.1)))
    return [bounds.rises("depth", depths)]


@CLAIMS.measures("R4c")
def reorganized(data: Data, words: Words) -> list[Test]:
    """In the region that has opened contacts: below the load, as far to each side as it is deep there."""
    parts = []
    for force in (20.0, 30.0):
        slides, away, level = _slides(data.get(GROUP, "states_mu_0.2"), force)
        below = np.abs(away[:, 0]) < -away[:, 1] / np.sqrt(3.0)
        CLAIMS.needs((slides & below).any(), f"states_mu_0.2 holds no sliding contact below the load at {force:g} mg")
        parts.append(Quantity.exact(level[slides & below].mean()))
    before, after = parts
    return [
        Test("horizontal part of the sliding contacts at 20 mg", before, Bound(0.0), unit="%"),
        Test("that at 30 mg per that at 20 mg", after.per(before), bounds.lower(words, "nearly"), unit="%"),
    ]


def _jump(data: Data) -> tuple[xr.Dataset, int]:
    """The dynamic runs at large forces, in order, and the index of the first asymmetric one."""
    runs = data.get(GROUP, "large_forces").sortby("force")
    lost = np.flatnonzero(runs["asymmetry"].values > 0.1)
    CLAIMS.needs(lost[:1].any(), "large_forces holds no forces on both sides of the loss of symmetry")
    return runs, int(lost[0])


@CLAIMS.measures("R5b")
def sharp(data: Data, words: Words) -> list[Test]:
    runs, first = _jump(data)
    step = Quantity.exact(np.diff(runs["asymmetry"].values)[first - 1])
    return [Test("change between two forces, per largest response", step, bounds.at_least(words, "gradual"))]


@CLAIMS.measures("R6a")
def sliding_drops(data: Data, words: Words) -> list[Test]:
    runs, first = _jump(data)
    sliding = runs["mobilised_contacts"].transpose("force", "margin").values
    return [
        Test(
            "after per before",
            Quantity.exact(after / before),
            bounds.lower(words, "marked"),
            f"within {margin:.0%}",
            "%",
        )
        for margin, before, after in zip(runs["margin"].values, sliding[first - 1], sliding[first], strict=True)
        if before > 0
    ]


@CLAIMS.measures("R6b")
def network_asymmetric(data: Data, words: Words) -> list[Test]:
    runs, first = _jump(data)
    network = runs["network_asymmetry"].values
    before, after = Quantity.exact(network[first - 1]), Quantity.exact(network[first:].min())
    what = "contacts without a mirror image"
    return [
        Test(f"{what} before", before, bounds.NONE, unit="%"),
        Test(f"{what} after, smallest part", after, Bound(0.0, strict=True), unit="%"),
    ]


@CLAIMS.measures("R6c")
def network_changes(data: Data, words: Words) -> list[Test]:
    runs, first = _jump(data)
    states = data.get(GROUP, "large_force_states")
    states = states.assign_coords(force=states["force"])
    before, after = (
        at(states, force=float(runs["force"][k]))["contact_status"].values != OPEN for k in (first - 1, first)
    )
    part = Quantity.exact((before != after).sum() / before.sum())
    return [Test("contacts that change, per contacts before", part, bounds.at_least(words, "marked"), unit="%")]


@CLAIMS.measures("R6d")
def by_sliding(data: Data, words: Words) -> list[Test]:
    states = data.get(GROUP, "states_mu_1")
    force, status = states["force"].values, states["contact_status"].values
    rest, last = status[0], status[np.flatnonzero(force <= 90.0)[-1]]
    opened = ((rest != OPEN) & (last == OPEN)).sum()
    CLAIMS.needs(opened > 0, "states_mu_1 holds no opened contact")
    ratio = Quantity.exact((last == SLIDING).sum() / opened)
    return [Test("sliding contacts per opened one", ratio, Bound(1.0, strict=True))]


@CLAIMS.measures("R7")
def mirror_images(data: Data, words: Words) -> list[Test]:
    runs, first = _jump(data)
    after = runs.isel(force=slice(first, None))
    response, force, sign = (after[name].values for name in ("floor_response", "force", "asymmetry_sign"))
    # the paper's pair lies between 91 and 95 mg
    apart = [
        float(np.abs(response[a] - response[b][::-1]).max() / response[a].max())
        for a, b in product(range(len(force)), repeat=2)
        if sign[a] * sign[b] < 0 and 0.0 < force[b] - force[a] <= 4.0
    ]
    best = Quantity.exact(min(apart, default=1.0))
    return [Test("difference of one response and the mirrored other", best, bounds.at_most(words, "holds"), unit="%")]


@CLAIMS.measures("R7b")
def similar_beyond(data: Data, words: Words) -> list[Test]:
    runs, first = _jump(data)
    size, force = runs["asymmetry"].values, runs["force"].values
    far = force >= 150.0
    CLAIMS.needs(far.any(), "large_forces ends before 150 mg")
    return [
        Test(
            "asymmetry per that just beyond",
            Quantity.exact(one / size[first]),
            bounds.at_least(words, "similar"),
            f"{f:g} mg",
            "%",
        )
        for f, one in zip(force[far][[0, -1]], size[far][[0, -1]], strict=True)
    ]


def _ratio(event: str, over: float, under: float, bound: Bound, data: Data) -> list[Test]:
    """Of an event at two frictions, in both geometries and in other preparations."""
    what, tests = f"force at friction {over:g} per that at {under:g}", []
    for case, table in (("rows of 61 and 60", "events"), ("rows of 60", "events_equal_rows")):
        found: Mapping[float, Quantity] = {mu: data.event(GROUP, event, mu, table) for mu in (over, under)}
        tests.append(Test(what, found[over].per(found[under]), bound, case))
        if table == "events":
            own = found
    return tests + preparations.tested(
        data, event, (over, under), own, lambda one, other: [Test(what, one.per(other), bound)]
    )


@CLAIMS.measures("R8a")
def floor_earlier(data: Data, words: Words) -> list[Test]:
    return _ratio("reaches_floor", 1.0, 0.2, Bound(most=1.0, strict=True), data)


@CLAIMS.measures("R11")
def floor_later(data: Data, words: Words) -> list[Test]:
    return _ratio("reaches_floor", 0.2, 0.0, bounds.higher(words, "marked"), data)


@CLAIMS.measures("R9")
def crossover_rises(data: Data, words: Words) -> list[Test]:
    frictions: Sequence[float] = np.sort(data.get(GROUP, "response")["friction"].values).tolist()
    found = {}
    for mu in frictions:
        curve = _curve(data, mu, "double_peaked")
        found[mu] = bounds.first(curve, "force", curve["double_peaked"].values > 0.0)
    own = [bounds.rises("crossover force", list(found.values()))]
    return own + preparations.tested(
        data, "crossover", frictions, found, lambda *ends: [bounds.rises("crossover force", ends)]
    )


@CLAIMS.measures("R14")
def not_identical(data: Data, words: Words) -> list[Test]:
    one, other = (
        at(_curve(data, mu, "central_dip"), force=force)["floor_response"].values
        for mu, force in ((0.2, 25.0), (0.0, 4.0))
    )
    apart = Quantity.exact(np.abs(one - other).max() / max(one.max(), other.max()))
    return [Test("difference per largest response", apart, bounds.at_least(words, "visible"), unit="%")]


@CLAIMS.measures("R15")
def rough_walls(data: Data, words: Words) -> list[Test]:
    """Of the preparation that has both kinds of walls: the text's own is in the summary too."""
    smooth = data.event(GROUP, "linear_range", 1.0)
    found = data.get(preparations.GROUP, "events")
    here = (found["name"].values == "linear_range") & (found["wall_friction"].values == 1.0)
    here &= (found["gravity"].values == "at-once") & np.isclose(found["friction"].values, 1.0)
    CLAIMS.needs(here.any(), "the summary of preparations holds no linear range beside rough walls")
    k = int(np.flatnonzero(here)[0])
    rough = Quantity.bracket(found["low"].values[k], found["high"].values[k])
    return [Test("range beside rough walls per smooth", rough.per(smooth), Bound(most=1.0, strict=True))]
