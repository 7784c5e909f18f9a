"""Claims of Secs. I and V: ordered slabs with friction under growing forces."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from itertools import pairwise, product

import numpy as np
import xarray as xr

from granular_response.state import OPEN, SLIDING, FloatArray
from granular_response.studies import linear_end

from ...claims.bounds import (
    TOLERANCES,
    about,
    at_least,
    at_most,
    between,
    higher_by,
    less_than,
    lower_by,
    more_than,
    order_of_magnitude,
    sampled,
)  # fmt: skip
from ...claims.claim import PREPARATION, ROBUSTNESS, SLAB, Ask, Case, Claims, Data, Numbers, at, rise
from ...claims.numbers import Quantity, needs

GROUP = "friction_linear_range"
claim = Claims(GROUP, {**SLAB, "scene.contact.stiffness_ratio": 0.8, "scene.wall.friction": 0.0})

#: Of the paper (Fig. 6, Sec. V.B).
FRICTIONS = (0.0, 0.2, 1.0)
#: "Near the point of application" of sliding contacts: half of the depth of the slab (mean radii).
NEAR = 13.0
#: Of the responses at large forces, from which symmetry is lost.
ASYMMETRIC = 0.2
LITERAL = "events_equal_rows"


def _curve(data: Data, friction: float, name: str) -> xr.DataArray:
    """What is measured at a friction, along the forces at which it is."""
    return at(data.get(GROUP, "response"), friction=friction)[name].dropna("force")


def _at(data: Data, friction: float, force: float, name: str) -> float:
    return data.value(GROUP, f"response.{name}", friction=friction, force=force)


Measure = Callable[[Data], Quantity]


def _linear(tolerance: float, friction: float) -> Measure:
    """The end of the linear range: located to 1 %, else between two stored forces."""

    def end(data: Data) -> Quantity:
        if tolerance == TOLERANCES[0]:
            return data.event("linear_range", friction)
        curve = _curve(data, friction, "response_at_centre")
        return Quantity.bracket(*linear_end(curve["force"], curve, tolerance))

    return end


def _event(name: str, friction: float, table: str = "events") -> Measure:
    return lambda data: data.event(name, friction, table)


def _per(one: Measure, other: Measure) -> Measure:
    return lambda data: one(data).per(other(data))


def _rises(measures: Iterable[Measure]) -> Measure:
    found = list(measures)
    return lambda data: rise(one(data) for one in found)


@claim("A1", "abstract", Ask("range, smallest ratio of neighbours", more_than(1.0)),
       primary="1 % off, frictions 0, 0.2 and 1", figures=[6], finds="any")  # fmt: skip
def range_grows(data: Data) -> Numbers:
    """The larger the coefficient of static friction, the more extended is the range of forces for which the response is
    elastic and the smaller the anisotropy.
    Short: The elastic range grows with friction
    Here: Of the frictions 0, 0.2 and 1 the linear range at one is at least {0} times that at the one before (below 1:
    it shrinks), the force of the first opening at least {first opening, frictions 0, 0.2 and 1|0} times.
    Remark: The range at x = 0 is longest near friction 0.2 to 0.5. At friction 1 it is still some eight times that
    without friction. The paper prints first openings alone, which grow"""
    every = np.unique(data.get(GROUP, "response")["friction"].values).tolist()
    linear, opening = partial(_linear, TOLERANCES[0]), partial(_event, "first_opening")
    for case, dashpots in (("", True), (", the paper's dashpots", False)):
        yield f"1 % off, frictions 0, 0.2 and 1{case}", data.protocol(_rises(map(linear, FRICTIONS)), dashpots=dashpots)
    for tolerance in TOLERANCES[1:]:
        name = f"{100 * tolerance:g} % off, frictions 0, 0.2 and 1"
        yield name, _rises(_linear(tolerance, mu) for mu in FRICTIONS)(data)
    yield "first opening, frictions 0, 0.2 and 1", data.protocol(_rises(map(opening, FRICTIONS)))
    yield "1 % off, all frictions", _rises(map(linear, every))(data)
    yield "first opening, all frictions", _rises(map(opening, every))(data)
    yield from data.elsewhere(_rises(map(linear, FRICTIONS)))


@claim("A2", "abstract", Ask("largest growth with friction", at_most("visible"), "%"),
       Ask("fall over all frictions", at_least("marked"), "%"), primary="dip at x = 0", figures=[12],
       requires={"friction_axis.force": 15.0})  # fmt: skip
def smaller_anisotropy(data: Data) -> Numbers:
    """As A1.
    Short: Anisotropy decreases with friction
    Here: Under 15 mg the dip at x = 0 disappears from friction 0 to 2. The difference from the elastic response falls
    by {difference from the elastic response|1} and grows by up to {difference from the elastic response|0} between two
    frictions.
    Remark: Elastic is the response to the smallest force at the largest friction. Two peaks are the paper's sign of
    anisotropy"""
    axis = data.get(GROUP, "friction_axis").sortby("friction")
    elastic = _curve(data, 1.0, "floor_response").transpose("force", ...).values[0]
    response = axis["floor_response"].transpose("friction", "floor_disk").values
    off = np.sqrt(((response - elastic) ** 2).sum(axis=1) / (elastic**2).sum())
    for case, size in (("dip at x = 0", axis["central_dip"].values), ("difference from the elastic response", off)):
        yield case, np.diff(size).max(), 1.0 - size[-1] / size[0]


@claim("F1", "V.B", Ask("first opening at friction 0", sampled(0.75), "mg", 0.75),
       Ask("first opening at friction 0.2", sampled(4.0), "mg", 4.0),
       Ask("first opening at friction 1", sampled(6.0), "mg", 6.0),
       Ask("ratio at friction 0.2", order_of_magnitude(), paper=4.0 / 0.75),
       Ask("ratio at friction 1", order_of_magnitude(), paper=6.0 / 0.75), primary="central third",
       figures=[4, 6, 8, 9], finds="any")  # fmt: skip
def openings(data: Data) -> Numbers:
    """We first recall that such changes occur at significantly larger applied forces in the frictional case (by almost
    an order of magnitude): the first contact is opened when F_ext = 0.75mg in the frictionless case, F_ext = 4mg for µ
    = 0.2, and F_ext = 6mg for µ = 1.
    Short: First contacts open at 0.75, 4 and 6 mg (friction 0, 0.2, 1)
    Here: In the central third the first contact opens at {0} without friction, {1} at friction 0.2 and {2} at friction
    1, at {3} and {4} times the frictionless force; anywhere in the slab at {any contact|0}, {any contact|1} and {any
    contact|2}.
    Remark: Figs. 4, 8 and 9 show the central third. Near the upper corners contacts are hardly pressed and open
    earlier"""

    def all_of(name: str, table: str = "events") -> list[Measure]:
        events = [_event(name, mu, table) for mu in FRICTIONS]
        return [*events, *(_per(event, events[0]) for event in events[1:])]

    measures = all_of("first_opening")
    ramps = [("", 0.0), *(("first_opening", mu) for mu in FRICTIONS[1:]), ("", 0.0), ("", 0.0)]
    yield "central third", *(data.protocol(one, *ramp) for one, ramp in zip(measures, ramps, strict=True))
    yield "any contact", *(one(data) for one in all_of("first_opening_anywhere"))
    yield "rows of 60", *(one(data) for one in all_of("first_opening", LITERAL))
    yield "any contact, rows of 60", *(one(data) for one in all_of("first_opening_anywhere", LITERAL))
    yield from data.elsewhere(*measures)


def _slides(data: Data, force: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Which contacts of disks slide at friction 0.2 under a force; where those that touch are, from the load; and if
    they are horizontal.
    """
    states = data.get(GROUP, "states_mu_0.2")
    one = at(states.assign_coords(force=states["force"]), force=force)
    position, first, second = (one[name].values for name in ("position", "contact_disk", "contact_partner"))
    touching = one["contact_status"].values != OPEN
    away = 0.5 * (position[first] + position[second]) - position[int(one["loaded_disk"])]
    level = np.abs(position[first, 1] - position[second, 1]) < 0.5 * np.sqrt(3.0)
    needs(np.isfinite(away).all(), "states_mu_0.2 holds no positions")
    slides = (one["contact_status"].values == SLIDING)[touching]
    needs(slides.any(), f"states_mu_0.2 holds no sliding contact under {force:g} mg")
    return slides, away[touching], level[touching]


