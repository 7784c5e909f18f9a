"""The verdicts follow from the stored data: planted data gives every kind of verdict, what is absent is no number."""

import json
import math
import re
from contextlib import suppress
from dataclasses import replace
from itertools import chain

import numpy as np
import pytest
from claims_data import PILE, dataset, everything, parameters, pile_dip
from places import ROOT
from refusals import refuses
from scipy.stats import binom

from granular_response.store import files as store
from granular_response_paper.claims import bootstrap, bounds, preparations, printed, table
from granular_response_paper.claims.bootstrap import RARE, over_brackets, over_realizations, part_of
from granular_response_paper.claims.bounds import Limits, about, less_than, more_than, sampled
from granular_response_paper.claims.claim import (
    PREPARATION,
    Ask,
    Case,
    Claims,
    ClaimsError,
    Data,
    Verdict,
    at,
    judge,
    rise,
)  # fmt: skip
from granular_response_paper.claims.claim import tests as made_of
from granular_response_paper.claims.numbers import NotMeasured, Quantity, digits, shown, text
from granular_response_paper.groups.frictionless_crossover.claims import size_in_steps
from granular_response_paper.groups.phase_diagram import claims as phases
from granular_response_paper.groups.phase_diagram.claims import (
    FOUND,
    Crossover,
    linear_end,
    linear_ends,
    order_of,
    shorter,
    trend,
)  # fmt: skip
from granular_response_paper.registry import PAPER, collections

#: Claims of the paper and of its extensions.
EVERY = [claim for one in collections() for claim in table.claims_in(one)]
CLAIM = {claim.id: claim for claim in EVERY}
#: What no data decide; and variables of which nan says that something does not happen.
NEVER, MEANT = {"S4a"}, {"collapse_force", "high"}
NAN = float("nan")


def quick(patch):
    """So that hundreds of verdicts take seconds."""
    patch.setattr(bootstrap, "DRAWS", 200)
    patch.setattr(phases, "_evident_samples", lambda *given: Quantity.exact(float(given[0].mean() > given[1].mean())))


@pytest.fixture
def few_draws(monkeypatch):
    quick(monkeypatch)


@pytest.fixture(scope="module")
def good():
    return Data(everything(), parameters(EVERY))


@pytest.fixture(scope="module")
def entries(good):
    with pytest.MonkeyPatch.context() as patch:
        quick(patch)
        return {claim.id: judge(claim, good) for claim in EVERY}


def changed(data, group, name, /, **variables):
    """The data with other variables in one dataset; None leaves one out."""
    study = data.groups[group][name]
    for variable, values in variables.items():
        given = {} if values is None else {variable: study[variable].copy(data=values)}
        study = study.drop_vars(variable).assign(given)
    return replace(data, groups={**data.groups, group: {**data.groups[group], name: study}})


def moved(data, group, force, **labels):
    """The data with two peaks from another force on, in the events with these labels."""
    events = data.groups[group]["events"]
    there = np.all([events[name].values == label for name, label in {"name": "crossover", **labels}.items()], axis=0)
    return changed(
        data, group, "events", **{end: np.where(there, force, events[end].values) for end in ("low", "high")}
    )


def test_every_claim_has_its_texts_and_stands_at_its_section():
    assert len(CLAIM) == len(EVERY)
    for claim in EVERY:
        assert claim.paper.endswith(".") and 3 <= len(claim.short.split()) <= 15, claim.id
        assert claim.here.endswith(".") or claim.id in NEVER, claim.id
        assert claim.place.startswith("beyond") == (claim.part == "extension")
        assert claim.row in ("statement", "check") and claim.finds in (*table.MEANINGS, "any")
    assert next(claim.id for claim in EVERY if claim.part == "ordered") == "A1"


def test_data_that_agree_with_the_paper_support_every_claim(entries):
    assert {name for name, entry in entries.items() if entry.verdict != "supported"} == NEVER


def test_without_data_nothing_is_measured_and_the_reason_names_what_is_missing():
    for claim in EVERY:
        entry = judge(claim, Data({}, parameters(EVERY)))
        assert entry.verdict == "not measured" and entry.tests == () and "data/" in entry.missing, claim.id


class Spy(dict):
    """Datasets that remember which of them were asked for."""

    def __init__(self, name, content, seen):
        super().__init__(content)
        self.name, self.seen = name, seen

    def __getitem__(self, key):
        self.seen.add((self.name, key))
        return super().__getitem__(key)


