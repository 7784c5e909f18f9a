"""Claims D1 to D11, A5: disordered slabs (Secs. VI and VII), from the ensembles of the survey and by its one
definition of two peaks (:mod:`granular_response_paper.survey.crossover`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, pairwise, product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.scene.lattice import touching_largest
from granular_response.state import FloatArray

from ...claims import asked
from ...claims.bootstrap import LEVELS, OUTSIDE, of_draws, over_realizations, part_of
from ...claims.claim import Claims, Condition, Data, Finding, Quantity, Reading, at
from ...claims.words import Bounds
from ...survey.crossover import ABOVE, BELOW, FOUND, counted

GROUP = "phase_diagram"
CLAIMS = Claims(GROUP)

#: The initial lattice that this project uses, first, and the literal one.
STARTS = ("touching-largest", "2.0")

#: The width of smoothing of Fig. 21, and another one with what it changes.
WIDTHS = {6.0: "", 3.0: "smoothing"}

#: Realizations in Fig. 21, and in each panel of Fig. 19.
FEW, SHOWN = 5, 15

#: A part of samples below this is rare: they lie outside of the central 95 %.
RARE = 0.5 * OUTSIDE

#: How far off a response is no longer linear: the paper does not say.
TOLERANCES = (0.01, 0.02, 0.05)

#: Ends the title of an initial lattice wider than any that the text allows.
WIDER = "wider than with touching disks"

#: How intervals over realizations are made.
BOOTSTRAP = "bootstrap of realizations"


def _is(study: xr.Dataset, polydispersity: float, start: str) -> NDArray[np.bool_]:
    """(case,) which cases have this disorder and this start."""
    same = study["lattice_constant"].values.astype(str) == start
    return np.asarray(np.isclose(study["polydispersity"].values, polydispersity) & same)


def _case(study: xr.Dataset, polydispersity: float, friction: float, start: str = STARTS[0]) -> xr.Dataset:
    """The case with these numbers. Raises NotMeasured if there is none."""
    here = np.flatnonzero(_is(study, polydispersity, start) & np.isclose(study["friction"].values, friction))
    case = f"polydispersity {polydispersity:g}, friction {friction:g}, start {start}"
    CLAIMS.needs(here.size, f"no case with {case}")
    return study.isel(case=here[0])


def _starts(study: xr.Dataset) -> list[str]:
    """The initial lattices stored for delta = 0.01: this project's, the literal one, then by their constants."""
    stored = set(study["lattice_constant"].values[np.isclose(study["polydispersity"].values, 0.01)].astype(str))
    return [start for start in STARTS if start in stored] + sorted(stored - set(STARTS))


def _by_start(study: xr.Dataset, *frictions: float) -> dict[str, list[xr.Dataset]]:
    """Cases of delta = 0.01 with these frictions, by their start in words."""
    return {title(start): [_case(study, 0.01, mu, start) for mu in frictions] for start in _starts(study)}


def _disorders(study: xr.Dataset) -> list[float]:
    """All polydispersities above 0 of the usual start."""
    deltas = study["polydispersity"].values
    return sorted({delta for delta in deltas.tolist() if delta > 0.0 and _is(study, delta, STARTS[0]).any()})


def title(start: str, polydispersity: float = 0.01) -> str:
    """An initial lattice in words."""
    if start == STARTS[0]:
        return "start with the largest disks touching"
    wider = float(start) > touching_largest(polydispersity)
    return f"start with lattice constant {start}{', ' + WIDER if wider else ''}"


def changed(name: str) -> str:
    """What a reading of this name changes of the set-up."""
    return "lattice" if name.endswith(WIDER) else ""


def _packings_of(case: xr.Dataset) -> int:
    return int(case["realizations"]) if "realizations" in case.variables else 1


def _with_interval(case: xr.Dataset, name: str) -> Quantity:
    """A number of a case with 95 % of its bootstrap draws."""
    low, high = (float(at(case, level=level)[f"{name}_interval"]) for level in LEVELS)
    return Quantity(float(case[name]), low, high, "confidence", BOOTSTRAP, _packings_of(case))