@claim("I1", "I", Ask("sliding contacts far from the load", at_most("few per cent"), "%"),
       primary="per contact there, 15 mg", figures=[8])  # fmt: skip
def far_from_the_load(data: Data) -> Numbers:
    """Sufficiently far from the point of application the external force leads to practically no sliding or
    rearrangement of the grains.
    Short: Far from the load there is practically no sliding
    Here: At friction 0.2 and 15 mg, {0} of the contacts farther than 20 radii from the load slide; of all sliding
    contacts {per sliding contact, 15 mg|0} are there. At 5 mg these are {per contact there, 5 mg|0} and {per sliding
    contact, 5 mg|0}.
    Remark: Practically none is taken as a few per cent of the contacts there. The slab of 15 layers is 26 radii deep;
    15 mg is the force of Figs. 10 to 14"""
    for force in (15.0, 5.0):
        slides, away, _ = _slides(data, force)
        far = np.hypot(*away.T) > 20.0
        needs(far.any(), "states_mu_0.2 holds no contact farther than 20 radii from the load")
        yield f"per contact there, {force:g} mg", slides[far].mean()
        yield f"per sliding contact, {force:g} mg", far[slides].mean()


@claim("I2", "I", Ask("contacts at the larger friction per those at the smaller one", less_than(1.0), "%"),
       primary="friction 1 per 0.2", requires={"friction_axis.force": 15.0}, figures=[12])  # fmt: skip
