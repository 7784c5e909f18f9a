"""Claims D1, D3, D5, D6 and D8: two peaks and their crossover in disordered slabs (Sec. VI), by the one definition of
two peaks of this group (:mod:`simulate`)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...claims.bootstrap import over_realizations
from ...claims.claim import Claim, Condition, Data, Finding, NotMeasured, Quantity, Reading, at
from ...claims.words import Bounds

FloatArray = NDArray[np.float64]

GROUP = "phase_diagram"

#: The start that this project uses, first, and the literal one.
STARTS = ("touching-largest", "2.0")

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
    """The starts stored for a polydispersity, this project's first."""
    here = np.isclose(dataset["polydispersity"].values, polydispersity)
    stored = set(dataset["lattice_constant"].values[here].astype(str))
    return [start for start in STARTS if start in stored]


def title(start: str) -> str:
    return "start with the largest disks touching" if start == STARTS[0] else f"start with lattice constant {start}"


def two_peaks_or_one(data: Data, words: Bounds) -> Finding:
    names = ("shape", "shape_interval", "applied_force", "level", "polydispersity", "friction", "lattice_constant")
    study = at(data.get(GROUP, "shapes", *names), width=3.0)
    readings, texts = [], []
    for start in _starts(study, 0.01):
        shapes = []
        for mu in (0.0, 0.2):
            case = _case(study, 0.01, mu, start)
            step = np.flatnonzero(np.isclose(case["applied_force"].values, 15.0))
            if not step.size:
                raise NotMeasured(f"data/{GROUP}.nc: no 15 mg at polydispersity 0.01, friction {mu:g}")
            one = case.isel(step=int(step[0]))
            low, high = (float(at(one, level=level)["shape_interval"]) for level in LEVELS)
            shapes.append(Quantity(float(one["shape"]), low, high, "confidence"))
        texts.append(f"{shapes[0].text('%')} at friction 0, {shapes[1].text('%')} at 0.2 ({title(start)})")
        readings.append(
            Reading(
                title(start),
                Condition("dip at friction 0", shapes[0], words["visible"], words=("visible",), unit="%"),
                Condition("dip at friction 0.2", shapes[1], most=words["visible"], words=("visible",), unit="%"),
            )
        )
    if not readings:
        raise NotMeasured(f"data/{GROUP}.nc: shapes holds no polydispersity 0.01")
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


def _crossovers(data: Data, width: float) -> dict[tuple[float, float], Quantity]:
    """By polydispersity and friction, of the usual start."""
    names = ("force", "kind", "interval", "level", "polydispersity", "friction", "lattice_constant")
    study = at(data.get(GROUP, "crossovers", *names), width=width)
    keys = dict.fromkeys(zip(study["polydispersity"].values.tolist(), study["friction"].values.tolist(), strict=True))
    return {key: _crossing(_case(study, *key)) for key in keys}


def _smallest(steps: list[Quantity]) -> Quantity:
    return Quantity(min(s.value for s in steps), min(s.low for s in steps), min(s.high for s in steps), "confidence")


def _orders(data: Data, what: str, rising: str) -> Finding:
    """The smallest ratio of neighbouring crossover forces along one axis, for every value of the other; both widths."""
    readings, texts = [], []
    for width in (6.0, 3.0):
        found = {key: q for key, q in _crossovers(data, width).items() if key[0] > 0.0}
        along, across = (1, 0) if what == "friction" else (0, 1)
        conditions = []
        clear = total = 0
        for other in sorted({key[across] for key in found}):
            line = [found[key] for key in sorted(found, key=lambda key: key[along]) if key[across] == other]
            if rising == "falls":
                line = line[::-1]
            steps = [after.per(before) for before, after in pairwise(line)]
            if not steps:
                continue
            total += len(steps)
            clear += sum(step.low >= 1.0 for step in steps)
            name = f"{'polydispersity' if along else 'friction'} {other:g}"
            conditions.append(Condition(f"{name}, smallest ratio of neighbours", _smallest(steps), least=1.0))
        if not conditions:
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds too few crossover forces to compare")
        texts.append(f"{clear} of {total} steps clear of their intervals (w = {width:g})")
        readings.append(Reading(f"w = {width:g}", *conditions))
    return Finding(
        f"crossover force {rising} with {what}: " + ", ".join(texts),
        readings,
    )


def rises_with_friction(data: Data, words: Bounds) -> Finding:
    return _orders(data, "friction", "rises")


def falls_with_disorder(data: Data, words: Bounds) -> Finding:
    return _orders(data, "polydispersity", "falls")


