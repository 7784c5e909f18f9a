"""Claims D1 and D3 to D11, A5: disordered slabs (Secs. VI and VII), from the ensembles of the survey and by its one
definition of two peaks (:mod:`granular_response_paper.survey.crossover`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.state import FloatArray

from ...claims import asked
from ...claims.bootstrap import over_realizations
from ...claims.claim import Claims, Condition, Data, Finding, NotMeasured, Quantity, Reading, at
from ...claims.words import Bounds

GROUP = "phase_diagram"
CLAIMS = Claims(GROUP)

#: The initial lattice that this project uses, first, and the literal one.
STARTS = ("touching-largest", "2.0")

#: The width of smoothing of Fig. 21, and another one with what it changes.
WIDTHS = {6.0: "", 3.0: "smoothing"}

#: What a case is called by.
_LABELS = ("polydispersity", "friction", "lattice_constant")

#: Kinds of crossover force: found, or a bound because there are two peaks, or one, at every force.
FOUND, BELOW, ABOVE = 0, 1, 2

#: Levels of the stored bootstrap that hold 95 % of the draws.
LEVELS = (0.025, 0.975)


def _case(dataset: xr.Dataset, polydispersity: float, friction: float, start: str | None = None) -> xr.Dataset:
    """The case with these numbers, of the first start stored if none is named."""
    here = np.isclose(dataset["polydispersity"].values, polydispersity) & np.isclose(
        dataset["friction"].values, friction
    )
    if start is not None:
        here &= dataset["lattice_constant"].values.astype(str) == start
    if not here.any():
        raise NotMeasured(
            f"data/{GROUP}.nc: no case with polydispersity {polydispersity:g}, friction {friction:g}"
            + (f", start {start}" if start else "")
        )
    return dataset.isel(case=int(np.flatnonzero(here)[0]))


def _starts(dataset: xr.Dataset, polydispersity: float) -> list[str]:
    """The initial lattices stored for a polydispersity: this project's, the literal one, then by their constants."""
    here = np.isclose(dataset["polydispersity"].values, polydispersity)
    stored = set(dataset["lattice_constant"].values[here].astype(str))
    return [start for start in STARTS if start in stored] + sorted(stored - set(STARTS))


#: Ends the title of an initial lattice wider than any that the text allows.
WIDER = "wider than with touching disks"


def changed(name: str) -> str:
    """What a reading of this name changes of the set-up."""
    return "lattice" if name.endswith(WIDER) else ""


def title(start: str, polydispersity: float = 0.01) -> str:
    """An initial lattice in words."""
    if start == STARTS[0]:
        return "start with the largest disks touching"
    wider = float(start) > 2.0 / (1.0 - 0.5 * polydispersity)
    return f"start with lattice constant {start}{', ' + WIDER if wider else ''}"


def _with_interval(case: xr.Dataset, name: str) -> Quantity:
    """A number of a case with 95 % of its bootstrap draws."""
    low, high = (float(at(case, level=level)[f"{name}_interval"]) for level in LEVELS)
    return Quantity(float(case[name]), low, high, "confidence")


def _at_15(data: Data, name: str, *variables: str) -> list[tuple[str, xr.Dataset, xr.Dataset]]:
    """By start: delta = 0.01 under 15 mg at friction 0 and at 0.2, w = 3."""
    study = at(data.get(GROUP, name, *variables, *_LABELS), width=3.0)
    force = data.get(GROUP, "shapes", "applied_force", *_LABELS)
    found = []
    for start in _starts(study, 0.01):
        pair = []
        for mu in (0.0, 0.2):
            try:
                case, applied = (_case(one, 0.01, mu, start) for one in (study, force))
            except NotMeasured:
                break
            step = np.flatnonzero(np.isclose(applied["applied_force"].values, 15.0))
            if step.size:
                pair.append(case.isel(step=int(step[0])))
        if len(pair) == 2:
            found.append((start, pair[0], pair[1]))
    if not found:
        raise NotMeasured(f"data/{GROUP}.nc: {name} holds no 15 mg at polydispersity 0.01, friction 0 and 0.2")
    return found