def rarer(data: Data) -> Numbers:
    """The latter events are rarer the larger the friction and therefore, as shown below, the linearity and isotropy of
    the response are enhanced by friction.
    Short: Sliding is rarer the larger the friction
    Here: Under 15 mg friction 1 has {0} of the sliding contacts of friction 0.2, {friction 1 per 0.5|0} of those of
    friction 0.5, and {opened contacts, friction 1 per 0.2|0} of the opened contacts of friction 0.2.
    Remark: The text does not say what a rearrangement is; opened contacts are given beside"""
    slides = data.get(GROUP, "friction_axis").sortby("friction")["sliding_contacts"]
    number = dict(zip(slides["friction"].values.tolist(), slides.values.tolist(), strict=True))
    frictions = [mu for mu in number if 0.0 < mu <= 1.0]
    yield "friction 1 per 0.2", number[1.0] / number[0.2]
    opened = (_at(data, mu, 15.0, "opened_contacts") for mu in (1.0, 0.2))
    yield "opened contacts, friction 1 per 0.2", next(opened) / next(opened)
    for before, after in pairwise(frictions):
        yield f"friction {after:g} per {before:g}", number[after] / number[before]


@claim("R1", "V.A, Fig. 6", Ask("times longer at friction 0.2", order_of_magnitude(), paper=10.0),
       Ask("times longer at friction 1", order_of_magnitude(), paper=10.0), primary="1 % off", finds="any")  # fmt: skip
def linear_range(data: Data) -> Numbers:
    """As shown in Fig. 6, friction has a significant effect on the linearity of the response: The extent of the linear
    range is significantly larger (by almost an order of magnitude; notice the logarithmic scale on the horizontal axis
    in Fig. 6) in frictional systems, so that elasticity is enhanced by friction.
    Short: The linear range with friction is almost ten times longer
    Here: The linear range (1 % departure) is {0} times longer at friction 0.2 than without friction, and {1} times at
    friction 1. In slabs of 121 and 241 disks a row it is {121 disks a row|0} and {241 disks a row|0} times at 0.2.
    Remark: The text does not say at which departure a response is no longer linear"""
    for tolerance in TOLERANCES:
        ratios = [_per(_linear(tolerance, mu), _linear(tolerance, 0.0)) for mu in FRICTIONS[1:]]
        first = tolerance == TOLERANCES[0]
        yield f"{100 * tolerance:g} % off", *(data.protocol(ratio) if first else ratio(data) for ratio in ratios)
        if first:
            yield from data.elsewhere(*ratios)


@claim("R2a", "V.A, Fig. 7", Ask("force of the crossover to two peaks", more_than(50.0), "mg"))
def one_peak(data: Data) -> Numbers:
    """For µ = 1 no such crossover is observed even for the largest force shown, F_ext = 50mg (a different type of
    crossover occurs for µ = 1 for large forces, as described in Sec. V E).
    Short: At friction 1 one peak remains up to 50 mg
    Here: At friction 1 the response has one peak along the whole load path; a crossover would be {0}."""
    crossover = _event("crossover", 1.0)
    yield data.protocol(crossover)
    yield from data.elsewhere(crossover)