def _at_15(data: Data, name: str) -> dict[str, list[xr.Dataset]]:
    """By start: delta = 0.01 under 15 mg at friction 0 and at 0.2, w = 3."""
    study = at(data.get(GROUP, name), width=3.0).assign(applied=data.get(GROUP, "shapes")["applied_force"])
    return {
        start: [case.isel(step=int(np.flatnonzero(np.isclose(case["applied"].values, 15.0))[0])) for case in cases]
        for start, cases in _by_start(study, 0.0, 0.2).items()
    }


@CLAIMS.measures("D1")
def two_peaks_or_one(data: Data, words: Bounds) -> Finding:
    """The paper shows one mean of each friction: what is asked is only that such ones are not rare.

    Very distinct peaks have a marked dip between them, one peak has no visible one.
    """
    rows, dips = [], []
    for name, cases in _by_start(at(data.get(GROUP, "starts"), width=3.0), 0.0, 0.2).items():
        deepest, flattest = (_tail(case, level) for case, level in zip(cases, (1.0 - RARE, RARE), strict=True))
        reading = Reading(
            name,
            asked.at_least(f"dip of a mean of {SHOWN} at friction 0, 97.5 % quantile", deepest, words, "marked", "%"),
            asked.at_most(f"dip of a mean of {SHOWN} at friction 0.2, 2.5 % quantile", flattest, words, "visible", "%"),
            change=changed(name),
        )
        rows.append((f"up to {deepest.text('%')} and from {flattest.text('%')}", reading))
        found = [_with_interval(case, "dip").text("%") for case in cases]
        dips.append(f"{found[0]} at friction 0, {found[1]} at 0.2 ({name})")
    return asked.told(
        f"all but {RARE:.1%} of the means of {SHOWN} dip at x = 0, per largest value, at friction 0 and 0.2: ",
        rows,
        "The paper has one mean of each, so what is asked is only that such ones are not rare. How far the mean of all "
        "packings dips: " + "; ".join(dips),
    )


def _tail(case: xr.Dataset, level: float) -> Quantity:
    """A quantile of the dip of means of ``SHOWN`` realizations, with 95 % of its bootstrap draws."""
    one = at(case, level=level)
    low, high = one["dip_of_means_interval"].values.tolist()
    test = f"quantile of means of {SHOWN}, bootstrap"
    return Quantity(float(one["dip_of_means"]), low, high, "confidence", test, _packings_of(case))


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
        found = Quantity(force, low, high, "confidence", BOOTSTRAP, _packings_of(case))
        draws = case["draws"].values.astype(float)
        smallest, largest = (float(end) for end in case["limits"].values)
        least = np.where(draws == -np.inf, 0.0, np.where(draws == np.inf, largest, draws))
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


def _defined(data: Data, width: float, words: Bounds) -> xr.Dataset:
    """The crossovers if a dip counts from the bound of "visible" on."""
    usual = data.get(GROUP, "crossovers")
    if np.isclose(usual.attrs.get("tolerance", words["visible"]), words["visible"]):
        return at(usual, width=width)
    return at(data.get(GROUP, "definitions"), width=width, tolerance=words["visible"])


def _by_case(study: xr.Dataset) -> dict[tuple[float, float], Crossover]:
    """Crossovers of the usual start, by polydispersity and friction."""
    keys = dict.fromkeys(zip(study["polydispersity"].values.tolist(), study["friction"].values.tolist(), strict=True))
    return {key: Crossover.of(_case(study, *key)) for key in keys}


def _crossovers(data: Data, width: float, words: Bounds) -> dict[str, dict[tuple[float, float], Crossover]]:
    """Those of the usual start, by statistic, which where packings collapse is a matter of interpretation; each by
    polydispersity and friction."""
    study = at(data.get(GROUP, "medians"), width=width)
    return {"mean of the realizations": _by_case(_defined(data, width, words)), "median realization": _by_case(study)}


def _lines(found: dict[tuple[float, float], Crossover], what: str) -> list[tuple[str, list[Crossover]]]:
    """Crossovers of disorder along friction or polydispersity, by the value of the other; bounds alone are left out."""
    along, across = (1, 0) if what == "friction" else (0, 1)
    lines = []
    for other in sorted({key[across] for key in found if key[0] > 0.0}):
        keys = sorted((key for key in found if key[0] > 0.0 and key[across] == other), key=lambda k: k[along])
        line = [found[key] for key in keys]
        if any(after.comparable(before) for before, after in pairwise(line)):
            lines.append((f"{'polydispersity' if along else 'friction'} {other:g}", line))
    return lines


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


