"""Claims on disordered slabs (abstract, Secs. VI to VIII), from the ensembles of the survey and by its one definition
of two peaks (:mod:`granular_response_paper.survey.crossover`).

The text starts from a lattice with twice the mean radius as its constant, in which disks of unequal size overlap. This
project starts where the largest disks touch. Both, and lattices between them, are values of what the text leaves open
in every claim here; wider lattices are another preparation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import betaincinv

from granular_response.scene.lattice import SlabPacking, touching_largest
from granular_response.state import FloatArray
from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import LEVELS, RARE, of_draws, over_realizations, part_of
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words
from granular_response_paper.survey.crossover import ABOVE, BELOW, FOUND, counted

GROUP = "phase_diagram"
CLAIMS = Claims(__package__)

#: The initial lattice of this project, and the literal one.
USUAL, LITERAL = "touching-largest", "2.0"

#: Width of smoothing of Figs. 21 and 22, and of Figs. 19 and 20; realizations in each panel of Fig. 19.
WIDE, NARROW, SHOWN = 6.0, 3.0, 15

#: How far off a response is no longer linear: the text does not say.
TOLERANCES = (0.01, 0.02, 0.05)

#: How intervals over realizations are made.
BOOTSTRAP = "bootstrap of realizations"


def _case(study: xr.Dataset, polydispersity: float, friction: float, start: str = USUAL) -> xr.Dataset:
    """The case with these numbers. Raises NotMeasured if there is none."""
    here = np.isclose(study["polydispersity"].values, polydispersity) & np.isclose(study["friction"].values, friction)
    here &= study["lattice_constant"].values.astype(str) == start
    CLAIMS.needs(here.any(), f"no case of polydispersity {polydispersity:g}, friction {friction:g}, start {start}")
    return study.isel(case=int(np.flatnonzero(here)[0]))


def _disorders(study: xr.Dataset) -> list[float]:
    return sorted({delta for delta in study["polydispersity"].values.tolist() if delta > 0.0})


def _starts(study: xr.Dataset, polydispersity: float) -> list[str]:
    """The stored initial lattices: this project's, then by their constants."""
    stored = set(
        study["lattice_constant"].values[np.isclose(study["polydispersity"].values, polydispersity)].astype(str)
    )
    return [USUAL] * (USUAL in stored) + sorted(stored - {USUAL})


def _frictions(study: xr.Dataset, polydispersity: float, start: str) -> list[float]:
    here = np.isclose(study["polydispersity"].values, polydispersity)
    here &= study["lattice_constant"].values.astype(str) == start
    return sorted(set(study["friction"].values[here].tolist()))


def _every(study: xr.Dataset, friction: float | None = None) -> Iterator[tuple[float, str, float]]:
    """Polydispersity, start and friction of every case of disorder, or of those with one friction."""
    for delta in _disorders(study):
        for start in _starts(study, delta):
            for mu in _frictions(study, delta, start):
                if friction in (None, mu):
                    yield delta, start, mu


def _disorder(polydispersity: float) -> str:
    return f"polydispersity {polydispersity:g}"


def _title(start: str) -> str:
    return "largest disks touch at first" if start == USUAL else f"lattice constant {start}"


def _prepared(test: Test, start: str, polydispersity: float = 0.01) -> Test:
    """A test of a start: one value of what the text leaves open, or another preparation if the lattice is wider."""
    title = ", ".join(filter(None, (test.case, _title(start))))
    if start != USUAL and float(start) > touching_largest(polydispersity):
        return replace(test, prepared=title, case="")
    return test.named(title)


def _by_start(study: xr.Dataset, *frictions: float) -> Iterator[tuple[str, list[xr.Dataset]]]:
    """Starts of delta = 0.01 with their cases of these frictions."""
    for start in _starts(study, 0.01):
        if set(frictions) <= set(_frictions(study, 0.01, start)):
            yield start, [_case(study, 0.01, mu, start) for mu in frictions]