def read_by(claim, data):
    """The datasets that a claim reads."""
    seen = set()
    judge(claim, replace(data, groups={name: Spy(name, sets, seen) for name, sets in data.groups.items()}))
    return seen


def without_numbers(entry):
    """A verdict that holds no number, in the row that is stored."""
    row = table._row(entry)
    assert (entry.verdict, row["value"], row["interval"], row["tests"]) == ("not measured", None, None, [])
    assert not row["star"] and not row["cases"] and row["gravity"]["of"] == row["lattice"]["of"] == 0
    return True


def same(one, other):
    return [test.found for test in one.tests] == [test.found for test in other.tests]


@pytest.mark.parametrize("name", sorted(set(CLAIM) - NEVER))
def test_what_is_absent_becomes_no_number(few_draws, good, entries, name):
    """Without a dataset, a variable, or its numbers, a claim says what it said, or nothing: never another number.

    The summary of other preparations may be missing: then they are not tried.
    """
    claim, hurt = CLAIM[name], 0
    for group, kept in sorted(read_by(claim, good)):
        study = good.groups[group][kept]
        gone = {other: one for other, one in good.groups[group].items() if other != kept}
        absent = [replace(good, groups={**good.groups, group: gone})]
        for variable in study.data_vars:
            absent.append(changed(good, group, kept, **{variable: None}))
            if study[variable].dtype.kind == "f" and variable not in MEANT:
                absent.append(changed(good, group, kept, **{variable: np.full(study[variable].shape, np.nan)}))
        for data in absent:
            entry = judge(claim, data)
            if entry.missing:
                hurt += without_numbers(entry)
            elif group != PREPARATION:
                assert same(entry, entries[name]) or set(entry.primary) <= set(entries[name].primary), (group, kept)
    assert hurt, "nothing that this claim reads can be missing"


@pytest.mark.parametrize("name", sorted(claim.id for claim in EVERY if claim.requires))
def test_data_of_other_parameters_decide_nothing(good, name):
    claim = CLAIM[name]
    for key in claim.requires:
        for other in ("of another kind", None):
            given = {k: v for k, v in good.parameters[claim.group].items() if k != key}
            given |= {key: other} if other else {}
            entry = judge(claim, replace(good, parameters={**good.parameters, claim.group: given}))
            assert without_numbers(entry) and key in entry.missing
    given = {**good.parameters["friction_fields"], "frictions": [0.0, 0.1, 0.2, 1.0]}  # more than the paper's
    more = replace(good, parameters={**good.parameters, "friction_fields": given})
    assert judge(CLAIM["S2"], more).verdict == "supported"


def test_the_papers_own_numbers_pass_every_test_that_has_one():
    own = [(claim.id, ask) for claim in EVERY for ask in claim.asks if ask.paper is not None]
    assert len(own) > 15
    for name, ask in own:
        assert ask.bound.limits(bounds.THRESHOLDS).outcome(Quantity.exact(ask.paper)) == "yes", (name, ask.what)


def mutations(values):
    """Wrong data: emptied, larger, smaller, turned round along each dimension, of the other sign, all alike."""
    yield from (factor * values for factor in (0.0, 30.0, 0.2, 0.03, -1.0))
    yield from (values + 5.0, np.abs(values - values.max()))
    for ends in ((0.1, 3.0), (3.0, 0.1)):
        yield values * np.linspace(*ends, values.size).reshape(values.shape)
    yield np.full_like(values, 7)
    for axis in range(values.ndim):
        yield np.flip(values, axis)


@pytest.mark.parametrize("name", sorted(set(CLAIM) - NEVER))
def test_every_claim_can_fail(few_draws, good, name):
    """Some wrong values of one variable that it reads, or of events and one, turn its verdict to no."""
    claim = CLAIM[name]
    wanted = {"not supported", "not seen"}
    if any(ask.bound.limits(bounds.THRESHOLDS).least == RARE for ask in claim.asks):
        wanted.add("cannot tell")  # that something is rare is known from 146 packings on
    wrong = []
    places = [(*place, good.groups[place[0]][place[1]]) for place in sorted(read_by(claim, good))]
    with_ends = [place for *place, study in places if {"low", "high"} <= set(study.data_vars)]
    ends = [[(*place, end) for end in ("low", "high")] for place in with_ends]
    alone = [[(*place, one)] for *place, study in places for one in study.data_vars]
    moved = [list(chain(*ends))] if ends else []  # an event moves in every table that has it
    for some in moved + alone + [all_ends + one for all_ends in moved for one in alone]:
        values = [good.groups[group][kept][one].values for group, kept, one in some]
        if all(one.dtype.kind in "fi" and one.size for one in values):
            wrong += [(some, one) for one in zip(*map(mutations, values), strict=False)]
    for some, values in wrong:
        data = good
        for (group, kept, one), value in zip(some, values, strict=True):
            data = changed(data, group, kept, **{one: value.astype(good.groups[group][kept][one].dtype)})
        with suppress(NotMeasured, ArithmeticError, IndexError, KeyError, ValueError):
            if Verdict(claim, made_of(claim, data)).verdict in wanted:
                return
    pytest.fail("no wrong value of any variable makes it fail")


