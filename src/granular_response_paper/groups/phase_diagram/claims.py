"""Claims on disordered slabs (abstract, Secs. VI to VIII), from the ensembles of the survey and by its one definition
of two peaks (:mod:`granular_response_paper.survey.crossover`).

The text starts from a lattice with twice the mean radius as its constant, in which disks of unequal size overlap. This
project starts where the largest disks touch. Both, and lattices between them, are values of what the text leaves open
in every claim here; wider lattices are another preparation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, groupby, pairwise, product
from typing import NamedTuple

import numpy as np
import xarray as xr

from granular_response.scene.lattice import SlabPacking, touching_largest
from granular_response.state import FloatArray
from granular_response_paper.claims.bootstrap import LEVELS, of_draws, over_brackets, over_realizations, part_of
from granular_response_paper.claims.claim import Bound, Case, Data, Numbers, Quantity, at, needs
from granular_response_paper.survey.crossover import ABOVE, BELOW, FOUND, counted

GROUP = "phase_diagram"

#: The initial lattice of this project, and the literal one.
USUAL, LITERAL = "touching-largest", "2.0"

#: Width of smoothing of Figs. 21 and 22, and of Figs. 19 and 20; realizations in each panel of Fig. 19.
WIDE, NARROW, SHOWN = 6.0, 3.0, 15

#: How far off a response is no longer linear: the text does not say.
TOLERANCES = (0.01, 0.02, 0.05)

#: How intervals over realizations are made.
BOOTSTRAP = "bootstrap of realizations"


class Slab(NamedTuple):
    """What a case is: its polydispersity, its initial lattice and its friction."""

    polydispersity: float
    start: str
    friction: float

    def of(self, study: xr.Dataset) -> xr.Dataset:
        """The case of a study. Raises NotMeasured if there is none."""
        return at(study, polydispersity=self.polydispersity, friction=self.friction, lattice_constant=self.start)

    @property
    def title(self) -> str:
        return f"polydispersity {self.polydispersity:g}, friction {self.friction:g}"

    def case(self, name: str | None = None, of: str = "") -> Case:
        """A value of what the text leaves open, or another preparation if the lattice is wider than it need be."""
        name = f"polydispersity {self.polydispersity:g}" if name is None else name
        title = ", ".join(filter(None, (name, _title(self.start))))
        wider = self.start != USUAL and float(self.start) > touching_largest(self.polydispersity)
        return Case("" if wider else title, of, title if wider else "")


def _title(start: str) -> str:
    return "largest disks touch at first" if start == USUAL else f"lattice constant {start}"


def _slabs(study: xr.Dataset, disordered: bool = True) -> list[Slab]:
    """Every case: by start this project's first, then by their constants."""
    columns = (study[name].values.tolist() for name in ("polydispersity", "lattice_constant", "friction"))
    found = sorted(map(Slab, *columns), key=lambda slab: (slab.polydispersity, slab.start != USUAL, *slab[1:]))
    return [slab for slab in found if (slab.polydispersity > 0.0) is disordered]


def _lines(study: xr.Dataset) -> dict[tuple[float, str], list[Slab]]:
    """Disordered cases with growing friction, by polydispersity and start."""
    return {key: list(line) for key, line in groupby(_slabs(study), key=lambda slab: slab[:2])}


def _cases(data: Data, *names: str, **labels: float) -> Iterator[tuple[Slab, list[xr.Dataset]]]:
    """Every case of disorder with its datasets."""
    studies = [at(data.get(GROUP, name), **labels) for name in names]
    yield from ((slab, [slab.of(study) for study in studies]) for slab in _slabs(studies[0]))


def _by_start(study: xr.Dataset, *frictions: float) -> Iterator[tuple[Slab, list[xr.Dataset]]]:
    """Starts of delta = 0.01 with their cases of these frictions."""
    for (delta, _), line in _lines(study).items():
        slabs = [slab for slab in line if slab.friction in frictions]
        if np.isclose(delta, 0.01) and len(slabs) == len(frictions):
            yield slabs[0], [slab.of(study) for slab in slabs]


def _with_interval(case: xr.Dataset, name: str, method: str = BOOTSTRAP) -> Quantity:
    """A number of a case with 95 % of its draws."""
    low, high = case[f"{name}_interval"].values[[0, -1]].tolist()
    return Quantity(float(case[name]), low, high, "confidence", method, int(case["realizations"]))