def _with_interval(case: xr.Dataset, name: str) -> Quantity:
    """A number of a case with 95 % of its bootstrap draws."""
    low, high = (float(at(case, level=level)[f"{name}_interval"]) for level in LEVELS)
    samples = int(case["realizations"]) if "realizations" in case.variables else 1
    return Quantity(float(case[name]), low, high, "confidence", BOOTSTRAP, samples)


@CLAIMS.measures("D1")
def two_peaks_or_one(data: Data, words: Words) -> list[Test]:
    """The paper shows one mean of each friction, so that what is asked is only that such ones are not rare."""
    tests = []
    for start, cases in _by_start(at(data.get(GROUP, "starts"), width=NARROW), 0.0, 0.2):
        deepest, flattest = (_tail(case, level) for case, level in zip(cases, LEVELS[::-1], strict=True))
        two, one = bounds.at_least(words, "marked"), bounds.at_most(words, "visible")
        tests.append(_prepared(Test("dip at friction 0, 97.5 % quantile", deepest, two, unit="%"), start))
        tests.append(_prepared(Test("dip at friction 0.2, 2.5 % quantile", flattest, one, unit="%"), start))
    return tests


def _tail(case: xr.Dataset, level: float) -> Quantity:
    """A quantile of the dip of means of ``SHOWN`` realizations, with 95 % of its bootstrap draws."""
    one = at(case, level=level)
    low, high = one["dip_of_means_interval"].values.tolist()
    method = f"quantile of means of {SHOWN}, bootstrap"
    return Quantity(float(one["dip_of_means"]), low, high, "confidence", method, int(case["realizations"]))


@dataclass(frozen=True)
class Crossover:
    """The crossover force of a case, and the interval in which it lies in each draw of the bootstrap: (d,) ends."""

    found: Quantity
    kind: int
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, case: xr.Dataset) -> Crossover:
        """As stored, with its interval; open to one side where it is a bound."""
        force, kind = float(case["force"]), int(case["kind"])
        low, high = (float(at(case, level=level)["interval"]) for level in LEVELS)
        CLAIMS.needs(not np.isnan([force, low, high]).any(), "crossovers holds a case without number")
        # at no force two peaks, or at all: what was looked at ends there
        low = 0.0 if kind == BELOW else min(max(low, 0.0), force)
        high = max(high, force) if kind == BELOW else high
        samples = int(case["realizations"]) if "realizations" in case.variables else 1
        draws = case["draws"].values.astype(float)
        smallest, largest = (float(end) for end in case["limits"].values)
        least = np.where(draws == -np.inf, 0.0, np.where(draws == np.inf, largest, draws))
        found = Quantity(force, low, high, "confidence", BOOTSTRAP, samples)
        return cls(found, kind, least, np.where(draws == -np.inf, smallest, draws))

    def comparable(self, other: Crossover) -> bool:
        """Whether their order can be seen: not of two bounds to the same side."""
        return self.kind == FOUND or self.kind != other.kind

    def per(self, other: Crossover) -> Quantity:
        """The ratio. Cases of as many realizations were drawn alike; what a bound leaves open widens the interval."""
        with np.errstate(divide="ignore", invalid="ignore"):
            low, high = self.low / other.high, self.high / other.low
        low, high = np.where(np.isnan(low), 0.0, low), np.where(np.isnan(high), np.inf, high)
        ratio = self.found.per(other.found)
        return of_draws(ratio.value, (low, high), BOOTSTRAP, ratio.samples, "inverted_cdf")


def _crossover(data: Data, words: Words, polydispersity: float, friction: float, start: str) -> Crossover:
    """By the mean of the realizations; by the median one where packings collapse, so that the mean hangs on a few.

    A dip counts from the threshold of "visible" on.
    """
    medians = _case(at(data.get(GROUP, "medians"), width=WIDE), polydispersity, friction, start)
    if int(medians["collapsed"]) > 0:
        return Crossover.of(medians)
    study = data.get(GROUP, "crossovers")
    if np.isclose(study.attrs.get("tolerance", words["visible"]), words["visible"]):
        study = at(study, width=WIDE)
    else:
        study = at(data.get(GROUP, "definitions"), width=WIDE, tolerance=words["visible"])
    return Crossover.of(_case(study, polydispersity, friction, start))