def test_mirror_images_need_copies_that_lean_to_opposite_sides(good):
    """That no pair is stored is no difference of a hundred per cent."""
    one_side = changed(good, "robustness", "copies", asymmetry_sign=np.ones(3))
    entry = judge(CLAIM["R7"], one_side)
    assert without_numbers(entry) and "opposite sides" in entry.missing
    response = good.groups["robustness"]["copies"]["floor_response"].values
    unlike = changed(good, "robustness", "copies", floor_response=response * np.linspace(1.0, 2.0, response.shape[1]))
    assert judge(CLAIM["R7"], unlike).verdict == "not supported"


def test_sliding_decides_if_the_control_without_it_stays_symmetric(good):
    control = good.groups["robustness"]["control"]
    lost = np.where(control["friction"].values == 10.0, 1.7, control["asymmetry"].values)
    assert judge(CLAIM["R6d"], changed(good, "robustness", "control", asymmetry=lost)).verdict == "not supported"
    sliding = changed(good, "robustness", "control", sliding_contacts=np.ones(12))
    assert "sliding contacts at friction 10" in judge(CLAIM["R6d"], sliding).missing


def test_the_interval_of_an_event_is_that_of_the_protocol(good):
    """A crossover that dashpots move out of the bound cannot be told; one that the width moves is another case."""

    entry = judge(CLAIM["R3a"], moved(good, "robustness", 14.0, friction=0.2, variant="dashpots halved"))
    assert entry.verdict == "cannot tell" and entry.primary[0].found.low == 14.0
    entry = judge(CLAIM["R3a"], moved(good, "robustness", 14.0, friction=0.2, variant="121 disks a row"))
    assert entry.verdict == "supported" and "Not for: 121 disks a row." in entry.cases


def test_other_preparations_stand_in_columns_of_their_own(good):
    row = table._row(judge(CLAIM["R3a"], moved(good, PREPARATION, 40.0, gravity="slow")))
    said = row["verdict"], row["gravity"]["text"], row["lattice"]["text"]
    assert said == ("supported", "holds in 1 of 2", "not tried")
    assert row["gravity"]["no"] == ["gravity ramped over 20 sqrt(R/g)"]
    assert table._row(judge(CLAIM["D7b"], good))["lattice"]["text"] == "holds in 1 of 1"


def test_a_statement_is_asked_in_part_if_a_case_that_counts_is():
    def held(*found):
        claim = Claims("theory")
        claim("F1", "I", Ask("a", more_than(0.0)), Ask("b", more_than(0.0)), primary="own")(lambda data: iter(found))
        return table._row(judge(claim.rows[0], Data({})))["gravity"]["text"]

    own, other = Case("own, gravity slow", "gravity"), Case("gravity slow", "gravity")
    assert held(("own", 1.0, 1.0), (own, 1.0, 1.0), (other, 1.0, None)) == "holds in 1 of 1"
    assert held(("own", 1.0, 1.0), (own, 1.0, None), (other, 1.0, 1.0)) == "holds in 1 of 1, asked in part"
    assert held(("own", 1.0, 1.0), (other, 1.0, None)) == "holds in 1 of 1, asked in part"


def test_claims_of_the_paper_read_no_dataset_of_an_extension(few_draws, good, entries):
    """But the summary of other preparations: the datasets of groups with extensions alone are not there."""
    own = {claim.group for claim in EVERY if claim.part != "extension"} | {"robustness"}
    kept = {group: sets for group, sets in good.groups.items() if group in own}
    kept[PREPARATION] = {"events": good.groups[PREPARATION]["events"]}
    for entry in entries.values():
        if entry.claim.part != "extension":
            assert same(judge(entry.claim, replace(good, groups=kept)), entry), entry.claim.id


YES, NO, OPEN = (
    Quantity(value, *ends, "confidence") for value, *ends in ((1.5, 1.0, 2.0), (2.5, 2.1, 3.0), (2.0, 1.5, 2.5))
)