def two_peaks_or_one(data: Data) -> Numbers:
    """D1. The paper shows one mean of each friction, so that what is asked is only that such ones are not rare."""
    method = f"quantile of means of {SHOWN}, bootstrap"
    for slab, cases in _by_start(at(data.get(GROUP, "starts"), width=NARROW), 0.0, 0.2):
        tails = (at(case, level=level) for case, level in zip(cases, LEVELS[::-1], strict=True))
        yield slab.case(""), *(_with_interval(tail, "dip_of_means", method) for tail in tails)


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
        low, high = case["interval"].values[[0, -1]].tolist()
        needs(not np.isnan([force, low, high]).any(), "crossovers holds a case without number")
        # at no force two peaks, or at all: what was looked at ends there
        low = 0.0 if kind == BELOW else min(max(low, 0.0), force)
        high = max(high, force) if kind == BELOW else high
        smallest, largest = case["limits"].values.tolist()
        draws = case["draws"].values.astype(float)  # beyond these limits -inf or inf
        found = Quantity(force, low, high, "confidence", BOOTSTRAP, int(case["realizations"]))
        return cls(found, kind, np.clip(draws, 0.0, largest), np.maximum(draws, smallest))

    def comparable(self, other: Crossover) -> bool:
        """Whether their order can be seen: not of two bounds to the same side."""
        return self.kind == FOUND or self.kind != other.kind

    def per(self, other: Crossover) -> Quantity:
        """The ratio. Cases of as many realizations were drawn alike; what a bound leaves open widens the interval."""
        with np.errstate(divide="ignore"):
            ends = self.low / other.high, self.high / other.low
        ratio = self.found.per(other.found)
        return of_draws(ratio.value, ends, BOOTSTRAP, ratio.samples, "inverted_cdf")


def _crossover(data: Data, slab: Slab) -> Crossover:
    """By the mean of the realizations; by the median one where packings collapse, so that the mean hangs on a few.

    A dip counts from the threshold of "visible" on.
    """
    medians = slab.of(at(data.get(GROUP, "medians"), width=WIDE))
    if int(medians["collapsed"]) > 0:
        return Crossover.of(medians)
    study, visible = data.get(GROUP, "crossovers"), data.words["visible"]
    if np.isclose(study.attrs.get("tolerance", visible), visible):
        return Crossover.of(slab.of(at(study, width=WIDE)))
    return Crossover.of(slab.of(at(data.get(GROUP, "definitions"), width=WIDE, tolerance=visible)))


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
    return of_draws(np.median(up - down), ends, "Kendall's tau of the draws", samples, "inverted_cdf")


def _order(line: Sequence[Crossover]) -> tuple[Quantity, int]:
    """How crossover forces rise along a line, and the steps against it that are clear of their intervals.

    Those with two peaks at every force are below all others and of no order among themselves.
    """
    rest = [one for one in line if one.kind != BELOW]
    steps = [after.per(before) for before, after in pairwise(line) if after.comparable(before)]
    return trend(rest if len(rest) > 1 else line), sum(step.high < 1.0 for step in steps)


def rises_with_friction(data: Data) -> Numbers:  # D3a
    for line in _lines(data.get(GROUP, "crossovers")).values():
        if len(line) > 1:
            yield line[0].case(), *_order([_crossover(data, slab) for slab in line])


def falls_with_disorder(data: Data) -> Numbers:  # D3b
    slabs = _slabs(data.get(GROUP, "crossovers"))
    deltas = sorted({slab.polydispersity for slab in slabs}, reverse=True)
    for start, mu in product((USUAL, LITERAL), sorted({slab.friction for slab in slabs})):
        wanted = [Slab(delta, start, mu) for delta in deltas]
        if set(wanted) <= set(slabs):
            line = [_crossover(data, slab) for slab in wanted]
            if any(after.comparable(before) for before, after in pairwise(line)) or start == LITERAL:
                yield f"friction {mu:g}, {_title(start)}", *_order(line)


def gradual(data: Data) -> Numbers:  # D4
    for slab, (case, single, crossover) in _cases(data, "shapes", "realizations", "crossovers", width=WIDE):
        if slab.friction == 1.0 and int(crossover["kind"]) == FOUND:
            dips, leans = (single[name].transpose("realization", "step").values for name in ("shape", "asymmetry"))
            steps = np.fmax.reduce(np.fmax(np.abs(np.diff(dips)), np.abs(np.diff(leans))), axis=1)
            yield slab.case(of="mean"), _with_interval(case, "largest_step")
            yield slab.case(of="median realization"), over_realizations(steps)