@CLAIMS.add(
    "D1",
    "VI, Fig. 19",
    "delta = 0.01, 15 mg, w = 3: dip of the mean response at x = 0, made symmetric, at friction 0 and 0.2",
    "two distinct peaks without friction, one with 0.2",
)
def two_peaks_or_one(data: Data, words: Bounds) -> Finding:
    readings, texts = [], []
    for start, *cases in _at_15(data, "shapes", "shape", "shape_interval", "level"):
        without, full = (_with_interval(case, "shape") for case in cases)
        texts.append(f"{without.text('%')} at friction 0, {full.text('%')} at 0.2 ({title(start)})")
        readings.append(
            Reading(
                title(start),
                asked.at_least("dip at friction 0", without, words, "visible", "%"),
                asked.at_most("dip at friction 0.2", full, words, "visible", "%"),
                change=changed(title(start)),
            )
        )
    return Finding(
        "how far x = 0 is below the sides of the mean response, per its largest value: " + "; ".join(texts), readings
    )


def _crossing(case: xr.Dataset) -> Quantity:
    """The crossover force of a case with its interval; open to one side where it is a bound."""
    force, kind = float(case["force"]), int(case["kind"])
    low, high = (float(at(case, level=level)["interval"]) for level in LEVELS)
    if np.isnan(force) or np.isnan(low) or np.isnan(high):
        raise NotMeasured(f"data/{GROUP}.nc: crossovers holds a case without number")
    # at no force two peaks, or at all: what was looked at ends there
    low = max(low, 0.0)
    if kind == BELOW:
        return Quantity(force, 0.0, max(high, force), "confidence")
    return Quantity(force, min(low, force), high, "confidence")


@dataclass(frozen=True)
class Crossover:
    """The crossover force of a case, and the interval in which it lies in each draw of the bootstrap: (d,) ends."""

    found: Quantity
    kind: int
    low: FloatArray
    high: FloatArray

    def comparable(self, other: Crossover) -> bool:
        """Whether their order can be seen: not of two bounds to the same side."""
        return self.kind == FOUND or self.kind != other.kind

    def per(self, other: Crossover) -> Quantity:
        """The ratio. Cases of as many realizations were drawn alike; what a bound leaves open widens the interval."""
        with np.errstate(divide="ignore", invalid="ignore"):
            low, high = self.low / other.high, self.high / other.low
        low, high = np.where(np.isnan(low), 0.0, low), np.where(np.isnan(high), np.inf, high)
        lowest, highest = (
            float(np.quantile(values, level, method="inverted_cdf"))
            for values, level in zip((low, high), LEVELS, strict=True)
        )
        return Quantity(self.found.per(other.found).value, lowest, highest, "confidence")


def _crossover(case: xr.Dataset) -> Crossover:
    found = _crossing(case)
    draws = case["draws"].values.astype(float)
    smallest, largest = (float(end) for end in case["limits"].values)
    low = np.where(draws == -np.inf, 0.0, np.where(draws == np.inf, largest, draws))
    return Crossover(found, int(case["kind"]), low, np.where(draws == -np.inf, smallest, draws))


def _defined(data: Data, width: float, words: Bounds) -> xr.Dataset:
    """The crossovers if a dip counts from the bound of "visible" on."""
    names = ("force", "kind", "interval", "level", "draws", "limits", *_LABELS)
    usual = data.get(GROUP, "crossovers", *names)
    if np.isclose(usual.attrs.get("tolerance", words["visible"]), words["visible"]):
        return at(usual, width=width)
    return at(data.get(GROUP, "definitions", *names, "tolerance"), width=width, tolerance=words["visible"])


def _crossovers(data: Data, width: float, words: Bounds) -> dict[tuple[float, float], Crossover]:
    """By polydispersity and friction, of the usual start."""
    study = _defined(data, width, words)
    keys = dict.fromkeys(zip(study["polydispersity"].values.tolist(), study["friction"].values.tolist(), strict=True))
    return {key: _crossover(_case(study, *key, STARTS[0])) for key in keys}


def trend(line: Sequence[Crossover]) -> Quantity:
    """Kendall's tau of the order of crossover forces, with 95 % of the draws: 1 if all pairs rise, -1 if all fall.

    Pairs whose order a draw leaves open, such as two bounds to the same side, widen the interval. Cases of as many
    realizations were drawn alike.
    """
    pairs = list(combinations(line, 2))
    up = np.mean([after.low > before.high for before, after in pairs], axis=0)
    down = np.mean([after.high < before.low for before, after in pairs], axis=0)
    low, high = (
        float(np.quantile(ends, level, method="inverted_cdf"))
        for ends, level in zip((2.0 * up - 1.0, 1.0 - 2.0 * down), LEVELS, strict=True)
    )
    return Quantity(float(np.median(up - down)), low, high, "confidence")