def a_claim(*found, here="", **said):
    """Of numbers that must lie from 1 to 2, by case."""
    claim = Claims("theory")
    said = {"primary": "a"} | said

    @claim("F1", "I", Ask("number", bounds.between(1.0, 2.0)), **said)
    def measure(data):
        yield from found

    return replace(claim.rows[0], here=here)


def test_the_primary_case_alone_decides():
    def verdict(*found, **said):
        return judge(a_claim(*found, **said), Data({})).verdict

    assert verdict(("a", YES), ("b", NO), ("c", OPEN)) == "supported"
    assert verdict(("b", YES), ("a", NO)) == "not supported" and verdict(("a", NO), modal=True) == "not seen"
    assert verdict(("a", OPEN), ("b", YES)) == "cannot tell"
    assert verdict(("a", YES), ("a", NO)) == "not supported" and verdict(("a", YES), ("a", OPEN)) == "cannot tell"
    assert verdict(("b", YES)) == verdict((Case("a", "gravity"), YES)) == verdict() == "not measured"


def test_a_row_spells_its_other_cases_out_and_has_a_sentence_for_its_verdict_alone():
    entry = judge(a_claim(("a", YES), ("b", YES), ("c", NO), ("d", OPEN), here="From {0} to {c|0}."), Data({}))
    assert entry.here == "From 1.5 (1.0 to 2.0) to 2.5 (2.1 to 3.0)."
    assert entry.cases == "For: b. Not for: c. Open for: d."
    for found, here, given, said in (
        (NO, "It holds, {0}.", {}, "Number: 2.5 (2.1 to 3.0)."),
        (YES, "{b|0}", {}, "Number: 1.5 (1.0 to 2.0)."),
        (NO, "It fails, {0}.", {"finds": "not supported"}, "It fails, 2.5 (2.1 to 3.0)."),
    ):
        assert judge(a_claim(("a", found), here=here, **given), Data({})).here == said
    refuses(ClaimsError, "theory: F1: 2 numbers for 1 bounds", judge, a_claim(("a", YES, NO)), Data({}))


def test_a_star_marks_verdicts_that_hang_on_a_threshold():
    """Of "about", a quarter: within an eighth, a quarter and a half of 20."""

    def star(force):
        claim = Claims("theory")
        claim("F1", "I", Ask("force", about(20.0)))(lambda data: iter([Quantity.exact(force)]))
        return judge(claim.rows[0], Data({})).star

    assert star(20.0) == star(22.0) == star(31.0) == [] and star(23.0) == star(29.0) == ["about"]


def test_no_quantity_is_made_of_nothing():
    refuses(NotMeasured, None, Quantity.over, [])
    for nothing in ([NAN], [np.inf], [NAN, 1.0]):
        refuses(NotMeasured, None, Quantity.exact if len(nothing) == 1 else Quantity.bracket, *nothing)
    assert Quantity.bracket(50.0, NAN).value is None


#: A strict bound leaves out its ends; sampled events lie at most a term below the paper's force.
STRICT, LOOSE = (Limits(1.0, math.inf, strict) for strict in (True, False))
SAMPLED = sampled(10.0).limits(bounds.THRESHOLDS)


@pytest.mark.parametrize(
    ("limits", "low", "high", "outcome"),
    [
        (LOOSE, 1.0, 2.0, "yes"), (STRICT, 1.0, 2.0, "cannot tell"), (STRICT, 1.1, math.inf, "yes"),
        (STRICT, 0.5, 1.0, "no"), (SAMPLED, 7.5, 10.0, "yes"), (SAMPLED, 7.4, 7.6, "cannot tell"),
        (SAMPLED, 9.9, 10.1, "cannot tell"), (SAMPLED, 7.0, 7.4, "no"), (SAMPLED, 10.1, 10.2, "no"),
        (SAMPLED, 20.0, NAN, "no"),
    ],
)  # fmt: skip
def test_a_bound_tells_what_lies_within_it(limits, low, high, outcome):
    assert limits.outcome(Quantity.bracket(low, high)) == outcome


def test_bounds_are_said_in_words():
    asked = (about(20.0), "mg"), (less_than(1.0), "%"), (more_than(4.0), "")
    said = [one.limits(bounds.THRESHOLDS).text(unit) for one, unit in asked]
    assert said == ["15.0 mg to 25.0 mg", "less than 100 %", "more than 4.00"]