def _trend(line: Sequence[Crossover]) -> Quantity:
    """The trend among those that do not have two peaks at every force, which are below all others."""
    rest = [one for one in line if one.kind != BELOW]
    return trend(rest if len(rest) > 1 else line)


def _orders(data: Data, words: Bounds, what: str, rising: str) -> Finding:
    """The trend of the crossover force along one axis, and steps against it, for every value of the other; of both
    statistics at both widths."""
    rows, turned = [], slice(None, None, -1 if rising == "falls" else 1)
    for width, change in WIDTHS.items():
        for statistic, found in _crossovers(data, width, words).items():
            conditions, trends = [], []
            for name, line in _lines(found, what):
                steps = [after.per(before) for before, after in pairwise(line[turned]) if after.comparable(before)]
                trends.append(_trend(line[turned]))
                back = Quantity.exact(sum(step.high < 1.0 for step in steps))
                conditions += [
                    Condition(f"{name}, trend (Kendall's tau)", trends[-1], least=0.0, strict=True, words=("visible",)),
                    Condition(
                        f"{name}, steps against it, clear of their intervals", back, most=0.0, words=("visible",)
                    ),
                ]
            reading = Reading(f"{statistic}, w = {width:g}", *conditions, change=change)
            rows.append((f"trend {', '.join(q.text() for q in trends)}", reading))
    return asked.told(f"crossover force {rising} with {what}: ", rows, between=", ")


CLAIMS.measures("D3a")(partial(_orders, what="friction", rising="rises"))
CLAIMS.measures("D3b")(partial(_orders, what="polydispersity", rising="falls"))