@claim("R3a", "V.E, Fig. 16a", Ask("force of the crossover to two peaks", about(20.0), "mg", 20.0),
       primary="rows of 61 and 60", figures=[7, 16], finds="any")  # fmt: skip
def crossover(data: Data) -> Numbers:
    """For finite µ, this compensation is limited by the Coulomb condition, a limitation which becomes more significant
    as the applied force is increased: for µ = 0.2, the region of open contacts (the "teardrop") reaches the floor for
    F_ext ≃ 20mg, which in this case seems to be the crossover force [see Fig. 16(a)].
    Short: At friction 0.2 two peaks appear at about 20 mg
    Here: At friction 0.2 two peaks appear at {0:3}. Slabs of 121 disks a row have them from {121 disks a row|0}, rows
    of 60 disks from {rows of 60|0}."""
    force = _event("crossover", 0.2)
    yield "rows of 61 and 60", data.protocol(force, "crossover", 0.2)
    yield "rows of 60", data.event("crossover", 0.2, LITERAL)
    yield from data.elsewhere(force)


@claim("R3b", "V.E, Fig. 8", Ask("force at which the connected region reaches the lowest row", about(20.0), "mg", 20.0),
       primary="rows of 61 and 60", finds="any")  # fmt: skip
def reaches_floor(data: Data) -> Numbers:
    """As R3a.
    Short: At friction 0.2 the open region reaches the floor at about 20 mg
    Here: At friction 0.2 the open region reaches the lowest row at {0:3}, in rows of 60 disks at {rows of 60|0}.
    Remark: The region is connected. Single contacts of the lowest row open a little earlier"""
    force = _event("reaches_floor", 0.2)
    yield "rows of 61 and 60", data.protocol(force)
    yield "the paper's dashpots", data.protocol(force, dashpots=False)
    yield "rows of 60", data.event("reaches_floor", 0.2, LITERAL)
    yield from data.elsewhere(force)


@claim("R4", "V.E, Fig. 16a", Ask("force from which there is a third peak", sampled(40.0), "mg", 40.0),
       Ask("its prominence at 40 mg per largest response", at_most("small"), "%"),
       Ask("fall of the horizontal part of the sliding contacts from 20 to 30 mg", at_least("nearly"), "%"),
       primary="rows of 61 and 60", finds="any")  # fmt: skip
def third_peak(data: Data) -> Numbers:
    """For larger forces (F_ext ≳ 40mg), a small third peak appear at x = 0 (below the point of application), which
    appears to be related to a reorganization of the sliding contacts within the "teardrop".
    Short: A small third peak appears from about 40 mg
    Here: At friction 0.2 a third peak appears at {0:3} and has {1} of the largest response at 40 mg. The horizontal
    part of the sliding contacts in the open region falls by {2} from 20 to 30 mg.
    Remark: The prominence grows with the force, to a third of the largest response at 80 mg. That the reorganization of
    sliding contacts goes with the peak is no proof that it causes it"""
    force = _event("third_peak", 0.2)
    parts = []
    for at_force in (20.0, 30.0):  # below the load, as far to each side as the region is deep there
        slides, away, level = _slides(data, at_force)
        below = np.abs(away[:, 0]) < -away[:, 1] / np.sqrt(3.0)
        needs((slides & below).any(), f"states_mu_0.2 holds no sliding contact below the load at {at_force:g} mg")
        parts.append(level[slides & below].mean())
    prominence = _at(data, 0.2, 40.0, "third_peak_prominence")
    yield "rows of 61 and 60", data.protocol(force, "third_peak", 0.2), prominence, 1.0 - parts[1] / parts[0]
    yield "the paper's dashpots", data.protocol(force, "third_peak", 0.2, dashpots=False), None, None
    for case, found in data.elsewhere(force):
        yield case, found, None, None


def _jump(data: Data) -> tuple[xr.Dataset, xr.Dataset]:
    """Of the dynamic runs at large forces the last one before symmetry is lost, and those after it."""
    runs = data.get(GROUP, "large_forces").sortby("force")
    asymmetry = runs["asymmetry"].values
    needs(np.isfinite(asymmetry).all(), "large_forces holds no asymmetry")
    lost = np.flatnonzero(asymmetry > ASYMMETRIC)
    needs(lost[:1].any(), "large_forces holds no forces on both sides of the loss of symmetry")
    return runs.isel(force=lost[0] - 1), runs.isel(force=slice(lost[0], None))