def test_orders_use_the_smallest_step():
    up = [Quantity.bracket(1.0, 1.1), Quantity.bracket(2.0, 2.1), Quantity.bracket(3.0, NAN)]
    assert rise(up).low > 1.0 > rise(up[:2][::-1]).high
    steady = rise([*up[:2], Quantity.bracket(2.0, 2.2)])
    assert steady.low < 1.0 < steady.high


#: Numbers as readers see them: quantity, unit and text.
WRITTEN = [
    (Quantity.exact(1.0), "part", "all"),
    (Quantity.exact(0.0), "part", "none"),
    (Quantity.exact(0.999), "part", "100 %"),
    (Quantity.exact(0.0), "count", "no"),
    (Quantity.exact(6100.0), "count", "6,100"),
    (Quantity.exact(0.0), "%", "0 %"),
    (Quantity.exact(-0.0182), "%", "−1.8 %"),
    (Quantity.exact(3.475e-28), "", "3.5 × 10⁻²⁸"),
    (Quantity.exact(9.96), "mg", "10 mg"),
    (Quantity.bracket(20.2027, 20.2028), "mg", "20.2 mg"),
    (Quantity.bracket(91.4, 92.26), "mg", "91.8 mg"),
    (Quantity.bracket(1.245, 1.266), "", "1.25 to 1.27"),
    (Quantity.bracket(50.0, NAN), "mg", "above 50 mg"),
    (Quantity(12.66, 4.8, 22.0, "confidence"), "", "13 (4.8 to 22)"),
    (Quantity(0.99, 0.91, 1.0, "confidence"), "part", "99 % (91 % to all)"),
    (Quantity(2.0, 1.8, math.inf, "confidence"), "", "2.0 (above 1.8)"),
    (Quantity.bracket(0.0, 70.0), "mg", "0 to 70 mg"),  # not 35: it was looked for from 70 mg on alone
]


@pytest.mark.parametrize(("found", "unit", "written"), WRITTEN)
def test_numbers_are_written_in_one_way(found, unit, written):
    assert text(found, unit) == written


def test_no_sentence_says_more_than_three_digits_or_nonsense(entries):
    for entry in entries.values():
        said = entry.here
        assert not re.search(r"at (least|most) (all|none|no|100 %|0 )|by none|by all|nan|inf\b|[{}]", said), said
        numbers = re.findall(r"\d+\.\d+", said)
        assert all(len(number.replace(".", "").lstrip("0")) <= 4 for number in numbers), said
    assert digits(0.0, 2) == "0" and shown(0.0, "mg") == "0 mg"


def test_what_is_stored_is_said_by_the_sentence_that_is_written_for_it():
    """A number that a sentence names and its function does not yield would leave the bare numbers."""
    for one in collections():
        stored = json.loads((ROOT / one.folder / table.OUTPUT).read_text())["table"]
        for row in stored:
            claim = CLAIM[row["id"]]
            if claim.finds in ("any", row["verdict"]):
                assert row["here"].startswith(claim.here.partition("{")[0]), claim.id


def test_the_numbers_that_the_paper_prints(good, entries):
    found = printed.quantities(list(entries.values()), good)
    assert len(found) == len(printed.QUANTITIES) + 1
    crossover = next(one for one in found if one["what"] == "two peaks, friction 0.2")
    assert crossover["paper"] == 20.0 and crossover["ours"]["interval_of"] == "range over the protocol"
    low, high = crossover["ours"]["interval"]
    assert low <= crossover["ours"]["value"] <= high
    assert {"rows of 60", "121 disks a row"} <= {one["case"] for one in crossover["others"]}
    nothing = {claim.id: judge(claim, Data({})) for claim in EVERY}
    assert printed.quantities(list(nothing.values()), Data({})) == []


def test_a_path_that_ends_inside_its_linear_range_is_censored():
    """Whether such a packing has a shorter range than a lattice that leaves its own later is not known."""
    off = np.array([[0.0, 0.001, 0.002], [0.0, 0.02, 0.3], [0.0, 0.0, NAN]])
    ends = linear_ends(np.array([0.1, 1.0, 11.0]), off, 0.01)
    assert ends[0].tolist() == [11.0, np.inf] and ends[2].tolist() == [1.0, np.inf]
    assert 0.1 < ends[1, 0] == ends[1, 1] < 1.0
    lattice = np.array([41.0, 41.0])
    found = shorter(ends, lattice)  # one is shorter, two are not known: not one of three
    assert found.value == 1.0 and found.high == 1.0 and found.low == part_of([True, False, False]).low
    assert shorter(ends, np.array([0.5, 0.5])).value == part_of([True, False, False]).value  # all are known