def trend(line: Sequence[Crossover]) -> Quantity:
    """Kendall's tau of the order of crossover forces, with 95 % of the draws: 1 if all pairs rise, -1 if all fall.

    Pairs whose order a draw leaves open, such as two bounds to the same side, widen the interval. Cases of as many
    realizations were drawn alike.
    """
    pairs = list(combinations(line, 2))
    up = np.mean([after.low > before.high for before, after in pairs], axis=0)
    down = np.mean([after.high < before.low for before, after in pairs], axis=0)
    samples = max(one.found.samples for one in line)
    ends = (2.0 * up - 1.0, 1.0 - 2.0 * down)
    return of_draws(float(np.median(up - down)), ends, "Kendall's tau of the draws", samples, "inverted_cdf")


def _order(name: str, line: Sequence[Crossover]) -> list[Test]:
    """That crossover forces rise along a line, and no step against it is clear of its interval.

    Those with two peaks at every force are below all others and of no order among themselves.
    """
    rest = [one for one in line if one.kind != BELOW]
    steps = [after.per(before) for before, after in pairwise(line) if after.comparable(before)]
    rising = Bound(0.0, word="visible", strict=True)
    back = Quantity.exact(sum(step.high < 1.0 for step in steps))
    return [
        Test("trend (Kendall's tau)", trend(rest if len(rest) > 1 else line), rising, name),
        Test("steps against it, clear of their intervals", back, replace(bounds.NONE, word="visible"), name),
    ]


@CLAIMS.measures("D3a")
def rises_with_friction(data: Data, words: Words) -> list[Test]:
    study, tests = data.get(GROUP, "crossovers"), []
    for delta, start in dict.fromkeys((delta, start) for delta, start, _ in _every(study)):
        frictions = _frictions(study, delta, start)
        if len(frictions) > 1:
            line = [_crossover(data, words, delta, mu, start) for mu in frictions]
            tests += [_prepared(test, start, delta) for test in _order(_disorder(delta), line)]
    return tests


@CLAIMS.measures("D3b")
def falls_with_disorder(data: Data, words: Words) -> list[Test]:
    study, tests = data.get(GROUP, "crossovers"), []
    deltas = _disorders(study)
    for start in (USUAL, LITERAL):
        for mu in sorted(set.intersection(*(set(_frictions(study, delta, start)) for delta in deltas))):
            line = [_crossover(data, words, delta, mu, start) for delta in reversed(deltas)]
            if any(after.comparable(before) for before, after in pairwise(line)) or start == LITERAL:
                tests += [test.named(f"{test.case}, {_title(start)}") for test in _order(f"friction {mu:g}", line)]
    return tests


@CLAIMS.measures("D4")
def gradual(data: Data, words: Words) -> list[Test]:
    studies = [at(data.get(GROUP, name), width=WIDE) for name in ("shapes", "realizations", "crossovers")]
    tests, most = [], bounds.at_most(words, "gradual")
    for delta, start, mu in _every(studies[0], 1.0):
        case, single, crossover = (_case(study, delta, mu, start) for study in studies)
        if int(crossover["kind"]) == FOUND:
            dips, leans = (single[name].transpose("realization", "step").values for name in ("shape", "asymmetry"))
            steps = np.fmax.reduce(np.fmax(np.abs(np.diff(dips)), np.abs(np.diff(leans))), axis=1)
            found = {"mean": _with_interval(case, "largest_step"), "median realization": over_realizations(steps)}
            for name, step in found.items():
                what = f"largest change between neighbouring forces, {name}"
                tests.append(_prepared(Test(what, step, most, _disorder(delta)), start, delta))
    return tests