@claim("R5b", "V.E, Fig. 16b", Ask("change between two forces per largest response", at_least("gradual")),
       requires={"dynamics.friction": 1.0})  # fmt: skip
def sharp(data: Data) -> Numbers:
    """However, when the force exceeds F_ext = 91mg, we obtain a sharp transition to a very different response shape
    [see Fig. 16(b)], which is very asymmetric (unlike the symmetric double peaked response obtained for lower friction
    at large forces).
    Short: The transition to an asymmetric response is sharp
    Here: From one force to the next, 1 mg larger, the asymmetry grows by {0} (0: symmetric, 2: all on one side)."""
    before, after = (runs["asymmetry"].values for runs in _jump(data))
    yield after[0] - before


@claim("R6", "V.E", Ask("contacts at the Coulomb limit after per before", lower_by("marked"), "part"),
       Ask("contacts that open or close, per contacts opened by the force", at_least("marked"), "%"),
       Ask("contacts without a mirror image before", at_most(0.0), "part"),
       Ask("contacts without a mirror image after, smallest part", more_than(0.0), "%"),
       primary="within 1 % of the limit, per opened contact", figures=[16],
       requires={"dynamics.friction": 1.0})  # fmt: skip
def transition(data: Data) -> Numbers:
    """The transition to an asymmetric response is accompanied by a significant change in the contact network (which
    becomes asymmetric), and by a marked reduction in the number of sliding contacts.
    Short: It comes with changes in the network and much less sliding
    Here: Beyond the transition {0} of the former sliding contacts are left. The number of contacts that open or close
    is {1} of those that the force had opened. Contacts without a mirror image: {2} before it, {3} after it.
    Remark: In equilibrium a contact that slid rests just below the limit, so that how near counts as sliding is a
    choice. The change of the network is compared with what the force had changed before"""
    before, after = _jump(data)
    states = data.get(GROUP, "large_force_states")
    states = states.assign_coords(force=states["force"])
    forces = [0.0, float(before["force"]), float(after["force"][0])]
    rest, symmetric, lost = (at(states, force=force)["contact_status"].values != OPEN for force in forces)
    changed, opened = float((symmetric != lost).sum()), float((rest & ~symmetric).sum())
    mirror = float(before["network_asymmetry"]), float(after["network_asymmetry"].min())
    for margin, (name, number) in product((0.01, 0.05), {"opened contact": opened, "contact": symmetric.sum()}.items()):
        near = [float(at(one, margin=margin)["mobilised_contacts"]) for one in (before, after.isel(force=0))]
        yield f"within {margin * 100:g} % of the limit, per {name}", near[1] / near[0], changed / number, *mirror


@claim("R6d", "V.E", Ask("largest asymmetry without sliding", at_most(ASYMMETRIC)),
       Ask("smallest asymmetry with sliding", at_least(ASYMMETRIC)),
       Ask("opened contacts without sliding per those with it", at_least(1.0)), primary="95 mg",
       figures=[16])  # fmt: skip
def by_sliding(data: Data) -> Numbers:
    """This instability at large µ appears to be dominated by sliding, rather than by changes in the contact network.
    Short: The instability is dominated by sliding
    Here: Without sliding (friction 10) the response under 95 mg stays symmetric: its asymmetry is {0} at most in kicked
    packings. At friction 1 it is {1} at least. The contacts that 95 mg opens number {2} times as many at friction 10.
    Remark: A control: at friction 10 no contact reaches the Coulomb limit, and more contacts open. Disks were displaced
    by 1e-4 R before they fell"""
    runs = data.get(ROBUSTNESS, "control")
    for force in (95.0, 150.0, 300.0):
        there = np.isclose(runs["force"].values, force)
        one, ten = (runs.isel(run=there & np.isclose(runs["friction"].values, mu)) for mu in (1.0, 10.0))
        needs(not ten["sliding_contacts"].values.any(), "control holds sliding contacts at friction 10")
        opened = ten["opened_contacts"].values.min() / one["opened_contacts"].values.max()
        yield f"{force:g} mg", ten["asymmetry"].values.max(), one["asymmetry"].values.min(), opened


@claim("R7", "V.E",
       Ask("difference of one response and the mirrored other per largest response, median", at_most("holds"), "%"),
       primary="95 mg and 1 mg beside", figures=[16])  # fmt: skip