def test_the_median_and_the_order_of_censored_ranges():
    ends = np.array([[1.0, 1.0], [2.0, 2.0], [3.0, np.inf], [3.0, np.inf], [3.0, np.inf]])
    median = linear_end(ends)
    assert median.low >= 1.0 and median.high == np.inf and median.value is None
    short, long = np.full((4, 2), 3.3), np.tile([11.0, np.inf], (4, 1))
    assert order_of([long, short]).high == -1.0  # the longer path shows the order
    censored = np.tile([3.3, np.inf], (4, 1))
    unknown = order_of([long, censored])
    assert (unknown.low, unknown.high) == (-1.0, 1.0)  # a path to 3.3 says nothing beside one to 11


def test_the_bootstrap_knows_the_error_of_a_mean():
    values = np.random.default_rng(1).standard_normal(400)
    found = over_realizations(values, np.mean)
    assert found.kind == "confidence" and found.value == pytest.approx(values.mean())
    assert 0.5 * (found.high - found.low) == pytest.approx(1.96 * values.std() / 20.0, rel=0.1)
    assert over_realizations([*values, NAN], np.mean) == found
    refuses(NotMeasured, "2 realizations", over_realizations, [1.0, NAN, 2.0])


def test_the_interval_of_a_part_is_exact_and_open_at_its_ends():
    none, few = part_of(np.zeros(20)), part_of(np.arange(20) < 5)
    assert none.low == 0.0 and none.high == pytest.approx(1.0 - 0.025 ** (1.0 / 20.0))
    assert (few.value, few.low, few.high) == pytest.approx((0.25, 0.0866, 0.4910), abs=1e-4)
    assert part_of(np.ones(20)).high == 1.0
    assert part_of(np.zeros(145)).high > RARE > part_of(np.zeros(146)).high  # from so many on it is rare
    refuses(NotMeasured, "no realizations", part_of, [])


#: How often a trend is seen, as docs/reproduction-notes.md says: of three crossover forces (D3b) and of four (D3a) that
#: are known to so much in their logarithm and grow by such a factor.
TREND_POWER = [
    (3, 0.1, [(1.0, 0.02), (1.25, 0.91), (1.5, 1.0), (2.0, 1.0)]),
    (3, 0.2, [(1.0, 0.02), (1.25, 0.34), (1.5, 0.80), (2.0, 1.0)]),
    (4, 0.1, [(1.0, 0.0), (1.25, 0.94), (1.5, 1.0), (2.0, 1.0)]),
    (4, 0.2, [(1.0, 0.0), (1.25, 0.31), (1.5, 0.93), (2.0, 1.0)]),
]
#: The same of three groups of so many packings (A5) whose means are so many standard deviations apart.
GROUPS = (40, 20, 20)
ORDER_POWER = [(0.0, 0.02), (0.3, 0.56), (0.5, 0.95), (0.7, 1.0)]


@pytest.mark.parametrize(
    ("cases", "scatter", "step", "power"), [(n, s, *one) for n, s, row in TREND_POWER for one in row]
)
def test_the_power_of_the_trend(cases, scatter, step, power):
    """Crossover forces that grow by ``step`` from case to case and are known to ``scatter``, 200 times."""
    rng = np.random.default_rng(0)

    def line():
        for centre in np.arange(cases) * np.log(step) + scatter * rng.standard_normal(cases):
            draws = np.exp(centre + scatter * rng.standard_normal(500))
            yield Crossover(Quantity.exact(np.exp(centre)), FOUND, np.stack([draws, draws]))

    assert np.mean([trend(list(line())).low > 0.0 for _ in range(200)]) == pytest.approx(power, abs=0.07)


@pytest.mark.parametrize(("step", "power"), ORDER_POWER)
def test_the_power_of_the_order_of_realizations(step, power):
    """Three groups, as in A5, apart by parts of their scatter: how often the order is clear."""
    rng = np.random.default_rng(0)

    def order():
        ends = [rng.standard_normal(number) - step * place for place, number in enumerate(GROUPS)]
        return order_of([np.stack([one, one], axis=-1) for one in ends], draws=200)

    assert np.mean([order().high < 0.0 for _ in range(100)]) == pytest.approx(power, abs=0.1)


#: The same of a part of so many packings that is to be above a half (D2), or not rare (U2), if it is in truth so large.
PART_POWER = [
    (20, 0.5, [(0.5, 0.02), (0.7, 0.42), (0.8, 0.80), (0.9, 0.99)]),
    (40, 0.5, [(0.5, 0.02), (0.7, 0.70), (0.8, 0.98), (0.9, 1.0)]),
    (150, 0.025, [(0.025, 0.01), (0.05, 0.34), (0.1, 0.97), (0.15, 1.0)]),
]