@CLAIMS.measures("D5")
def five_enough(data: Data, words: Words) -> list[Test]:
    """A statement on samples of five: it must hold in most of them, wherever the mean of all has a crossover.

    Where it has none up to the largest force, samples may have one beyond it.
    """
    study, tests = at(data.get(GROUP, "crossovers"), width=WIDE), []
    for delta, start, mu in _every(study):
        case = _case(study, delta, mu, start)
        seen = replace(_with_interval(case, "seen"), method="samples of five, bootstrap")
        seen = replace(seen, high=1.0) if int(case["kind"]) == ABOVE else seen
        if int(case["kind"]) != BELOW:
            what = f"samples of five with a crossover, friction {mu:g}"
            tests.append(_prepared(Test(what, seen, Bound(0.5), _disorder(delta), "%"), start, delta))
    return tests


@CLAIMS.measures("D6")
def below_lattice(data: Data, words: Words) -> list[Test]:
    tests, below = [], Bound(most=1.0, word="visible", strict=True)
    for delta, start, mu in _every(data.get(GROUP, "crossovers")):
        found, lattice = (_crossover(data, words, d, mu, s) for d, s in ((delta, start), (0.0, USUAL)))
        if found.comparable(lattice):
            what = f"crossover per lattice's, friction {mu:g}"
            tests.append(_prepared(Test(what, found.per(lattice), below, _disorder(delta)), start, delta))
    return tests


@CLAIMS.measures("D8")
def preparation(data: Data, words: Words) -> list[Test]:
    tests, what = [], "crossover from lattice constant 2 per that from touching disks"
    for mu in (0.0, 0.2):
        usual, literal = (_crossover(data, words, 0.01, mu, start) for start in (USUAL, LITERAL))
        larger = Bound(1.0, word="visible", strict=True)
        tests.append(Test(what, literal.per(usual), larger, f"friction {mu:g}"))
    return tests


@CLAIMS.measures("D13")
def like_the_lattice(data: Data, words: Words) -> list[Test]:
    """One peak under the smallest force, two under larger ones, at the frictions at which the lattice has both."""
    study, tests = data.get(GROUP, "crossovers"), []
    ordered = [mu for mu in _frictions(study, 0.0, USUAL) if _crossover(data, words, 0.0, mu, USUAL).kind == FOUND]
    for delta, start, mu in _every(study):
        if mu in ordered:
            found = _crossover(data, words, delta, mu, start).found
            smallest, largest = _case(study, delta, mu, start)["limits"].values[-1].tolist()
            for bound in (Bound(smallest, strict=True), Bound(most=largest)):
                test = Test(
                    f"crossover force, friction {mu:g}", found, bound, f"{_disorder(delta)}, friction {mu:g}", "mg"
                )
                tests.append(_prepared(test, start, delta))
    return tests


@CLAIMS.measures("D18")
def without_contacts(data: Data, words: Words) -> list[Test]:
    study, tests = at(data.get(GROUP, "shapes"), width=NARROW), []
    for delta, start, mu in _every(study, 0.0):
        dip, least = (
            _with_interval(_case(study, delta, mu, start).isel(step=0), "shape"),
            bounds.at_least(words, "visible"),
        )
        tests.append(_prepared(Test("dip under the smallest force", dip, least, _disorder(delta), "%"), start, delta))
    return tests


#: What is counted as contacts of a disk.
COUNTED = {"contacts of disks": "", "walls counted": "_with_walls", "away from the boundaries": "_bulk"}


def _coordination(data: Data, bound: Bound, scale: float = 1.0) -> list[Test]:
    tests = []
    for start, (case,) in _by_start(data.get(GROUP, "packings"), 0.0):
        for name, kind in COUNTED.items():
            mean = over_realizations(case[f"coordination_number{kind}"].values / scale, np.mean)
            tests.append(_prepared(Test("contacts per disk", mean, bound, name), start))
    return tests


@CLAIMS.measures("D7a")
def coordination(data: Data, words: Words) -> list[Test]:
    # the paper holds 4.25 against the isostatic 4: what is "about" is the excess
    low, high = (4.0 + (1.0 + sign * words["about"]) * 0.25 for sign in (-1.0, 1.0))
    return _coordination(data, Bound(low, high, "about"))