def _orders(data: Data, words: Bounds, what: str, rising: str) -> Finding:
    """The trend of the crossover force along one axis, and steps against it, for every value of the other; both
    widths."""
    readings, texts = [], []
    for width, change in WIDTHS.items():
        found = {key: q for key, q in _crossovers(data, width, words).items() if key[0] > 0.0}
        along, across = (1, 0) if what == "friction" else (0, 1)
        conditions, trends = [], []
        for other in sorted({key[across] for key in found}):
            line = [found[key] for key in sorted(found, key=lambda key: key[along]) if key[across] == other]
            if rising == "falls":
                line = line[::-1]
            steps = [after.per(before) for before, after in pairwise(line) if after.comparable(before)]
            if not steps:  # bounds alone
                continue
            name = f"{'polydispersity' if along else 'friction'} {other:g}"
            # what has two peaks at every force is below all others, and tells nothing of the trend among these
            rest = [one for one in line if one.kind != BELOW]
            trends.append(trend(rest if len(rest) > 1 else line))
            back = Quantity.exact(sum(step.high < 1.0 for step in steps))
            conditions += [
                Condition(f"{name}, trend (Kendall's tau)", trends[-1], least=0.0, strict=True, words=("visible",)),
                Condition(f"{name}, steps against it, clear of their intervals", back, most=0.0, words=("visible",)),
            ]
        if not conditions:
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds too few crossover forces to compare")
        texts.append(f"trend {', '.join(q.text() for q in trends)} (w = {width:g})")
        readings.append(Reading(f"w = {width:g}", *conditions, change=change))
    return Finding(f"crossover force {rising} with {what}: " + ", ".join(texts), readings)


@CLAIMS.add(
    "D3a",
    "VI.A, Figs. 21, 22",
    "trend of the crossover force with friction at each polydispersity (0.01, 0.1, 0.25), and steps against it",
    "the larger the friction, the larger the crossover force",
)
def rises_with_friction(data: Data, words: Bounds) -> Finding:
    return _orders(data, words, "friction", "rises")


@CLAIMS.add(
    "D3b",
    "VI.A, Figs. 21, 22",
    "trend of the crossover force with polydispersity at each friction, and steps against it",
    "the crossover force decreases with increasing polydispersity",
)
def falls_with_disorder(data: Data, words: Bounds) -> Finding:
    return _orders(data, words, "polydispersity", "falls")