def below_lattice(data: Data, words: Bounds) -> Finding:
    readings, texts = [], []
    for width in (6.0, 3.0):
        found = _crossovers(data, width)
        ratios = {
            key: found[key].per(found[(0.0, key[1])])
            for key in sorted(found)
            if key[0] > 0.0 and (0.0, key[1]) in found
        }
        if not ratios:
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds no lattice to compare with")
        texts.append(f"{sum(r.high <= 1.0 for r in ratios.values())} of {len(ratios)} clear (w = {width:g})")
        readings.append(
            Reading(
                f"w = {width:g}",
                *(
                    Condition(f"per lattice at polydispersity {delta:g}, friction {mu:g}", ratio, most=1.0)
                    for (delta, mu), ratio in ratios.items()
                ),
            )
        )
    return Finding("crossover force below that of the lattice: " + ", ".join(texts), readings)


def five_enough(data: Data, words: Bounds) -> Finding:
    shapes = at(data.get(GROUP, "shapes", "few_agree", "applied_force", "polydispersity"), width=6.0)
    crossover = at(data.get(GROUP, "crossovers", "force", "kind", "interval", "level"), width=6.0)
    force = shapes["applied_force"].transpose("case", "step").values
    known = (crossover["kind"].values == FOUND) & (shapes["polydispersity"].values > 0.0)
    agree = shapes["few_agree"].transpose("case", "step").values
    # a force inside the interval of its crossover is not known to be away from it
    low, high = (at(crossover, level=level)["interval"].values[:, None] for level in LEVELS)
    near = 1.0 + words["similar"]
    away = (force < np.minimum(low, crossover["force"].values[:, None] / near)) | (
        force > np.maximum(high, crossover["force"].values[:, None] * near)
    )
    chosen = agree[known[:, None] & np.isfinite(agree) & away]
    if chosen.size < 3:
        raise NotMeasured(f"data/{GROUP}.nc: shapes holds too few forces away from a crossover")
    typical = over_realizations(chosen, np.mean)
    return Finding(
        f"means of five have as many peaks as the mean of all in {typical.text('%')} of the draws, mean over "
        f"{chosen.size} forces away from the crossover; {chosen.min():.0%} at the worst of them",
        [
            Reading(
                "w = 6",
                Condition(
                    "draws of five that agree",
                    typical,
                    1.0 - words["holds"],
                    words=("holds", "similar"),
                    unit="%",
                ),
            )
        ],
        "Five are drawn from the twenty, so the two are not independent",
    )


def preparation(data: Data, words: Bounds) -> Finding:
    names = ("force", "kind", "interval", "level", "polydispersity", "friction", "lattice_constant")
    readings, texts = [], []
    for width in (6.0, 3.0):
        study = at(data.get(GROUP, "crossovers", *names), width=width)
        if len(_starts(study, 0.01)) < len(STARTS):
            raise NotMeasured(f"data/{GROUP}.nc: crossovers holds one start alone")
        for mu in (0.0, 0.2):
            usual, literal = (_crossing(_case(study, 0.01, mu, start)) for start in STARTS)
            texts.append(f"{usual.text('mg')} and {literal.text('mg')} (friction {mu:g}, w = {width:g})")
            readings.append(
                Reading(
                    f"friction {mu:g}, w = {width:g}",
                    Condition(
                        "crossover from lattice constant 2 per that from touching disks",
                        literal.per(usual),
                        1.0,
                        strict=True,
                    ),
                )
            )
    return Finding(
        "delta = 0.01, crossover from the start with touching disks and from lattice constant 2: " + "; ".join(texts),
        readings,
    )


CLAIMS = (
    Claim(
        "D1",
        "VI, Fig. 19",
        "delta = 0.01, 15 mg, w = 3: dip of the mean response at x = 0, made symmetric, at friction 0 and 0.2",
        "two distinct peaks without friction, one with 0.2",
        two_peaks_or_one,
        (19,),
        GROUP,
    ),
    Claim(
        "D3a",
        "VI.A, Figs. 21, 22",
        "crossover force against friction at each polydispersity (0.01, 0.1, 0.25)",
        "the larger the friction, the larger the crossover force",
        rises_with_friction,
        (21, 22),
        GROUP,
    ),
    Claim(
        "D3b",
        "VI.A, Figs. 21, 22",
        "crossover force against polydispersity at each friction",
        "the crossover force decreases with increasing polydispersity",
        falls_with_disorder,
        (21, 22),
        GROUP,
    ),
    Claim(
        "D5",
        "VI.A",
        "number of peaks of means of five realizations against that of the mean of all, at forces beyond the interval "
        "of the crossover and more than half away from it",
        "five are sufficient when the force is not too close to its crossover",
        five_enough,
        (21,),
        GROUP,
    ),
    Claim(
        "D6",
        "VIII, Fig. 22",
        "crossover force of disordered slabs over that of the lattice with the same friction",
        "in polydisperse systems the anisotropy becomes large at smaller forces",
        below_lattice,
        (22,),
        GROUP,
    ),
    Claim(
        "D8",
        "VI.A",
        "delta = 0.01: crossover force from two starts of the packing",
        "the crossover likely depends on the preparation too",
        preparation,
        (22,),
        GROUP,
    ),
)