@CLAIMS.measures("D14")
def below_six(data: Data, words: Words) -> list[Test]:
    return _coordination(data, bounds.lower(words, "marked"), 6.0)


@CLAIMS.measures("D7b")
def missing_horizontal(data: Data, words: Words) -> list[Test]:
    """Of the contacts of the ideal lattice, in which every disk touches its neighbours."""
    packing = SlabPacking().build()
    i, j = packing.neighbour_pairs().T  # type: ignore[union-attr]
    level = packing.row[i] == packing.row[j]
    ideal = {"horizontal": level.sum() / packing.n, "oblique": (~level).sum() / packing.n}
    tests = []
    for start, (case,) in _by_start(data.get(GROUP, "packings"), 0.0):
        missing = {name: number - case[f"{name}_contacts"].values for name, number in ideal.items()}
        part = over_realizations(missing["horizontal"] / sum(missing.values()), np.mean)
        test = Test("horizontal part of the missing contacts", part, bounds.at_least(words, "marked"), unit="%")
        tests.append(_prepared(test, start))
    return tests


def _away(data: Data, words: Words) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(case, step) which forces are known to be far below the crossover at w = 6, and far above.

    A force inside the interval of its crossover is not known to be away from it; a bound has forces on one side alone.
    """
    force = data.get(GROUP, "shapes")["applied_force"].transpose("case", "step").values
    crossovers = at(data.get(GROUP, "crossovers"), width=WIDE)
    low, high = (at(crossovers, level=level)["interval"].values[:, None] for level in LEVELS)
    near, crossover = 1.0 + words["similar"], crossovers["force"].values[:, None]
    kind = crossovers["kind"].values[:, None]
    below = (force < np.minimum(low, crossover / near)) & (kind != BELOW)
    above = (force > np.maximum(high, crossover * near)) & (kind != ABOVE)
    return below, above


@CLAIMS.measures("D9")
def resembles(data: Data, words: Words) -> list[Test]:
    """At forces that are known to be away from the crossover of their case."""
    study = at(data.get(GROUP, "realizations"), width=WIDE)
    off = study["difference"].transpose("case", "realization", "step").values
    constant, tests = study["lattice_constant"].values.astype(str), []
    for start in (USUAL, LITERAL):
        here = (study["polydispersity"].values > 0.0) & (constant == start)
        known = np.isfinite(off).any(axis=1) & here[:, None]
        for side, away in zip(("below", "above"), _away(data, words), strict=True):
            typical = [np.nanmedian(off[case, :, step]) for case, step in np.argwhere(away & known)]
            if len(typical) > 2:
                found = replace(over_realizations(typical), method="bootstrap of the median over cases and forces")
                case = f"{side} the crossover, {_title(start)}"
                what = "difference of a typical realization from the mean"
                tests.append(Test(what, found, bounds.at_most(words, "similar"), case, "%"))
    return tests


def _at_15(data: Data, name: str) -> Iterator[tuple[str, list[xr.Dataset]]]:
    """By start: delta = 0.01 under 15 mg at friction 0 and at 0.2, w = 3."""
    study = at(data.get(GROUP, name), width=NARROW).assign(applied=data.get(GROUP, "shapes")["applied_force"])
    for start, cases in _by_start(study, 0.0, 0.2):
        yield start, [one.isel(step=int(np.flatnonzero(np.isclose(one["applied"].values, 15.0))[0])) for one in cases]


@CLAIMS.measures("D10")
def fluctuations(data: Data, words: Words) -> list[Test]:
    tests = []
    for start, cases in _at_15(data, "shapes"):
        without, full = (_with_interval(case, "spread") for case in cases)
        tests.append(
            _prepared(Test("spread without friction per with 0.2", without.per(full), Bound(1.0, strict=True)), start)
        )
    return tests


def evident_samples(without: FloatArray, full: FloatArray, least: float) -> Quantity:
    """The part of samples of ``SHOWN`` realizations each in which at least this part of the pairs differ.

    ``without`` and ``full`` (r,) are the dips of realizations. With 95 % of the draws of these.
    """
    rng = np.random.default_rng(0)

    def part(ours: FloatArray, theirs: FloatArray, samples: int = 200) -> float:
        first, second = (rng.choice(of, (samples, SHOWN)) for of in (ours, theirs))
        return float(((first[:, :, None] > second[:, None]).mean(axis=(1, 2)) >= least).mean())

    drawn = [part(rng.choice(without, without.size), rng.choice(full, full.size)) for _ in range(200)]
    method, number = f"samples of {SHOWN}, bootstrap", min(without.size, full.size)
    return of_draws(part(without, full, 20000), drawn, method, number)


@CLAIMS.measures("D11")
def evident(data: Data, words: Words) -> list[Test]:
    tests, least = [], 1.0 - words["holds"]
    for start, cases in _at_15(data, "realizations"):
        without, full = (case["shape"].values[np.isfinite(case["shape"].values)] for case in cases)
        what = f"samples in which {least:.0%} of the pairs of realizations differ"
        tests.append(
            _prepared(Test(what, evident_samples(without, full, least), Bound(RARE, word="holds"), unit="%"), start)
        )
    return tests


def _collapses(
    data: Data, wanted: Bound, polydispersity: float | None = None, friction: float | None = None
) -> list[Test]:
    """The part of the packings that collapse along their load paths, of all cases or of one disorder and friction."""
    study, tests = data.get(GROUP, "realizations"), []
    for delta, start, mu in _every(study, friction):
        if polydispersity in (None, delta):
            one = _case(study, delta, mu, start)
            part = part_of(np.isfinite(one["collapse_force"].values[: int(one["realizations"])]))
            case = f"{_disorder(delta)}, friction {mu:g}"
            tests.append(_prepared(Test("packings that collapse", part, wanted, case, "%"), start, delta))
    return tests


@CLAIMS.measures("D12")
def unstable(data: Data, words: Words) -> list[Test]:
    """Two of five packings were unstable: not rare if so many or more are in one of forty samples of five."""
    return _collapses(data, Bound(float(betaincinv(2, 4, RARE))), 0.1, 0.2)


@CLAIMS.measures("D16")
def rearrangements(data: Data, words: Words) -> list[Test]:
    return _collapses(data, Bound(RARE))


#: Names of what is off in the linear range.
CENTRE, PROFILE = "response_at_centre", "profile_change"


def linear_ends(path: xr.Dataset, tolerance: float, measure: str = CENTRE) -> FloatArray:
    """(r, 2) the forces between which realizations leave their linear range.

    Both ends are the same where the change passes the tolerance between two forces: it is taken as linear in the
    logarithm of the force. A path that ends inside its linear range is censored: the ends are its last force and inf.
    ``path`` is a case of ``linear_range``; the ``measure`` is the response at x = 0, or the change of the profile from
    that to the smallest force. Realizations without two forces are left out.
    """
    force, value = path["applied_force"].values, path[measure].transpose("realization", "step").values
    found = []
    for change in value if measure == PROFILE else np.abs(value / value[:, :1] - 1.0):
        known = np.isfinite(change)
        if known.sum() < 2:
            continue
        off = np.flatnonzero(change[known] > tolerance)
        if off.size:
            (low, high), (before, after) = (values[known][off[0] - 1 : off[0] + 1] for values in (force, change))
            end = low * (high / low) ** ((tolerance - before) / (after - before))
            found.append((end, end))
        else:
            found.append((force[known][-1], np.inf))
    return np.array(found).reshape(-1, 2)


def shorter(ends: FloatArray, lattice: FloatArray) -> Quantity:
    """The part of realizations (r, 2) with a shorter linear range than a lattice (2,); censored ones may be shorter."""
    return part_of(ends[:, 1] < lattice[0], (ends[:, 1] >= lattice[0]) & (ends[:, 0] < lattice[1]))


def linear_end(ends: FloatArray) -> Quantity:
    """The median force at which realizations (r, 2) leave their linear range, between those of lower and upper ends.

    Raises NotMeasured for two realizations or none; a lattice has one, without scatter.
    """
    CLAIMS.needs(len(ends) not in (0, 2), "linear_range holds too few realizations")
    picked = np.random.default_rng(0).integers(0, len(ends), (2000, len(ends)))
    low, high = (np.quantile(ends[picked, k], 0.5, axis=1, method="inverted_cdf") for k in (0, 1))
    value = float(np.quantile(ends[:, 1], 0.5, method="inverted_cdf"))
    value = value if np.isfinite(value) else float("nan")
    return of_draws(value, (low, high), "bootstrap of the median", len(ends), "inverted_cdf")


def order_of(groups: Sequence[FloatArray], draws: int = 1000) -> Quantity:
    """Kendall's tau between the place of a group and the ends (r, 2) of its realizations, with 95 % of the draws.

    Over all pairs of realizations of different groups: 1 if every later one is larger, -1 if every one is smaller, 0 if
    the groups do not differ. It is the statistic of Jonckheere's test. Pairs whose order censoring leaves open count as
    -1 for the lower end of the interval, and as 1 for the upper one.
    """
    rng = np.random.default_rng(0)
    counts = [counted(rng.integers(0, len(one), (draws, len(one))), len(one)) for one in groups]
    number, value, low, high = 0, 0.0, np.zeros(draws), np.zeros(draws)
    for (first, before), (second, after) in combinations(enumerate(groups), 2):
        up = after[:, None, 0] > before[None, :, 1]
        down = after[:, None, 1] < before[None, :, 0]
        exact = np.isfinite(after[:, None, 1]) & np.isfinite(before[None, :, 1])
        least = np.where(up, 1.0, np.where(exact & ~down, 0.0, -1.0))
        most = np.where(down, -1.0, np.where(exact & ~up, 0.0, 1.0))
        number, value = number + up.size, value + float(up.sum() - down.sum())
        low += np.einsum("da,ab,db->d", counts[second], least, counts[first])
        high += np.einsum("da,ab,db->d", counts[second], most, counts[first])
    samples = sum(map(len, groups))
    return of_draws(value / number, (low / number, high / number), "Jonckheere's statistic, bootstrap", samples)


@CLAIMS.measures("D2")
def shorter_range(data: Data, words: Words) -> list[Test]:
    study, tests = data.get(GROUP, "linear_range"), []
    for start in _starts(study, 0.01):
        for mu in _frictions(study, 0.01, start):
            for tolerance in TOLERANCES:
                ends, lattice = (linear_ends(_case(study, *case), tolerance) for case in ((0.01, mu, start), (0.0, mu)))
                what = f"realizations with a shorter range, {tolerance:.0%} off"
                test = Test(what, shorter(ends, lattice[0]), Bound(0.5, strict=True), f"friction {mu:g}", "%")
                tests.append(_prepared(test, start))
    return tests


@CLAIMS.measures("A5")
def shorter_with_disorder(data: Data, words: Words) -> list[Test]:
    """The response as a whole, since that at x = 0 is near zero without friction."""
    study, tests = data.get(GROUP, "linear_range"), []
    for start in (USUAL, LITERAL):
        deltas = [delta for delta in _disorders(study) if start in _starts(study, delta)]
        for mu in _frictions(study, deltas[-1], start) if deltas else ():
            for tolerance in TOLERANCES:
                cases = [_case(study, 0.0, mu), *(_case(study, delta, mu, start) for delta in deltas)]
                ends = [linear_ends(case, tolerance, PROFILE) for case in cases]
                lattice, least = (linear_end(one) for one in ends[:2])
                case = f"friction {mu:g}, {tolerance:.0%} off, {_title(start)}"
                longer = Bound(1.0, strict=True)
                tests.append(Test(f"lattice per disorder of {deltas[0]:g}", lattice.per(least), longer, case))
                if len(deltas) > 1:
                    falls = Bound(most=0.0, strict=True)
                    tests.append(Test("order of the realizations (Kendall's tau)", order_of(ends[1:]), falls, case))
    return tests