@pytest.mark.parametrize(("packings", "least", "powers"), PART_POWER)
def test_the_power_of_a_part(packings, least, powers):
    clear = [part_of(np.arange(packings) < hits).low > least for hits in range(packings + 1)]
    for part, power in powers:
        assert binom.pmf(np.arange(packings + 1), packings, part)[clear].sum() == pytest.approx(power, abs=0.005)


def test_the_notes_quote_the_power():
    notes = (ROOT / "docs" / "reproduction-notes.md").read_text(encoding="utf-8")
    rows = [
        f"| {cases} crossover forces, {scatter:g} | {' | '.join(f'{power:.0%}' for _, power in row)} |"
        for cases, scatter, row in TREND_POWER
    ]
    rows += [f"| {', '.join(map(str, GROUPS))} packings | {' | '.join(f'{power:.0%}' for _, power in ORDER_POWER)} |"]
    rows += [f"| {n} packings | {' | '.join(f'{power:.0%}' for _, power in row)} |" for n, _, row in PART_POWER]
    assert [row for row in rows if row.replace("%", " %") not in notes] == []


def test_an_order_counts_pairs():
    one, other = (np.stack([values] * 2, axis=1) for values in (np.array([1.0, 4.0, 2.0]), np.full(3, 9.0)))
    same = order_of([one] * 2)
    assert same.value == 0.0
    assert same.low < 0.0 < same.high
    assert order_of([one, other]) == Quantity(1.0, 1.0, 1.0, "confidence")


def test_a_size_in_whole_steps_is_known_in_the_mean():
    """However a size that grows evenly lies between its steps."""
    for start in np.linspace(0.0, 1.0, 7):
        for grown in (2.5, 4.0, 7.3):
            smooth = start + grown * (np.arange(200) + 0.5) / 200
            found = size_in_steps(np.floor(smooth), 1.0)
            assert found.low - 1e-9 <= smooth.mean() <= found.high + 1e-9


def test_what_is_not_ordered_widens_a_trend():
    one, later, bound = (
        Crossover(Quantity.bracket(low, high), FOUND, np.tile([[low], [high]], 50))
        for low, high in ((1.0, 1.0), (2.0, 2.0), (1.5, np.inf))
    )
    assert (trend([one, later]).low, trend([later, one]).high) == (1.0, -1.0)
    assert (trend([one, bound]).low, trend([later, bound]).low, trend([later, bound]).high) == (1.0, -1.0, 1.0)


def test_a_median_of_brackets_holds_what_is_not_known_of_each():
    middle = np.random.default_rng(1).uniform(1.0, 2.0, 40)
    sharp = over_brackets([Quantity.exact(value) for value in middle])
    same = over_realizations(middle)
    assert sharp.value == same.value and (sharp.low, sharp.high) == pytest.approx((same.low, same.high), abs=0.02)
    wide = over_brackets([Quantity.bracket(value - 0.1, value + 0.1) for value in middle])
    assert (wide.value, wide.low, wide.high) == pytest.approx((sharp.value, sharp.low - 0.1, sharp.high + 0.1))
    assert wide.kind == "confidence"
    # the larger half has no upper end, so neither has the interval; a few do not matter
    order = np.sort(middle)
    open_ends = [Quantity.bracket(value, NAN if value > order[20] else value) for value in order]
    assert not over_brackets(open_ends).happens and over_brackets(open_ends).low == pytest.approx(sharp.low)
    few = [Quantity.bracket(value, NAN if value > order[-3] else value) for value in order]
    assert over_brackets(few).happens
    refuses(NotMeasured, "2 realizations", over_brackets, few[:2])


def test_every_term_is_used_and_no_other():
    used = {ask.bound.word for claim in EVERY for ask in claim.asks}
    assert used - {""} == set(bounds.WORDS)


def test_labels_are_found_exactly_and_together():
    data = dataset({"stop": [1e-9, 1e-13], "kind": ("stop", ["a", "b"])}, value=("stop", [1.0, 2.0]))
    assert float(at(data, stop=1e-13, kind="b")["value"]) == 2.0
    for labels in ({"stop": 1e-11}, {"kind": "a", "stop": 1e-13}):
        refuses(NotMeasured, f"stop = {labels['stop']}", at, data, **labels)
    with pytest.raises(NotMeasured, match=r"pile_dip\.nc holds no dataset piles"):
        Data({"pile_dip": {"stress": data}}).get("pile_dip", "piles")


