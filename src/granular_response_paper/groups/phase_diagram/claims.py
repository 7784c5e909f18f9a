"""Claims D1 to D11, A5: disordered slabs (Secs. VI and VII), from the ensembles of the survey and by its one
definition of two peaks (:mod:`granular_response_paper.survey.crossover`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.state import FloatArray

from ...claims import asked
from ...claims.bootstrap import OUTSIDE, over_realizations, part_of
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

#: What is stored of crossovers.
_CROSSING = ("force", "kind", "interval", "level", "draws", "limits", *_LABELS)

#: Kinds of crossover force: found, or a bound because there are two peaks, or one, at every force.
FOUND, BELOW, ABOVE = 0, 1, 2

#: Realizations in Fig. 21, and in each panel of Fig. 19.
FEW, SHOWN = 5, 15

#: A part of samples below this is rare: they lie outside of the central 95 %.
RARE = 0.5 * OUTSIDE

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


#: How intervals over realizations are made.
BOOTSTRAP = "bootstrap of realizations"


def _packings_of(case: xr.Dataset) -> int:
    return int(case["realizations"]) if "realizations" in case.variables else 1


def _with_interval(case: xr.Dataset, name: str) -> Quantity:
    """A number of a case with 95 % of its bootstrap draws."""
    low, high = (float(at(case, level=level)[f"{name}_interval"]) for level in LEVELS)
    return Quantity(float(case[name]), low, high, "confidence", BOOTSTRAP, _packings_of(case))


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
    f"delta = 0.01, 15 mg, w = 3: means of {SHOWN} packings, as in the paper, that have two peaks at friction 0, and "
    "one at 0.2",
    "two distinct peaks without friction, one with 0.2",
)
def two_peaks_or_one(data: Data, words: Bounds) -> Finding:
    """The paper shows one mean of each friction: what is asked is only that such ones are not rare."""
    study = at(data.get(GROUP, "starts", "two_peaked_means", "two_peaked_means_interval", "dip", *_LABELS), width=3.0)
    readings, texts, dips = [], [], []
    for start in _starts(study, 0.01):
        cases = [_case(study, 0.01, mu, start) for mu in (0.0, 0.2)]
        test = f"means of {SHOWN}, bootstrap"
        two, split = (replace(_with_interval(case, "two_peaked_means"), test=test) for case in cases)
        one = replace(split, value=1.0 - split.value, low=1.0 - split.high, high=1.0 - split.low)
        texts.append(f"{two.text('%')} and {one.text('%')} ({title(start)})")
        found = [_with_interval(case, "dip").text("%") for case in cases]
        dips.append(f"{found[0]} at friction 0, {found[1]} at 0.2 ({title(start)})")
        readings.append(
            Reading(
                title(start),
                Condition("means with two peaks at friction 0", two, RARE, unit="%"),
                Condition("means with one peak at friction 0.2", one, RARE, unit="%"),
                change=changed(title(start)),
            )
        )
    return Finding(
        f"means of {SHOWN} with two peaks at friction 0, and with one at 0.2: " + "; ".join(texts),
        readings,
        f"The paper has one mean of each, so what is asked is only that such ones are not rare ({RARE:.1%}). How far "
        "the mean of all packings dips at x = 0, per its largest value: " + "; ".join(dips),
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
        low, high = 0.0, max(high, force)
    return Quantity(force, min(low, force), high, "confidence", BOOTSTRAP, _packings_of(case))


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
        ratio = self.found.per(other.found)
        return Quantity(ratio.value, lowest, highest, "confidence", BOOTSTRAP, ratio.samples)


def _crossover(case: xr.Dataset) -> Crossover:
    found = _crossing(case)
    draws = case["draws"].values.astype(float)
    smallest, largest = (float(end) for end in case["limits"].values)
    low = np.where(draws == -np.inf, 0.0, np.where(draws == np.inf, largest, draws))
    return Crossover(found, int(case["kind"]), low, np.where(draws == -np.inf, smallest, draws))


def _defined(data: Data, width: float, words: Bounds) -> xr.Dataset:
    """The crossovers if a dip counts from the bound of "visible" on."""
    usual = data.get(GROUP, "crossovers", *_CROSSING)
    if np.isclose(usual.attrs.get("tolerance", words["visible"]), words["visible"]):
        return at(usual, width=width)
    return at(data.get(GROUP, "definitions", *_CROSSING, "tolerance"), width=width, tolerance=words["visible"])


def _crossovers(data: Data, width: float, words: Bounds) -> dict[tuple[float, float], Crossover]:
    """By polydispersity and friction, of the usual start."""
    return _by_case(_defined(data, width, words))


def _medians(data: Data, width: float) -> tuple[dict[tuple[float, float], Crossover], dict[tuple[float, float], bool]]:
    """Crossovers of the median realization by polydispersity and friction, and whether packings collapse."""
    study = at(data.get(GROUP, "medians", "collapsed", *_CROSSING), width=width)
    found = _by_case(study)
    return found, {key: bool(_case(study, *key, STARTS[0])["collapsed"]) for key in found}


def _by_case(study: xr.Dataset) -> dict[tuple[float, float], Crossover]:
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
    samples = max(one.found.samples for one in line)
    return Quantity(float(np.median(up - down)), low, high, "confidence", "Kendall's tau of the draws", samples)


def _lines(
    data: Data, width: float, words: Bounds, what: str, means: bool = False
) -> list[tuple[str, list[Crossover]]]:
    """Crossovers of disorder along friction or polydispersity, by the value of the other; bounds alone are left out.

    They are all medians of realizations if packings of one of them collapse, unless ``means`` are wanted.
    """
    usual, medians, collapsed = _crossovers(data, width, words), *_medians(data, width)
    along, across = (1, 0) if what == "friction" else (0, 1)
    lines = []
    for other in sorted({key[across] for key in usual if key[0] > 0.0}):
        keys = sorted((key for key in usual if key[0] > 0.0 and key[across] == other), key=lambda key: key[along])
        found = usual if means or not any(collapsed[key] for key in keys) else medians
        line = [found[key] for key in keys]
        if any(after.comparable(before) for before, after in pairwise(line)):
            lines.append((f"{'polydispersity' if along else 'friction'} {other:g}", line))
    return lines


def _trend(line: Sequence[Crossover]) -> Quantity:
    """The trend among those that do not have two peaks at every force, which are below all others."""
    rest = [one for one in line if one.kind != BELOW]
    return trend(rest if len(rest) > 1 else line)


def _orders(data: Data, words: Bounds, what: str, rising: str) -> Finding:
    """The trend of the crossover force along one axis, and steps against it, for every value of the other; both
    widths."""
    readings, texts = [], []
    turned = slice(None, None, -1 if rising == "falls" else 1)
    for width, change in WIDTHS.items():
        conditions, trends = [], []
        for name, found in _lines(data, width, words, what):
            line = found[turned]
            steps = [after.per(before) for before, after in pairwise(line) if after.comparable(before)]
            trends.append(_trend(line))
            back = Quantity.exact(sum(step.high < 1.0 for step in steps))
            conditions += [
                Condition(f"{name}, trend (Kendall's tau)", trends[-1], least=0.0, strict=True, words=("visible",)),
                Condition(f"{name}, steps against it, clear of their intervals", back, most=0.0, words=("visible",)),
            ]
        if not conditions:
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds too few crossover forces to compare")
        texts.append(f"trend {', '.join(q.text() for q in trends)} (w = {width:g})")
        readings.append(Reading(f"w = {width:g}", *conditions, change=change))
    means = ", ".join(f"{_trend(line[turned]).text()} ({name})" for name, line in _lines(data, 6.0, words, what, True))
    return Finding(
        f"crossover force {rising} with {what}: " + ", ".join(texts),
        readings,
        f"Where packings collapse, medians of realizations are compared; of means alone (w = 6): trend {means}",
    )


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
    shapes = at(data.get(GROUP, "shapes", "two_peaked_means", "shape", "applied_force", *_LABELS), width=6.0)
    shapes = at(shapes, number=FEW)
    crossover = at(data.get(GROUP, "crossovers", "force", "kind", "interval", "level", "realizations"), width=6.0)
    force = shapes["applied_force"].transpose("case", "step").values
    two_peaked, shape = (shapes[name].transpose("case", "step").values for name in ("two_peaked_means", "shape"))
    agree = np.where(shape > shapes.attrs.get("tolerance", words["visible"]), two_peaked, 1.0 - two_peaked)
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
        means, medians, collapsed = _crossovers(data, width, words), *_medians(data, width)
        ratios = {}
        for key in sorted(means):
            found, lattice = medians if collapsed[key] else means, (0.0, key[1])
            if key[0] > 0.0 and lattice in found and found[key].comparable(found[lattice]):
                ratios[key] = found[key].per(found[lattice])
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
    return Finding(
        "crossover force below that of the lattice: " + ", ".join(texts),
        readings,
        "Where packings collapse, the median of realizations is compared",
    )


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


def evident_samples(without: FloatArray, full: FloatArray, least: float) -> Quantity:
    """The part of samples of ``SHOWN`` realizations each in which at least this part of the pairs differ.

    ``without`` and ``full`` (r,) are the dips of realizations. With 95 % of the draws of these.
    """
    rng = np.random.default_rng(0)

    def part(ours: FloatArray, theirs: FloatArray, samples: int = 200) -> float:
        first, second = (rng.choice(of, (samples, SHOWN)) for of in (ours, theirs))
        return float(((first[:, :, None] > second[:, None]).mean(axis=(1, 2)) >= least).mean())

    drawn = [part(rng.choice(without, without.size), rng.choice(full, full.size)) for _ in range(200)]
    low, high = np.quantile(drawn, LEVELS)
    test, number = f"samples of {SHOWN}, bootstrap", min(without.size, full.size)
    return Quantity(part(without, full, 20000), float(low), float(high), "confidence", test, number)


@CLAIMS.add(
    "D11",
    "VI, Fig. 19",
    f"delta = 0.01, 15 mg, w = 3: samples of {SHOWN} realizations at friction 0 and {SHOWN} at 0.2, as in the paper, "
    "in which nearly every frictionless one has the deeper dip",
    "the difference is quite evident even for individual realizations",
)
def evident(data: Data, words: Bounds) -> Finding:
    apart, pairs = {}, []
    for start, *cases in _at_15(data, "realizations", "shape"):
        without, full = (case["shape"].values[np.isfinite(case["shape"].values)] for case in cases)
        if min(without.size, full.size) < 5:
            raise NotMeasured(f"data/{GROUP}.nc: realizations holds too few responses at polydispersity 0.01")
        apart[title(start)] = evident_samples(without, full, 1.0 - words["holds"])
        whole = over_realizations((without[:, None] > full[None, :]).mean(axis=1), np.mean)
        pairs.append(f"{whole.text('%')} ({title(start)})")
    what = f"samples in which {1.0 - words['holds']:.0%} of the pairs of realizations differ"
    return asked.each(
        f"{what}: ",
        apart,
        lambda part: Condition(what, part, RARE, words=("holds",), unit="%"),
        "%",
        f"The paper has one sample, so what is asked is only that such a one is not rare ({RARE:.1%}). Of all pairs, "
        "the frictionless one has the deeper dip in " + ", ".join(pairs),
        changed=changed,
    )


#: Names of what is off in the linear range.
CENTRE, PROFILE = "response_at_centre", "profile_change"


def _changes(path: xr.Dataset, measure: str) -> FloatArray:
    """(r, k) relative change from the response to the smallest force: at x = 0, or of the profile."""
    value = path[measure].transpose("realization", "step").values
    return value if measure == PROFILE else np.abs(value / value[:, :1] - 1.0)


def linear_ends(path: xr.Dataset, tolerance: float, measure: str = CENTRE) -> FloatArray:
    """(r,) forces at which realizations leave their linear range; inf for those that do not.

    ``path`` is a case of ``linear_range``. The change passes the tolerance between two forces, where it is taken as
    linear in the logarithm of the force. Realizations without two forces are left out.
    """
    force, found = path["applied_force"].values, []
    for change in _changes(path, measure):
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


def linear_end(path: xr.Dataset, tolerance: float, measure: str = CENTRE) -> Quantity:
    """The median force at which realizations leave their linear range; a bound where half of them do not.

    Raises NotMeasured for two realizations or none; a lattice has one, without scatter.
    """
    found = linear_ends(path, tolerance, measure)
    if found.size == 0 or found.size == 2:
        raise NotMeasured(f"data/{GROUP}.nc: linear_range holds too few realizations")
    force = path["applied_force"].values
    last = float(force[np.isfinite(path[CENTRE].transpose("realization", "step").values).any(axis=0)].max())
    picked = np.random.default_rng(0).integers(0, found.size, (2000, found.size))
    drawn = np.quantile(found[picked], 0.5, axis=1, method="inverted_cdf")
    low, high = (float(end) for end in np.quantile(drawn, LEVELS, method="inverted_cdf"))
    value = float(np.quantile(found, 0.5, method="inverted_cdf"))
    value = value if np.isfinite(value) else float("nan")
    return Quantity(value, min(low, last), high, "confidence", "bootstrap of the median", found.size)


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
    counts = [
        np.stack([np.bincount(row, minlength=one.size) for row in rng.integers(0, one.size, (draws, one.size))])
        for one in groups
    ]
    drawn = sum(np.einsum("da,ab,db->d", counts[second], sign, counts[first]) for sign, first, second in signs) / number
    low, high = np.quantile(drawn, LEVELS)
    tau, samples = float(sum(sign.sum() for sign, _, _ in signs) / number), sum(one.size for one in groups)
    return Quantity(tau, float(low), float(high), "confidence", "Jonckheere's statistic, bootstrap", samples)


@CLAIMS.add(
    "D2",
    "VI.A, Fig. 20",
    "delta = 0.01, w = 3: realizations whose linear range at x = 0 is shorter than that of the lattice with the same "
    "friction",
    "the range of linear response is smaller",
)
def shorter_range(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "linear_range", CENTRE, "applied_force", *_LABELS)
    deltas, mus, all_starts = (study[name].values for name in _LABELS)
    readings, texts = [], []
    for start in _starts(study, 0.01):
        here = np.isclose(deltas, 0.01) & (all_starts.astype(str) == start)
        for tolerance in (0.01, 0.02, 0.05):
            conditions = []
            for mu in sorted(set(mus[here].tolist())):
                ends, lattice = (linear_ends(_case(study, *case), tolerance) for case in ((0.01, mu, start), (0.0, mu)))
                shorter = part_of(ends < lattice[0])
                what = f"realizations with a shorter range at friction {mu:g}"
                conditions.append(Condition(what, shorter, 0.5, strict=True, unit="%"))
            texts.append(f"{', '.join(c.found.text('%') for c in conditions)} ({tolerance:.0%} off, {title(start)})")
            readings.append(Reading(f"response {tolerance:.0%} off, {title(start)}", *conditions))
    return Finding(
        "realizations with a shorter range than the lattice, by friction: " + "; ".join(texts),
        readings,
        "The paper shows one realization",
    )


@CLAIMS.add(
    "A5",
    "abstract",
    "smooth walls, w = 3: end of the linear range of the whole response against polydispersity: lattice over 0.01, "
    "order of the realizations from 0.01 to 0.25, and steps of the median against it",
    "increasing polydispersity decreases the range of elastic response",
    20,
)
def shorter_with_disorder(data: Data, words: Bounds) -> Finding:
    """The response as a whole, since that at x = 0 is near zero without friction."""
    study = data.get(GROUP, "linear_range", CENTRE, PROFILE, "applied_force", *_LABELS)
    deltas, mus, starts = (study[name].values for name in _LABELS)
    usual = sorted(set(deltas[(deltas > 0.0) & (starts.astype(str) == STARTS[0])].tolist()))
    if len(usual) < 2:
        raise NotMeasured(f"data/{GROUP}.nc: linear_range holds too few polydispersities")
    frictions = sorted(set(mus[deltas == usual[-1]].tolist()))
    readings, texts = [], []
    for tolerance in (0.01, 0.02, 0.05):
        conditions = []
        for mu in frictions:
            lattice = linear_end(_case(study, 0.0, mu), tolerance, PROFILE)
            cases = [_case(study, delta, mu, STARTS[0]) for delta in usual]
            medians = [linear_end(case, tolerance, PROFILE) for case in cases]
            order = order_of([linear_ends(case, tolerance, PROFILE) for case in cases])
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