def _away(data: Data, words: Bounds) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(case, step) which forces are known to be far below the crossover at w = 6, and far above.

    A force inside the interval of its crossover is not known to be away from it; a bound has forces on one side alone.
    """
    force = data.get(GROUP, "shapes")["applied_force"].transpose("case", "step").values
    crossovers = at(data.get(GROUP, "crossovers"), width=6.0)
    low, high = (at(crossovers, level=level)["interval"].values[:, None] for level in LEVELS)
    near, at_crossover = 1.0 + words["similar"], crossovers["force"].values[:, None]
    kind = crossovers["kind"].values[:, None]
    below = (force < np.minimum(low, at_crossover / near)) & (kind == FOUND)
    above = (force > np.maximum(high, at_crossover * near)) & (kind != ABOVE)
    return below, above


@CLAIMS.measures("D5")
def five_enough(data: Data, words: Bounds) -> Finding:
    """A statement on samples of five: it must hold in most of them, wherever the mean of all has a crossover."""
    study, rows = at(data.get(GROUP, "crossovers"), width=6.0), []
    for start, delta in product(STARTS, _disorders(study)):
        here = _is(study, delta, start) & (study["kind"].values == FOUND)
        cases = sorted((study.isel(case=k) for k in np.flatnonzero(here)), key=lambda case: float(case["friction"]))
        seen = [replace(_with_interval(case, "seen"), test=f"samples of {FEW}, bootstrap") for case in cases]
        conditions = [
            Condition(f"samples of five with a crossover, friction {float(case['friction']):g}", one, 0.5, unit="%")
            for case, one in zip(cases, seen, strict=True)
        ]
        if conditions:
            name = f"polydispersity {delta:g}, {title(start, delta)}"
            rows.append((", ".join(one.text("%") for one in seen), Reading(name, *conditions)))
    return asked.told("part of the samples of five whose mean goes from one peak to two, by growing friction: ", rows)


@CLAIMS.measures("D6")
def below_lattice(data: Data, words: Bounds) -> Finding:
    rows = []
    for width, change in WIDTHS.items():
        for statistic, found in _crossovers(data, width, words).items():
            conditions = []
            for key in sorted(found):
                lattice = found.get((0.0, key[1]))
                if key[0] > 0.0 and lattice is not None and found[key].comparable(lattice):
                    name = f"per lattice at polydispersity {key[0]:g}, friction {key[1]:g}"
                    conditions.append(Condition(name, found[key].per(lattice), most=1.0, words=("visible",)))
            clear = sum(condition.found.high <= 1.0 for condition in conditions)
            reading = Reading(f"{statistic}, w = {width:g}", *conditions, change=change)
            rows.append((f"{clear} of {len(conditions)} clear", reading))
    return asked.told("crossover force below that of the lattice: ", rows, between=", ")


@CLAIMS.measures("D8")
def preparation(data: Data, words: Bounds) -> Finding:
    what, rows = "crossover from lattice constant 2 per that from touching disks", []
    for width, change in WIDTHS.items():
        study = _defined(data, width, words)
        for mu in (0.0, 0.2):
            usual, literal = (Crossover.of(_case(study, 0.01, mu, start)) for start in STARTS)
            condition = Condition(what, literal.per(usual), 1.0, words=("visible",), strict=True)
            reading = Reading(f"friction {mu:g}, w = {width:g}", condition, change=change)
            rows.append((f"{usual.found.text('mg')} and {literal.found.text('mg')}", reading))
    return asked.told("delta = 0.01, crossover from the start with touching disks and from lattice constant 2: ", rows)


@CLAIMS.measures("D4")
def gradual(data: Data, words: Bounds) -> Finding:
    studies = [at(data.get(GROUP, name), width=6.0) for name in ("shapes", "realizations", "crossovers")]
    singles, means, texts = [], [], []
    for delta in _disorders(studies[0]):
        case, single, crossover = (_case(study, delta, 1.0) for study in studies)
        name = f"polydispersity {delta:g}"
        if int(crossover["kind"]) != FOUND:
            texts.append(f"no crossover seen ({name})")
            continue
        step = _with_interval(case, "largest_step")
        dips, leans = (single[name].transpose("realization", "step").values for name in ("shape", "asymmetry"))
        steps = over_realizations(np.fmax.reduce(np.fmax(np.abs(np.diff(dips)), np.abs(np.diff(leans))), axis=1))
        texts.append(f"{step.text()} in the mean, {steps.text()} in the median realization ({name})")
        means.append(asked.at_most(name, step, words, "gradual"))
        singles.append(asked.at_most(name, steps, words, "gradual"))
    return Finding(
        "largest change of dip or asymmetry between neighbouring forces, per largest response: " + "; ".join(texts),
        [Reading("mean of the realizations", *means), Reading("median realization", *singles)],
    )


@CLAIMS.measures("D7a")
def coordination(data: Data, words: Bounds) -> Finding:
    names = {"contacts of disks": "", "walls counted": "_with_walls", "away from the boundaries": "_bulk"}
    # the paper holds 4.25 against the isostatic 4: what is "about" is the excess
    low, high = (4.0 + (1.0 + sign * words["about"]) * 0.25 for sign in (-1.0, 1.0))
    means = {
        f"{text}, {start}": over_realizations(case[f"coordination_number{kind}"].values, np.mean)
        for start, (case,) in _by_start(data.get(GROUP, "packings"), 0.0).items()
        for text, kind in names.items()
    }
    what = "contacts per disk"
    return asked.each(f"{what}: ", means, lambda q: Condition(what, q, low, high, ("about",)), changed=changed)


@CLAIMS.measures("D7b")
def missing_horizontal(data: Data, words: Bounds) -> Finding:
    study, shares = data.get(GROUP, "packings"), {}
    lattice = _case(study, 0.0, 0.0)
    for start, (case,) in _by_start(study, 0.0).items():
        names = ("horizontal_contacts", "oblique_contacts")
        horizontal, oblique = (float(np.nanmean(lattice[name].values)) - case[name].values for name in names)
        shares[start] = over_realizations(horizontal / (horizontal + oblique), np.mean)
    return asked.each(
        "horizontal part of the contacts that the lattice has and the packing has not: ",
        shares,
        lambda share: asked.at_least("horizontal part of the missing contacts", share, words, "marked", "%"),
        "%",
        changed=changed,
    )


@CLAIMS.measures("D9")
def resembles(data: Data, words: Bounds) -> Finding:
    """At forces that are known to be away from the crossover of their case."""
    study = at(data.get(GROUP, "realizations"), width=6.0)
    off = study["difference"].transpose("case", "realization", "step").values
    usual = (study["polydispersity"].values > 0.0) & (study["lattice_constant"].values.astype(str) == STARTS[0])
    known = np.isfinite(off).any(axis=1) & usual[:, None]
    typical = {}
    for name, away in zip(("below the crossover", "above the crossover"), _away(data, words), strict=True):
        found = over_realizations([np.nanmedian(off[case, :, step]) for case, step in np.argwhere(away & known)])
        typical[name] = replace(found, test="bootstrap of the median over cases and forces")
    return asked.each(
        "rms difference of the median realization from the mean, per the mean's rms, median over cases and forces: ",
        typical,
        lambda one: asked.at_most("rms difference of a typical realization from the mean", one, words, "similar", "%"),
        "%",
    )


@CLAIMS.measures("D10")
def fluctuations(data: Data, words: Bounds) -> Finding:
    spreads = {
        start: [_with_interval(case, "spread") for case in cases] for start, cases in _at_15(data, "shapes").items()
    }
    return asked.each(
        "spread of the responses of realizations at 15 mg, friction 0 over 0.2: ",
        {start: without.per(full) for start, (without, full) in spreads.items()},
        lambda ratio: Condition("spread without friction per spread with 0.2", ratio, 1.0, strict=True),
        changed=changed,
    )


def evident_samples(without: FloatArray, full: FloatArray, least: float) -> Quantity:
    """The part of samples of ``SHOWN`` realizations each in which at least this part of the pairs differ.

    ``without`` and ``full`` (r,) are the dips of realizations. With 95 % of the draws of these.
    """
    rng = np.random.default_rng(0)

    def part(ours: FloatArray, theirs: FloatArray, samples: int = 200) -> float:
        first, second = (rng.choice(of, (samples, SHOWN)) for of in (ours, theirs))
        return float(((first[:, :, None] > second[:, None]).mean(axis=(1, 2)) >= least).mean())

    drawn = [part(rng.choice(without, without.size), rng.choice(full, full.size)) for _ in range(200)]
    test, number = f"samples of {SHOWN}, bootstrap", min(without.size, full.size)
    return of_draws(part(without, full, 20000), drawn, test, number)


@CLAIMS.measures("D11")
def evident(data: Data, words: Bounds) -> Finding:
    apart, pairs = {}, {}
    for start, cases in _at_15(data, "realizations").items():
        without, full = (case["shape"].values[np.isfinite(case["shape"].values)] for case in cases)
        apart[start] = evident_samples(without, full, 1.0 - words["holds"])
        pairs[start] = over_realizations((without[:, None] > full[None, :]).mean(axis=1), np.mean)
    what = f"samples in which {1.0 - words['holds']:.0%} of the pairs of realizations differ"
    return asked.each(
        f"{what}: ",
        apart,
        lambda part: Condition(what, part, RARE, words=("holds",), unit="%"),
        "%",
        f"The paper has one sample, so what is asked is only that such a one is not rare ({RARE:.1%}). Of all pairs, "
        "the frictionless one has the deeper dip in " + asked.listed(pairs, unit="%"),
        changed=changed,
    )


#: Names of what is off in the linear range.
CENTRE, PROFILE = "response_at_centre", "profile_change"


def linear_ends(path: xr.Dataset, tolerance: float, measure: str = CENTRE) -> FloatArray:
    """(r,) forces at which realizations leave their linear range; inf for those that do not.

    ``path`` is a case of ``linear_range``; the ``measure`` is the response at x = 0, or the change of the profile from
    that to the smallest force. The change passes the tolerance between two forces, where it is taken as linear in the
    logarithm of the force. Realizations without two forces are left out.
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
            found.append(low * (high / low) ** ((tolerance - before) / (after - before)))
        else:
            found.append(np.inf)
    return np.array(found)