def test_the_stored_table_is_the_one_file_of_verdicts(tmp_path):
    store.write(tmp_path / "data" / "pile_dip.nc", pile_dip(), PILE)
    found = table.write(tmp_path / "claims.json", tmp_path / "data", tmp_path / "none.nc")
    stored = json.loads((tmp_path / "claims.json").read_text())
    assert stored == found == table.read(tmp_path / "claims.json")
    assert [row["id"] for row in stored["table"]] == [claim.id for claim in table.claims_in(PAPER)]
    assert stored["scheme"] == list(table.SCHEME)
    rows = {row["id"]: row for row in stored["table"]}
    assert {name for name in ("P1", "P3", "P4") if rows[name]["verdict"] == "supported"} == {"P1", "P3", "P4"}
    statements = [row for row in stored["table"] if row["row"] == "statement"]
    assert sum(sum(part.values()) for part in stored["counts"].values()) == len(statements)
    assert (rows["P1"]["value"], rows["P1"]["interval"], rows["P1"]["gravity"]["of"]) == (0.07, None, 0)
    assert rows["P1"]["here"].startswith("Without friction the stress dips by 7.0 % under the apex. With friction it")
    damaged = ({**stored, "counts": {}}, {**stored, "table": [{"id": "P1"}]}, {**stored, "table": 3})
    for partial in (*damaged, {"counts": {}, "table": []}):
        (tmp_path / "claims.json").write_text(json.dumps(partial))
        refuses(ClaimsError, "is not a whole table of claims", table.read, tmp_path / "claims.json")


def test_the_counts_in_words(good, entries):
    data = changed(good, "pile_dip", "stress", dip=np.zeros(3))
    found = table.document([judge(claim, data) if claim.group == "pile_dip" else entries[claim.id] for claim in EVERY])
    ordered, disorder, extension, rest = table.quoted(found).splitlines()
    number = sum(found["counts"]["ordered"].values())
    assert ordered == (
        f"{number - 2} of {number} statements on ordered slabs, piles, theory and method are supported, "
        "1 not supported, 1 not measured."
    )
    assert disorder.endswith("are supported.") and "beyond the paper" in extension
    checks = sum(claim.row == "check" for claim in EVERY)
    assert f"Not counted: statements that can hardly fail ({checks})." in rest


def test_the_summary_of_preparations_is_read_in_place_of_their_datasets(tmp_path, good):
    """It has the layout of the dataset ``events``, and says what it was made from."""
    events = good.groups["preparation"]
    store.write(tmp_path / "preparation.nc", events, {"group": "preparation", "parameters": "ways: []"})
    path = preparations.write(tmp_path / "preparation.nc", tmp_path / "extensions" / "summary.nc")
    made = store.read_attributes(path)
    assert made["source"] == "preparation.nc" and made["parameters"] == "ways: []" and len(made["source_md5"]) == 32
    read = table.collect(tmp_path / "none", path).groups["preparation"]["events"]
    assert read["low"].values.tolist() == events["events"]["low"].values.tolist()
    store.write(tmp_path / "other.nc", pile_dip(), {"group": "pile_dip"})
    with pytest.raises(NotMeasured, match="no events of the group preparation"):
        preparations.write(tmp_path / "other.nc", tmp_path / "summary.nc")


def test_the_readme_quotes_the_stored_table():
    """The counts in words, and the verdict of each of its findings."""
    found = table.read(ROOT / "figures" / "claims.json")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [line for line in table.quoted(found).splitlines() if line not in readme] == []
    measured = [row for row in found["table"] if row["tests"]]
    bare = [row["id"] for row in measured if ": " in row["here"][: len(row["tests"][0]["what"]) + 2]]
    assert bare == []  # each verdict has its sentence, with all of its numbers
    verdicts = {row["here"]: row["verdict"] for row in found["table"]}
    told = re.findall(r"^\d\. .*?\*\*Here:\*\* (.*?) \*([a-z ]+)\*", readme, re.MULTILINE)
    assert len(told) == 6 and all(verdicts[here] == verdict for here, verdict in told)


def test_an_event_that_no_other_protocol_was_tried_for_says_so(entries):
    """Its interval is the resolution of the search, which is no error."""
    own = {name: entry for name, entry in entries.items() if entry.claim.part != "extension"}
    alone = {name for name, entry in own.items() if any(test.found.kind == "bracket" for test in entry.primary)}
    assert alone and {name for name in alone if "of the search" not in CLAIM[name].remark} == set()