def mirror_images(data: Data) -> Numbers:
    """The sign of symmetry breaking appears to be related to the transient vibrations which are excited by the
    application of the force; for some very close values of the force [e.g., F_ext = 95mg, shown in Fig. 16(b)] we
    obtain almost exactly the same rescaled response reflected with respect to the vertical axis through x = 0.
    Short: Some responses at nearly equal forces are mirror images
    Here: Of ten copies displaced by 1e-9 R, some lean to each side under each force. Responses to 95 mg and to 94 or
    96 mg that lean to opposite sides differ, one mirrored, by {0} of the peak in the median, those to 95 mg by
    {95 mg|0}."""
    runs = data.get(ROBUSTNESS, "copies")
    needs(np.isfinite(runs["asymmetry"].values).all(), "copies holds no asymmetry")
    runs = runs.isel(run=runs["asymmetry"].values > ASYMMETRIC).transpose("run", "floor_disk", ...)

    def apart(first: float, *others: float) -> list[float]:
        """Of every pair of responses that lean to opposite sides."""
        force, side, response = (runs[name].values for name in ("force", "asymmetry_sign", "floor_response"))
        pairs = product(*(np.flatnonzero(np.isin(force, chosen)) for chosen in ([first], others)))
        opposite = ((response[a], response[b]) for a, b in pairs if side[a] == -side[b])
        return [np.abs(one - other[::-1]).max() / one.max() for one, other in opposite]

    close = apart(95.0, 94.0, 96.0)
    needs(close, "no copies under 95 mg and 1 mg beside lean to opposite sides")
    yield "95 mg and 1 mg beside", np.median(close)
    for force in np.unique(runs["force"].values).tolist():
        if same := apart(force, force):
            yield f"{force:g} mg", np.median(same)


@claim("R7b", "V.E",
       Ask("difference from the response just beyond the transition, rms, mirrored if it leans the other way",
           at_most("similar"), "%"), primary="150 mg", figures=[16], requires={"dynamics.friction": 1.0})  # fmt: skip
def similar_shape(data: Data) -> Numbers:
    """The shape remains qualitatively similar for much larger F_ext.
    Short: The asymmetric shape stays similar for much larger forces
    Here: The response under 150 mg differs from that just beyond the transition by {0} in root mean squares, under 300
    mg by {300 mg|0} and under 500 mg by {500 mg|0}.
    Remark: The response stays asymmetric, less and less so"""
    _, after = _jump(data)
    response = after["floor_response"].transpose("force", "floor_disk").values
    sides, first = after["asymmetry_sign"].values, response[0]
    for force in (150.0, 300.0, 500.0):
        k = int(np.flatnonzero(np.isclose(after["force"].values, force))[0])
        one = response[k] if sides[k] == sides[0] else response[k][::-1]
        yield f"{force:g} mg", float(np.sqrt(((one - first) ** 2).sum() / (first**2).sum()))


@claim("R8", "V.B, Fig. 9", Ask("force at friction 1 per that at 0.2", less_than(1.0)),
       Ask("force of the crossover per force at which the region reaches the floor", more_than(1.0)),
       Ask("width of the peak at 50 mg per that at the smallest force", lower_by("visible"), "%"),
       primary="rows of 61 and 60", figures=[7, 8, 9])  # fmt: skip
def single_peak(data: Data) -> Numbers:
    """In addition, for a larger coefficient of friction, the obtained response does not seem to be compatible with the
    changes in the contact network: as mentioned above [see Fig. 7(b)], for µ = 1 the response remains single peaked
    (and actually its shape becomes sharper) even for rather large forces (see however Sec. V E), while for the same
    force, the response for µ = 0.2 is double peaked. The changes in the contact network for µ = 1 are shown in Fig. 9.
    While the region of open contacts does reach the floor (even for a smaller force than in the case of µ = 0.2), the
    response remains single peaked.
    Short: At friction 1 the region reaches the floor earlier, but one peak remains
    Here: At friction 1 the connected open region reaches the floor at {0} times the force at friction 0.2. One peak
    remains to the end of the load path ({1} times that force), and under 50 mg it has {2} of its width under the
    smallest force."""
    ratio = _per(_event("reaches_floor", 1.0), _event("reaches_floor", 0.2))
    single = _per(_event("crossover", 1.0), _event("reaches_floor", 1.0))
    sharper = _at(data, 1.0, 50.0, "half_maximum_width") / float(_curve(data, 1.0, "half_maximum_width")[0])
    yield "rows of 61 and 60", data.protocol(ratio), data.protocol(single), sharper
    literal = _per(_event("reaches_floor", 1.0, LITERAL), _event("reaches_floor", 0.2, LITERAL))
    yield "rows of 60", literal(data), None, None
    for case, *found in data.elsewhere(ratio, single):
        yield case, *found, None