def linear_end(path: xr.Dataset, tolerance: float) -> Quantity:
    """The median force at which profiles of realizations leave their linear range; a bound where half of them do not.

    Raises NotMeasured for two realizations or none; a lattice has one, without scatter.
    """
    found = linear_ends(path, tolerance, PROFILE)
    CLAIMS.needs(found.size not in (0, 2), "linear_range holds too few realizations")
    force = path["applied_force"].values
    last = float(force[np.isfinite(path[CENTRE].transpose("realization", "step").values).any(axis=0)].max())
    picked = np.random.default_rng(0).integers(0, found.size, (2000, found.size))
    drawn = np.quantile(found[picked], 0.5, axis=1, method="inverted_cdf")
    value = float(np.quantile(found, 0.5, method="inverted_cdf"))
    value = value if np.isfinite(value) else float("nan")
    end = of_draws(value, drawn, "bootstrap of the median", found.size, "inverted_cdf")
    return replace(end, low=min(end.low, last))


def order_of(groups: Sequence[FloatArray], draws: int = 1000) -> Quantity:
    """Kendall's tau between the place of a group and the values of its realizations, with 95 % of the draws.

    Over all pairs of realizations of different groups: 1 if every later one is larger, -1 if every one is smaller, 0 if
    the groups do not differ. It is the statistic of Jonckheere's test.
    """
    signs = [
        ((after[:, None] > before).astype(float) - (after[:, None] < before), first, second)
        for (first, before), (second, after) in combinations(enumerate(groups), 2)
    ]
    number = sum(sign.size for sign, _, _ in signs)
    rng = np.random.default_rng(0)
    counts = [counted(rng.integers(0, one.size, (draws, one.size)), one.size) for one in groups]
    drawn = sum(np.einsum("da,ab,db->d", counts[second], sign, counts[first]) for sign, first, second in signs) / number
    tau, samples = float(sum(sign.sum() for sign, _, _ in signs) / number), sum(one.size for one in groups)
    return of_draws(tau, drawn, "Jonckheere's statistic, bootstrap", samples)