def five_enough(data: Data) -> Numbers:
    """D5, a statement on samples of five: it must hold in most of them, wherever the mean of all has a crossover.

    Where it has none up to the largest force, samples may have one beyond it.
    """
    for slab, (case,) in _cases(data, "crossovers", width=WIDE):
        seen = replace(_with_interval(case, "seen"), method="samples of five, bootstrap")
        if int(case["kind"]) != BELOW:
            yield slab.case(of=f"{slab.friction:g}"), replace(seen, high=1.0) if int(case["kind"]) == ABOVE else seen


def below_lattice(data: Data) -> Numbers:  # D6
    for slab in _slabs(data.get(GROUP, "crossovers")):
        found, lattice = (_crossover(data, one) for one in (slab, Slab(0.0, USUAL, slab.friction)))
        if found.comparable(lattice):
            yield slab.case(of=f"{slab.friction:g}"), found.per(lattice)


def preparation(data: Data) -> Numbers:  # D8
    for mu in (0.0, 0.2):
        usual, literal = (_crossover(data, Slab(0.01, start, mu)) for start in (USUAL, LITERAL))
        yield f"friction {mu:g}", literal.per(usual)


def like_the_lattice(data: Data) -> Numbers:
    """D13. One peak under the smallest force, two under larger ones, at the frictions at which the lattice has both."""
    study = data.get(GROUP, "crossovers")
    both = {one.friction for one in _slabs(study, disordered=False) if _crossover(data, one).kind == FOUND}
    for slab in _slabs(study):
        if slab.friction in both:
            found = _crossover(data, slab).found
            smallest, largest = slab.of(study)["limits"].values[-1].tolist()
            case = slab.case(slab.title, f"{slab.friction:g}")
            yield case, (found, Bound(smallest, strict=True)), (found, Bound(most=largest))


def without_contacts(data: Data) -> Numbers:  # D18
    for slab, (case,) in _cases(data, "shapes", width=NARROW):
        if slab.friction == 0.0:
            yield slab.case(), _with_interval(case.isel(step=0), "shape")


#: What is counted as contacts of a disk.
COUNTED = {"contacts of disks": "", "walls counted": "_with_walls", "away from the boundaries": "_bulk"}


def coordination(data: Data, per: float = 1.0) -> Numbers:  # D7a, D14
    for (slab, (case,)), (name, kind) in product(_by_start(data.get(GROUP, "packings"), 0.0), COUNTED.items()):
        yield slab.case(name), over_realizations(case[f"coordination_number{kind}"].values / per, np.mean)


def missing_horizontal(data: Data) -> Numbers:
    """D7b, of the contacts of the ideal lattice, in which every disk touches its neighbours."""
    packing = SlabPacking().build()
    i, j = packing.neighbour_pairs().T  # type: ignore[union-attr]
    level = packing.row[i] == packing.row[j]
    ideal = {"horizontal": level.sum() / packing.n, "oblique": (~level).sum() / packing.n}
    for slab, (case,) in _by_start(data.get(GROUP, "packings"), 0.0):
        missing = {name: number - case[f"{name}_contacts"].values for name, number in ideal.items()}
        yield slab.case(""), over_realizations(missing["horizontal"] / sum(missing.values()), np.mean)


def resembles(data: Data) -> Numbers:
    """D9, at forces that are known to be away from the crossover of their case.

    A force inside the interval of its crossover is not known to be away from it; a bound has forces on one side alone.
    """
    near = 1.0 + data.words["similar"]
    typical: dict[str, list[float]] = {}
    for slab, (single, shapes, crossover) in _cases(data, "realizations", "shapes", "crossovers", width=WIDE):
        force, value, kind = shapes["applied_force"], float(crossover["force"]), int(crossover["kind"])
        low, high = crossover["interval"].values[[0, -1]]
        off = single["difference"].median("realization")
        away = {
            "below": (force < min(low, value / near)) & (kind != BELOW),
            "above": (force > max(high, value * near)) & (kind != ABOVE),
        }
        for side, there in away.items():
            if slab.start in (USUAL, LITERAL):
                name = f"{side} the crossover, {_title(slab.start)}"
                typical.setdefault(name, []).extend(off[there & np.isfinite(off)].values)
    for name, values in typical.items():
        if len(values) > 2:
            yield name, replace(over_realizations(values), method="bootstrap of the median over cases and forces")