@claim("R9", "V.A, Fig. 7", Ask("ratio of crossover forces", higher_by("marked"), paper=20.0 / 3.0),
       primary="friction 0.2 per 0")  # fmt: skip
def crossover_rises(data: Data) -> Numbers:
    """Notice that the force for which the crossover from a single peaked to a double peaked response occurs rapidly
    increases with friction (this is also observed in Fig. 6), so that friction renders the response closer to that
    expected from isotropic elasticity (this is further discussed below).
    Short: The crossover force increases rapidly with friction
    Here: From friction 0 to 0.2 the crossover force grows by a factor of {0}; from one of the frictions 0, 0.05, 0.1,
    0.2 to the next by {smallest step up to friction 0.2|0} at least.
    Remark: Rapidly is taken as a marked increase. The paper's number is 20 mg (Sec. V.E) per 3 mg (its Fig. 3)"""
    ratio = _per(_two_peaks(0.2), _two_peaks(0.0))
    yield "friction 0.2 per 0", data.protocol(ratio)
    steps = _rises(map(_two_peaks, (0.0, 0.05, 0.1, 0.2)))
    yield "smallest step up to friction 0.2", data.protocol(steps)
    yield from data.elsewhere(ratio)


def _two_peaks(friction: float) -> Measure:
    """The crossover force: located, or that of the study ``robustness`` at a friction whose events are not."""

    def force(data: Data) -> Quantity:
        located = data.variant or data.prepared or friction in FRICTIONS
        return (data if located else replace(data, variant="as in the paper")).event("crossover", friction)

    return force


@claim("R10", "V.B, Figs. 4, 8",
       Ask("opened contacts at friction 0.2 per those without, 5 mg", lower_by("marked"), "%"),
       Ask("force at which the region reaches the floor per that without", higher_by("marked")),
       primary="rows of 61 and 60")  # fmt: skip
def smaller_region(data: Data) -> Numbers:
    """For the same force, the region of open contacts is considerably smaller in the frictional case than in the
    frictionless case [compare Fig. 4(c) and Fig. 8(a)]. In addition, this region reaches the floor only for a much
    larger force [compare Fig. 4(c) and Fig. 8(c)].
    Short: Friction makes the open region smaller, so that it reaches the floor later
    Here: Under 5 mg friction 0.2 opens {0} of the number of contacts that open without friction. The open region
    reaches the floor at {1} times the force without friction."""
    opened = _at(data, 0.2, 5.0, "opened_contacts") / _at(data, 0.0, 5.0, "opened_contacts")
    ratio = _per(_event("reaches_floor", 0.2), _event("reaches_floor", 0.0))
    yield "rows of 61 and 60", opened, data.protocol(ratio)
    yield "rows of 60", None, _per(_event("reaches_floor", 0.2, LITERAL), _event("reaches_floor", 0.0, LITERAL))(data)
    for case, found in data.elsewhere(ratio):
        yield case, None, found


@claim("R12", "V.E", Ask("part of the sliding contacts near the load", at_least("marked"), "part"),
       Ask("depth of the sliding contacts, smallest ratio of neighbouring forces", more_than(1.0)),
       primary="within 13 R, from 3 to 15 mg", figures=[8], finds="any")  # fmt: skip
def sliding(data: Data) -> Numbers:
    """Sliding does occur in the system (mainly near the point of application) even for smaller forces, and sliding
    contacts spread gradually downward with increasing F_ext (possibly due to the fact that the displacements induced by
    the applied force decay with the distance from it).
    Short: Below the crossover sliding is near the load and spreads downward
    Here: At friction 0.2, {within 13 R at 3 mg|0} of the sliding contacts lie within half of the slab's depth of the
    load under 3 mg, {within 13 R at 5 mg|0} under 5 mg, {within 13 R at 10 mg|0} under 10 mg and {within 13 R at
    15 mg|0} under 15 mg. The depth above which nine tenths of them lie grows by a factor of {1} at least from each of
    the forces 2, 5, 10 and 15 mg to the next.
    Remark: The text names no distance and no force, so that the range over forces below the crossover decides; half of
    the depth is taken"""
    found = (_slides(data, force) for force in (2.0, 5.0, 10.0, 15.0))
    depth = (np.quantile(away[slides, 1], 0.1) for slides, away, _ in found)
    spread = min(after / before for before, after in pairwise(depth))
    for radius in (NEAR, 6.0, 10.0):
        parts = {}
        for force in (5.0, 3.0, 10.0, 15.0):
            slides, away, _ = _slides(data, force)
            parts[force] = float((np.hypot(*away[slides].T) < radius).mean())
        if radius == NEAR:
            yield f"within {radius:g} R, from 3 to 15 mg", Quantity.over(parts.values()), spread
        for force, part in parts.items():
            yield f"within {radius:g} R at {force:g} mg", part, None