@CLAIMS.measures("D2")
def shorter_range(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "linear_range")
    readings, texts = [], []
    for start in _starts(study):
        frictions = sorted(set(study["friction"].values[_is(study, 0.01, start)].tolist()))
        for tolerance in TOLERANCES:
            conditions = []
            for mu in frictions:
                ends, lattice = (linear_ends(_case(study, *case), tolerance) for case in ((0.01, mu, start), (0.0, mu)))
                what = f"realizations with a shorter range at friction {mu:g}"
                conditions.append(Condition(what, part_of(ends < lattice[0]), 0.5, strict=True, unit="%"))
            texts.append(f"{', '.join(c.found.text('%') for c in conditions)} ({tolerance:.0%} off, {title(start)})")
            readings.append(Reading(f"response {tolerance:.0%} off, {title(start)}", *conditions))
    return Finding("realizations with a shorter range than the lattice, by friction: " + "; ".join(texts), readings)


@CLAIMS.measures("A5")
def shorter_with_disorder(data: Data, words: Bounds) -> Finding:
    """The response as a whole, since that at x = 0 is near zero without friction."""
    study = data.get(GROUP, "linear_range")
    usual = _disorders(study)
    frictions = sorted(set(study["friction"].values[_is(study, usual[-1], STARTS[0])].tolist()))
    readings, texts = [], []
    for tolerance in TOLERANCES:
        conditions = []
        for mu in frictions:
            cases = [_case(study, delta, mu) for delta in (0.0, *usual)]
            lattice, *medians = (linear_end(case, tolerance) for case in cases)
            order = order_of([linear_ends(case, tolerance, PROFILE) for case in cases[1:]])
            name = f"friction {mu:g}"
            back = Quantity.exact(sum(after.per(before).low > 1.0 for before, after in pairwise(medians)))
            conditions += [
                Condition(f"{name}, lattice per disorder of {usual[0]:g}", lattice.per(medians[0]), 1.0, strict=True),
                Condition(f"{name}, order of the realizations (Kendall's tau)", order, most=0.0, strict=True),
                Condition(f"{name}, steps against it, clear of their intervals", back, most=0.0),
            ]
            ends = ", ".join(q.text() for q in (lattice, *medians))
            texts.append(f"{ends} mg, tau {order.text()} ({name}, {tolerance:.0%} off)")
        readings.append(Reading(f"response {tolerance:.0%} off", *conditions))
    return Finding(
        f"median end of the linear range at polydispersities 0, {', '.join(f'{delta:g}' for delta in usual)}: "
        + "; ".join(texts),
        readings,
    )