def _at_15(data: Data, name: str) -> Iterator[tuple[Slab, list[xr.Dataset]]]:
    """By start: delta = 0.01 under 15 mg at friction 0 and at 0.2, w = 3."""
    study = at(data.get(GROUP, name), width=NARROW).assign(applied=data.get(GROUP, "shapes")["applied_force"])
    for slab, cases in _by_start(study, 0.0, 0.2):
        yield slab, [one.isel(step=int(np.flatnonzero(np.isclose(one["applied"].values, 15.0))[0])) for one in cases]


def fluctuations(data: Data) -> Numbers:  # D10
    for slab, (without, full) in _at_15(data, "shapes"):
        yield slab.case(""), _with_interval(without, "spread").per(_with_interval(full, "spread"))


def evident_samples(without: FloatArray, full: FloatArray, least: float) -> Quantity:
    """The part of samples of ``SHOWN`` realizations each in which at least this part of the pairs differ.

    ``without`` and ``full`` (r,) are the dips of realizations. With 95 % of the draws of these.
    """
    rng = np.random.default_rng(0)

    def part(ours: FloatArray, theirs: FloatArray, samples: int = 200) -> float:
        first, second = (rng.choice(of, (samples, SHOWN)) for of in (ours, theirs))
        return float(((first[:, :, None] > second[:, None]).mean(axis=(1, 2)) >= least).mean())

    drawn = [part(rng.choice(without, without.size), rng.choice(full, full.size)) for _ in range(200)]
    return of_draws(part(without, full, 20000), drawn, f"samples of {SHOWN}, bootstrap", min(without.size, full.size))


def evident(data: Data) -> Numbers:  # D11
    least = 1.0 - data.words["holds"]
    for slab, cases in _at_15(data, "realizations"):
        without, full = (case["shape"].values[np.isfinite(case["shape"].values)] for case in cases)
        yield slab.case("", f"{least:.0%}"), evident_samples(without, full, least)


def collapses(data: Data, **of: float) -> Numbers:
    """D12, D16: the part of the packings that collapse along their load paths, of all cases or of one of them."""
    for slab, (one,) in _cases(data, "realizations"):
        if of.items() <= slab._asdict().items():
            hits = np.isfinite(one["collapse_force"].values[: int(one["realizations"])])
            yield slab.case(slab.title), part_of(hits)


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
    """The median force at which realizations (r, 2) leave their linear range; a lattice has one, without scatter."""
    each = [Quantity(0.5 * (low + high), low, high) for low, high in ends.tolist()]
    return over_brackets(each, partial(np.quantile, q=0.5, method="inverted_cdf"))


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


def shorter_range(data: Data) -> Numbers:  # D2
    study = data.get(GROUP, "linear_range")
    for slab, tolerance in product(_slabs(study), TOLERANCES):
        if np.isclose(slab.polydispersity, 0.01):
            lattice = slab._replace(polydispersity=0.0, start=USUAL)
            ends, whole = (linear_ends(one.of(study), tolerance) for one in (slab, lattice))
            yield slab.case(f"friction {slab.friction:g}", f"{tolerance:.0%}"), shorter(ends, whole[0])


def shorter_with_disorder(data: Data) -> Numbers:
    """A5, by the response as a whole, since that at x = 0 is near zero without friction."""
    study = data.get(GROUP, "linear_range")
    lines = _lines(study)
    for start in (USUAL, LITERAL):
        deltas = [delta for delta, one in lines if one == start]
        for slab, tolerance in product(lines[deltas[-1], start] if deltas else (), TOLERANCES):
            mu = slab.friction
            cases = [Slab(0.0, USUAL, mu), *(Slab(delta, start, mu) for delta in deltas)]
            ends = [linear_ends(one.of(study), tolerance, PROFILE) for one in cases]
            lattice, least = (linear_end(one) for one in ends[:2])
            case = Case(f"friction {mu:g}, {tolerance:.0%} off, {_title(start)}", f"{deltas[0]:g}")
            yield case, lattice.per(least), order_of(ends[1:]) if len(deltas) > 1 else None