@claim("R14", "V.E", Ask("largest step at friction 0.2 per largest response", at_most("gradual"), "%"),
       Ask("largest step at friction 0", at_most("gradual"), "%"), figures=[3, 7])  # fmt: skip
def gradual(data: Data) -> Numbers:
    """As described above, for a relatively small coefficient of friction we observe a gradual crossover from a single
    peaked to a double peaked response as a function of the magnitude of the externally applied force, much like in
    frictionless systems, the main difference being that it occurs at larger values of the applied force [compare Figs.
    3 and 7(a)], although the shape of the response is not identical.
    Short: For small friction the crossover is gradual, as without friction
    Here: Between neighbouring forces around the crossover the response at friction 0.2 changes by {0} of its peak at
    most, without friction by {1}.
    Remark: Largest change of the response of a floor disk away from the side walls, from half to twice the crossover
    force"""
    found = []
    for mu in (0.2, 0.0):
        curve = _curve(data, mu, "floor_response")
        inside = data.get(GROUP, "response")["interior"].values > 0
        force, middle = curve["force"].values, data.event("crossover", mu).low
        near = (force > 0.5 * middle) & (force < 2.0 * middle)
        values = curve.transpose("force", "floor_disk").values[near][:, inside]
        needs(len(values) > 2, f"response holds too few forces around the crossover at friction {mu:g}")
        found.append((np.abs(np.diff(values, axis=0)).max(axis=1) / values[:-1].max(axis=1)).max())
    yield tuple(found)


@claim("R15", "V.A", Ask("linear range beside rough walls per that beside smooth walls", less_than(1.0)), modal=True,
       primary="least of all preparations", figures=[6])  # fmt: skip
def rough_walls(data: Data) -> Numbers:
    """The results shown here were obtained with frictionless walls (µ^wall = 0; see Sec. III), since for weak applied
    forces, frictional walls can support some of the force, inducing nonlinearity in the response at the floor.
    Short: Rough walls can make the response nonlinear at small forces
    Here: At friction 1 the linear range beside rough walls is {0} times that beside smooth walls after gravity has
    grown slowly, and {gravity at once|0} times after gravity at once.
    Remark: What can be is asked of all preparations. One friction and one tolerance. The part of the force that the
    walls support is not looked at. The ends are those of the search; beside rough walls other protocols were not
    tried"""

    def ratio(data: Data) -> Quantity:
        needs(not data.variant, "other slabs beside rough walls")
        prepared = data.prepared or {"gravity": "at-once"}
        rough = data.bracket(
            PREPARATION, "events", **{**prepared, "name": "linear_range", "friction": 1.0, "wall_friction": 1.0}
        )
        return rough.per(data.event("linear_range", 1.0))

    found = {Case("gravity at once"): ratio(data), **dict(data.elsewhere(ratio))}
    yield "least of all preparations", min(found.values(), key=lambda one: one.high)
    yield from found.items()


@claim("K4", "V.D, Fig. 12", Ask("friction at which two peaks turn into one", between(0.001, 0.2)),
       requires={"friction_axis.force": 15.0})  # fmt: skip
def friction_crossover(data: Data) -> Numbers:
    """This increases the anisotropy, since not all the tangential springs can exert forces as large as predicted by the
    above model (in which µ = ∞) and leads to a crossover to a double peaked response.
    Short: Too little friction leads to two peaks (15 mg)
    Here: Under 15 mg two peaks turn into one at friction {0}.
    Remark: At friction 0.2 the paper has one peak at 15 mg, since its crossover is at 20 mg. The ends are those of the
    search; other protocols were not tried"""
    yield data.bracket(GROUP, "events", name="friction_crossover")