def _away(crossovers: xr.Dataset, force: FloatArray, words: Bounds) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(case, step) which forces are known to be far below the crossover, and far above.

    A force inside the interval of its crossover is not known to be away from it; a bound has forces on one side alone.
    """
    low, high = (at(crossovers, level=level)["interval"].values[:, None] for level in LEVELS)
    near, at_crossover = 1.0 + words["similar"], crossovers["force"].values[:, None]
    kind = crossovers["kind"].values[:, None]
    below = (force < np.minimum(low, at_crossover / near)) & (kind == FOUND)
    above = (force > np.maximum(high, at_crossover * near)) & (kind != ABOVE)
    return below, above


@CLAIMS.add(
    "D5",
    "VI.A",
    "number of peaks of means of five realizations against that of the mean of all, at forces beyond the interval "
    "of the crossover and more than half away from it, mean over these forces",
    "five are sufficient when the force is not too close to its crossover",
    21,
)
def five_enough(data: Data, words: Bounds) -> Finding:
    shapes = at(data.get(GROUP, "shapes", "few_agree", "applied_force", *_LABELS), width=6.0)
    crossover = at(data.get(GROUP, "crossovers", "force", "kind", "interval", "level", "realizations"), width=6.0)
    force = shapes["applied_force"].transpose("case", "step").values
    agree = shapes["few_agree"].transpose("case", "step").values
    chosen = np.isfinite(agree) & np.logical_or(*_away(crossover, force, words))
    starts, deltas = shapes["lattice_constant"].values.astype(str), shapes["polydispersity"].values
    typical = {}
    for start in STARTS:
        for delta in np.unique(deltas[deltas > 0.0]).tolist():
            here = agree[(chosen & ((starts == start) & (deltas == delta))[:, None])]
            if here.size:
                found = over_realizations(here, np.mean) if here.size > 2 else Quantity.range(here, float(here.mean()))
                typical[f"polydispersity {delta:g}, {title(start, delta)}"] = found
    if not typical:
        raise NotMeasured(f"data/{GROUP}.nc: shapes holds too few forces away from a crossover")
    return asked.each(
        "means of five have as many peaks as the mean of all in the part of the draws: ",
        typical,
        lambda part: Condition(
            "draws of five that agree", part, 1.0 - words["holds"], words=("holds", "similar"), unit="%"
        ),
        "%",
        f"Five are drawn from {int(crossover['realizations'].values[deltas > 0.0].min())} or more",
    )


@CLAIMS.add(
    "D6",
    "VIII, Fig. 22",
    "crossover force of disordered slabs over that of the lattice with the same friction",
    "in polydisperse systems the anisotropy becomes large at smaller forces",
)
def below_lattice(data: Data, words: Bounds) -> Finding:
    readings, texts = [], []
    for width, change in WIDTHS.items():
        found = _crossovers(data, width, words)
        ratios = {
            key: found[key].per(found[(0.0, key[1])])
            for key in sorted(found)
            if key[0] > 0.0 and (0.0, key[1]) in found and found[key].comparable(found[(0.0, key[1])])
        }
        if not ratios:
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds no lattice to compare with")
        texts.append(f"{sum(r.high <= 1.0 for r in ratios.values())} of {len(ratios)} clear (w = {width:g})")
        readings.append(
            Reading(
                f"w = {width:g}",
                *(
                    Condition(
                        f"per lattice at polydispersity {delta:g}, friction {mu:g}", ratio, most=1.0, words=("visible",)
                    )
                    for (delta, mu), ratio in ratios.items()
                ),
                change=change,
            )
        )
    return Finding("crossover force below that of the lattice: " + ", ".join(texts), readings)


@CLAIMS.add(
    "D8",
    "VI.A",
    "delta = 0.01: crossover force from two starts of the packing",
    "the crossover likely depends on the preparation too",
    22,
)
def preparation(data: Data, words: Bounds) -> Finding:
    readings, texts = [], []
    for width, change in WIDTHS.items():
        study = _defined(data, width, words)
        if not set(STARTS) <= set(_starts(study, 0.01)):
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds one start alone")
        for mu in (0.0, 0.2):
            usual, literal = (_crossover(_case(study, 0.01, mu, start)) for start in STARTS)
            texts.append(f"{usual.found.text('mg')} and {literal.found.text('mg')} (friction {mu:g}, w = {width:g})")
            readings.append(
                Reading(
                    f"friction {mu:g}, w = {width:g}",
                    Condition(
                        "crossover from lattice constant 2 per that from touching disks",
                        literal.per(usual),
                        1.0,
                        words=("visible",),
                        strict=True,
                    ),
                    change=change,
                )
            )
    return Finding(
        "delta = 0.01, crossover from the start with touching disks and from lattice constant 2: " + "; ".join(texts),
        readings,
    )


@CLAIMS.add(
    "D4",
    "VI.A",
    "friction 1, w = 6: largest change between neighbouring forces of the dip at x = 0 or the asymmetry, of the "
    "mean response and of realizations",
    "a rather gradual crossover even for friction 1",
    21,
)
def gradual(data: Data, words: Bounds) -> Finding:
    study = at(data.get(GROUP, "shapes", "largest_step", "largest_step_interval", "level", *_LABELS), width=6.0)
    rows = at(data.get(GROUP, "realizations", "shape", "asymmetry", *_LABELS), width=6.0)
    crossovers = at(data.get(GROUP, "crossovers", "force", "kind", *_LABELS), width=6.0)
    singles, means, texts = [], [], []
    for delta in np.unique(study["polydispersity"].values[study["polydispersity"].values > 0.0]).tolist():
        try:
            case, single, crossover = (_case(one, delta, 1.0, STARTS[0]) for one in (study, rows, crossovers))
        except NotMeasured:
            continue
        if int(crossover["kind"]) != FOUND:
            texts.append(f"no crossover seen (polydispersity {delta:g})")
            continue
        step = _with_interval(case, "largest_step")
        dips, leans = (single[name].transpose("realization", "step").values for name in ("shape", "asymmetry"))
        steps = over_realizations(np.fmax.reduce(np.fmax(np.abs(np.diff(dips)), np.abs(np.diff(leans))), axis=1))
        name = f"polydispersity {delta:g}"
        texts.append(f"{step.text()} in the mean, {steps.text()} in the median realization ({name})")
        means.append(asked.at_most(name, step, words, "gradual"))
        singles.append(asked.at_most(name, steps, words, "gradual"))
    if not means:
        raise NotMeasured(f"data/{GROUP}.nc: shapes holds no disordered case with friction 1 and a crossover")
    return Finding(
        "largest change of dip or asymmetry between neighbouring forces, per largest response: " + "; ".join(texts),
        [Reading("mean of the realizations", *means), Reading("median realization", *singles)],
    )


def _packings(data: Data, *variables: str) -> list[tuple[str, xr.Dataset]]:
    """By start: delta = 0.01 without friction at rest."""
    study = data.get(GROUP, "packings", *variables, *_LABELS)
    found = [(start, _case(study, 0.01, 0.0, start)) for start in _starts(study, 0.01)]
    if not found:
        raise NotMeasured(f"data/{GROUP}.nc: packings holds no polydispersity 0.01")
    return found


@CLAIMS.add(
    "D7a",
    "VII",
    "delta = 0.01, friction 0: contacts per disk at rest, mean over realizations",
    "about 4.25, well above the isostatic 4",
)
def coordination(data: Data, words: Bounds) -> Finding:
    names = {
        "contacts of disks": "coordination_number",
        "walls counted": "coordination_number_with_walls",
        "away from the boundaries": "coordination_number_bulk",
    }
    # the paper holds 4.25 against the isostatic 4: what is "about" is the excess
    low, high = (4.0 + (1.0 + sign * words["about"]) * 0.25 for sign in (-1.0, 1.0))
    means = {
        f"{text}, {title(start)}": over_realizations(case[name].values, np.mean)
        for start, case in _packings(data, *names.values())
        for text, name in names.items()
    }
    return asked.each(
        "contacts per disk: ",
        means,
        lambda q: Condition("contacts per disk", q, low, high, ("about",)),
        changed=changed,
    )


@CLAIMS.add(
    "D7b",
    "VII",
    "the same: horizontal part of the contacts that are missing from the lattice",
    "the missing contacts are predominantly horizontal",
)
def missing_horizontal(data: Data, words: Bounds) -> Finding:
    names = ("horizontal_contacts", "oblique_contacts")
    lattice = _case(data.get(GROUP, "packings", *names, *_LABELS), 0.0, 0.0)
    full = [float(np.nanmean(lattice[name].values)) for name in names]
    shares = {}
    for start, case in _packings(data, *names):
        gone = [full[k] - case[name].values for k, name in enumerate(names)]
        shares[title(start)] = over_realizations(gone[0] / (gone[0] + gone[1]), np.mean)
    return asked.each(
        "horizontal part of the contacts that the lattice has and the packing has not: ",
        shares,
        lambda share: asked.at_least("horizontal part of the missing contacts", share, words, "marked", "%"),
        "%",
        changed=changed,
    )


@CLAIMS.add(
    "D9",
    "VI.A",
    "w = 6: difference of a typical realization from the mean, at forces beyond the interval of the crossover and "
    "more than half away from it",
    "away from the crossover the typical response of a realization resembles the average",
    21,
)
def resembles(data: Data, words: Bounds) -> Finding:
    """At forces that are known to be away from the crossover of their case."""
    study = at(data.get(GROUP, "realizations", "difference", "polydispersity", "lattice_constant"), width=6.0)
    force = data.get(GROUP, "shapes", "applied_force")["applied_force"].transpose("case", "step").values
    crossover = at(data.get(GROUP, "crossovers", "force", "kind", "interval", "level"), width=6.0)
    usual = (study["polydispersity"].values > 0.0) & (study["lattice_constant"].values.astype(str) == STARTS[0])
    off = study["difference"].transpose("case", "realization", "step").values
    typical = {}
    for name, away in zip(("below the crossover", "above the crossover"), _away(crossover, force, words), strict=True):
        values = [
            float(np.nanmedian(off[case, :, step]))
            for case, step in np.argwhere(away & usual[:, None])
            if np.isfinite(off[case, :, step]).any()
        ]
        if len(values) < 3:
            raise NotMeasured(f"data/{GROUP}.nc: realizations holds too few forces {name}")
        typical[name] = over_realizations(values)
    return asked.each(
        "rms difference of the median realization from the mean, per the mean's rms, median over cases and forces: ",
        typical,
        lambda one: asked.at_most("rms difference of a typical realization from the mean", one, words, "similar", "%"),
        "%",
    )


@CLAIMS.add(
    "D10",
    "VI, Fig. 19",
    "delta = 0.01, 15 mg, w = 3: standard deviation over realizations without friction over that with 0.2",
    "fluctuations are larger for the frictionless case",
)
def fluctuations(data: Data, words: Bounds) -> Finding:
    ratios = {}
    for start, *cases in _at_15(data, "shapes", "spread", "spread_interval", "level"):
        without, full = (_with_interval(case, "spread") for case in cases)
        ratios[title(start)] = without.per(full)
    return asked.each(
        "spread of the responses of realizations at 15 mg, friction 0 over 0.2: ",
        ratios,
        lambda ratio: Condition("spread without friction per spread with 0.2", ratio, 1.0, strict=True),
        changed=changed,
    )


@CLAIMS.add(
    "D11",
    "VI, Fig. 19",
    "delta = 0.01, 15 mg, w = 3: dip at x = 0 of each frictionless realization against each with friction 0.2",
    "the difference is quite evident even for individual realizations",
)
def evident(data: Data, words: Bounds) -> Finding:
    what, apart = "pairs of realizations of which the frictionless has the deeper dip", {}
    for start, *cases in _at_15(data, "realizations", "shape"):
        without, full = (case["shape"].values[np.isfinite(case["shape"].values)] for case in cases)
        if min(without.size, full.size) < 5:
            raise NotMeasured(f"data/{GROUP}.nc: realizations holds too few responses at polydispersity 0.01")
        apart[title(start)] = over_realizations((without[:, None] > full[None, :]).mean(axis=1), np.mean)
    return asked.each(
        f"{what}: ", apart, lambda part: asked.hardly_lower(what, part, words, "holds", "%"), "%", changed=changed
    )


def linear_end(path: xr.Dataset, tolerance: float) -> Quantity:
    """The median force at which realizations leave their linear range; a bound where half of them do not.

    ``path`` is a case of ``linear_range``; the response at x = 0 is then off by more than ``tolerance``. Raises
    NotMeasured for two realizations or none; a lattice has one, without scatter.
    """
    response = path["response_at_centre"].transpose("realization", "step").values
    force = path["applied_force"].values
    ends, last = [], 0.0
    for value in response:
        known = np.isfinite(value)
        if known.sum() < 2:
            continue
        last = max(last, float(force[known][-1]))
        off = np.flatnonzero(np.abs(value[known] / value[known][0] - 1.0) > tolerance)
        ends.append(np.sqrt(force[known][off[0] - 1] * force[known][off[0]]) if off.size else np.inf)
    found = np.array(ends)
    if found.size == 0 or found.size == 2:
        raise NotMeasured(f"data/{GROUP}.nc: linear_range holds too few realizations")
    picked = np.random.default_rng(0).integers(0, found.size, (2000, found.size))
    drawn = np.quantile(found[picked], 0.5, axis=1, method="inverted_cdf")
    low, high = (float(end) for end in np.quantile(drawn, LEVELS, method="inverted_cdf"))
    value = float(np.quantile(found, 0.5, method="inverted_cdf"))
    return Quantity(value if np.isfinite(value) else float("nan"), min(low, last), high, "confidence")


@CLAIMS.add(
    "A5",
    "abstract",
    "smooth walls, w = 3: median end of the linear range at x = 0 against polydispersity from 0 to 0.25",
    "increasing polydispersity decreases the range of elastic response",
    20,
)
def shorter_with_disorder(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "linear_range", "response_at_centre", "applied_force", *_LABELS)
    deltas = sorted(set(study["polydispersity"].values.tolist()))
    if len(deltas) < 3:
        raise NotMeasured(f"data/{GROUP}.nc: linear_range holds too few polydispersities")
    readings, texts = [], []
    for tolerance in (0.01, 0.02, 0.05):
        conditions = []
        for mu in sorted(set(study["friction"].values.tolist())):
            line = [linear_end(_case(study, delta, mu, STARTS[0]), tolerance) for delta in deltas]
            steps = [after.per(before) for before, after in pairwise(line)]
            value, low, high = (max(getattr(s, end) for s in steps) for end in ("value", "low", "high"))
            worst = Quantity(value, low, high, "confidence")
            conditions.append(Condition(f"friction {mu:g}, largest ratio of neighbours", worst, most=1.0))
            texts.append(f"{', '.join(q.text() for q in line)} mg (friction {mu:g}, {tolerance:.0%} off)")
        readings.append(Reading(f"response {tolerance:.0%} off", *conditions))
    return Finding(
        f"median end of the linear range at polydispersities {', '.join(f'{delta:g}' for delta in deltas)}: "
        + "; ".join(texts),
        readings,
    )
