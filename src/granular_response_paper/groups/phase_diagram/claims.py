"""Claims on disordered slabs (abstract, Secs. VI to VIII), by the survey's one definition of two peaks.

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
from granular_response_paper.claims.words import TOLERANCES
from granular_response_paper.survey.crossover import ABOVE, BELOW, FOUND, counted

GROUP = "phase_diagram"

#: The initial lattice of this project, and the literal one.
USUAL, LITERAL = "touching-largest", "2.0"

#: Width of smoothing of Figs. 21 and 22, and of Figs. 19 and 20; realizations in each panel of Fig. 19.
WIDE, NARROW, SHOWN = 6.0, 3.0, 15

#: A case by its disorder and its friction.
WHOLE = "polydispersity {0:g}, friction {1:g}"

#: How intervals over realizations are made.
BOOTSTRAP = "bootstrap of realizations"


class Slab(NamedTuple):
    """What a case is: its polydispersity, its initial lattice and its friction."""

    polydispersity: float
    start: str
    friction: float

    def of(self, data: Data, name: str, **labels: float) -> xr.Dataset:
        """The case in a dataset. Raises NotMeasured if there is none."""
        study, (delta, start, mu) = data.get(GROUP, name), self
        return at(study, polydispersity=delta, friction=mu, lattice_constant=start, **labels)

    @property
    def lattice(self) -> Slab:
        """The one without disorder."""
        return Slab(0.0, USUAL, self.friction)

    @property
    def title(self) -> str:
        return "largest disks touch at first" if self.start == USUAL else f"lattice constant {self.start}"

    def case(self, name: str = "polydispersity {0:g}", of: str = "") -> Case:
        """A value of what the text leaves open, or another preparation if the lattice is wider than it need be."""
        title = ", ".join(filter(None, (name.format(self.polydispersity, self.friction), self.title)))
        wider = self.start != USUAL and float(self.start) > touching_largest(self.polydispersity)
        return Case("" if wider else title, of, title if wider else "")


def _slabs(data: Data, name: str = "crossovers") -> list[Slab]:
    """Every case of disorder: by start this project's first, then by their constants."""
    columns = (data.get(GROUP, name)[key].values.tolist() for key in ("polydispersity", "lattice_constant", "friction"))
    slabs = sorted(map(Slab, *columns), key=lambda slab: (slab.polydispersity, slab.start != USUAL, *slab[1:]))
    return [slab for slab in slabs if slab.polydispersity > 0.0]


def _by_start(data: Data, name: str, *frictions: float) -> Iterator[list[Slab]]:
    """Those of delta = 0.01 with these frictions, for each start that has them."""
    slabs = _slabs(data, name)
    for start in dict.fromkeys(slab.start for slab in slabs):
        wanted = [Slab(0.01, start, mu) for mu in frictions]
        if set(wanted) <= set(slabs):
            yield wanted


def _with_interval(case: xr.Dataset, name: str, method: str = BOOTSTRAP) -> Quantity:
    """A number of a case with 95 % of its draws."""
    low, high = case[f"{name}_interval"].values[[0, -1]].tolist()
    return Quantity(float(case[name]), low, high, "confidence", method, int(case["realizations"]))


def two_peaks_or_one(data: Data) -> Numbers:
    """D1. The paper shows one mean of each friction, so that what is asked is only that such ones are not rare."""
    for slabs in _by_start(data, "starts", 0.0, 0.2):
        tails = (
            slab.of(data, "starts", width=NARROW, level=level) for slab, level in zip(slabs, LEVELS[::-1], strict=True)
        )
        method = f"quantile of means of {SHOWN}, bootstrap"
        yield slabs[0].case(""), *(_with_interval(tail, "dip_of_means", method) for tail in tails)


@dataclass(frozen=True)
class Crossover:
    """The crossover force of a case, and the interval in which it lies in each draw of the bootstrap: ends (2, d)."""

    found: Quantity
    kind: int
    draws: FloatArray

    def comparable(self, other: Crossover) -> bool:
        """Whether their order can be seen: not of two bounds to the same side."""
        return self.kind == FOUND or self.kind != other.kind

    def per(self, other: Crossover) -> Quantity:
        """The ratio. Cases of as many realizations were drawn alike; what a bound leaves open widens the interval."""
        with np.errstate(divide="ignore"):
            draws = self.draws / other.draws[::-1]
        ratio = self.found.per(other.found)
        return of_draws(ratio.value, draws, BOOTSTRAP, ratio.samples, "inverted_cdf")


def crossover(data: Data, slab: Slab) -> Crossover:
    """By the mean of the realizations; by the median one where packings collapse, so that the mean hangs on a few.

    A dip counts from the threshold of "visible" on. The interval is open to one side where the force is a bound.
    """
    case, visible = slab.of(data, "medians", width=WIDE), data.words["visible"]
    if not case["collapsed"]:
        case = slab.of(data, "crossovers", width=WIDE)
        if not np.isclose(case.attrs.get("tolerance", visible), visible):
            case = slab.of(data, "definitions", width=WIDE, tolerance=visible)
    force, kind = float(case["force"]), int(case["kind"])
    low, high = case["interval"].values[[0, -1]].tolist()
    needs(not np.isnan([force, low, high]).any(), "crossovers holds a case without number")
    # at no force two peaks, or at all: what was looked at ends there
    low = 0.0 if kind == BELOW else min(max(low, 0.0), force)
    high = max(high, force) if kind == BELOW else high
    smallest, largest = case["limits"].values
    draws = case["draws"].values.astype(float)  # beyond these limits -inf or inf
    found = Quantity(force, low, high, "confidence", BOOTSTRAP, int(case["realizations"]))
    return Crossover(found, kind, np.stack([np.clip(draws, 0.0, largest), np.maximum(draws, smallest)]))


def trend(line: Sequence[Crossover]) -> Quantity:
    """Kendall's tau of the order of crossover forces, with 95 % of the draws: 1 if all pairs rise, -1 if all fall.

    Pairs whose order a draw leaves open, such as two bounds to the same side, widen the interval. Cases of as many
    realizations were drawn alike.
    """
    pairs = list(combinations((one.draws for one in line), 2))
    up = np.mean([after[0] > before[1] for before, after in pairs], axis=0)
    down = np.mean([after[1] < before[0] for before, after in pairs], axis=0)
    samples, ends = max(one.found.samples for one in line), (2.0 * up - 1.0, 1.0 - 2.0 * down)
    return of_draws(np.median(up - down), ends, "Kendall's tau of the draws", samples, "inverted_cdf")


def _order(line: Sequence[Crossover]) -> tuple[Quantity, int]:
    """How crossover forces rise along a line, and the steps against it that are clear of their intervals.

    Those with two peaks at every force are below all others and of no order among themselves.
    """
    rest = [one for one in line if one.kind != BELOW]
    steps = [after.per(before) for before, after in pairwise(line) if after.comparable(before)]
    return trend(rest if len(rest) > 1 else line), sum(step.high < 1.0 for step in steps)


def rises_with_friction(data: Data) -> Numbers:  # D3a
    for _, line in groupby(_slabs(data), key=lambda slab: slab[:2]):
        slabs = list(line)  # with growing friction
        if len(slabs) > 1:
            yield slabs[0].case(), *_order([crossover(data, slab) for slab in slabs])


def falls_with_disorder(data: Data) -> Numbers:  # D3b
    slabs = _slabs(data)
    deltas = sorted({slab.polydispersity for slab in slabs}, reverse=True)
    for start, mu in product((USUAL, LITERAL), sorted({slab.friction for slab in slabs})):
        wanted = [Slab(delta, start, mu) for delta in deltas]
        if set(wanted) <= set(slabs):
            line = [crossover(data, slab) for slab in wanted]
            if any(after.comparable(before) for before, after in pairwise(line)) or start == LITERAL:
                yield f"friction {mu:g}, {wanted[0].title}", *_order(line)


def gradual(data: Data) -> Numbers:  # D4
    for slab in _slabs(data):
        if slab.friction == 1.0 and slab.of(data, "crossovers", width=WIDE)["kind"] == FOUND:
            single = slab.of(data, "realizations", width=WIDE)[["shape", "asymmetry"]]
            yield slab.case(of="mean"), _with_interval(slab.of(data, "shapes", width=WIDE), "largest_step")
            steps = abs(single.diff("step")).to_array().max(["variable", "step"])
            yield slab.case(of="median realization"), over_realizations(steps)


def five_enough(data: Data) -> Numbers:
    """D5, a statement on samples of five: it must hold in most of them, wherever the mean of all has a crossover.

    Where it has none up to the largest force, samples may have one beyond it.
    """
    for slab in _slabs(data):
        case = slab.of(data, "crossovers", width=WIDE)
        seen = _with_interval(case, "seen", "samples of five, bootstrap")
        if case["kind"] != BELOW:
            yield slab.case(of=f"{slab.friction:g}"), replace(seen, high=1.0) if case["kind"] == ABOVE else seen


def below_lattice(data: Data) -> Numbers:  # D6
    for slab in _slabs(data):
        found, lattice = (crossover(data, one) for one in (slab, slab.lattice))
        if found.comparable(lattice):
            yield slab.case(of=f"{slab.friction:g}"), found.per(lattice)


def preparation(data: Data) -> Numbers:  # D8
    for mu in (0.0, 0.2):
        usual, literal = (crossover(data, Slab(0.01, start, mu)) for start in (USUAL, LITERAL))
        yield f"friction {mu:g}", literal.per(usual)


def like_the_lattice(data: Data) -> Numbers:
    """D13. One peak under the smallest force, two under larger ones, at the frictions at which the lattice has both."""
    for slab in _slabs(data):
        if crossover(data, slab.lattice).kind == FOUND:
            found = crossover(data, slab).found
            smallest, largest = slab.of(data, "crossovers", width=WIDE)["limits"].values
            case = slab.case(WHOLE, f"{slab.friction:g}")
            yield case, (found, Bound(smallest, strict=True)), (found, Bound(most=largest))


def without_contacts(data: Data) -> Numbers:  # D18
    for slab in _slabs(data, "shapes"):
        if slab.friction == 0.0:
            yield slab.case(), _with_interval(slab.of(data, "shapes", width=NARROW).isel(step=0), "shape")


#: What is counted as contacts of a disk.
COUNTED = {"contacts of disks": "", "walls counted": "_with_walls", "away from the boundaries": "_bulk"}


def coordination(data: Data, per: float = 1.0) -> Numbers:  # D7a, D14
    for (slab,), (name, kind) in product(_by_start(data, "packings", 0.0), COUNTED.items()):
        contacts = slab.of(data, "packings")[f"coordination_number{kind}"]
        yield slab.case(name), over_realizations(contacts / per, np.mean)


def missing_horizontal(data: Data) -> Numbers:
    """D7b, of the contacts of the ideal lattice, in which every disk touches its neighbours."""
    packing = SlabPacking().build()
    i, j = packing.neighbour_pairs().T  # type: ignore[union-attr]
    level = packing.row[i] == packing.row[j]
    ideal = {"horizontal": level.sum() / packing.n, "oblique": (~level).sum() / packing.n}
    for (slab,) in _by_start(data, "packings", 0.0):
        case = slab.of(data, "packings")
        missing = {name: number - case[f"{name}_contacts"] for name, number in ideal.items()}
        yield slab.case(""), over_realizations(missing["horizontal"] / sum(missing.values()), np.mean)


def resembles(data: Data) -> Numbers:
    """D9, at forces that are known to be away from the crossover of their case.

    A force inside the interval of its crossover is not known to be away from it; a bound has forces on one side alone.
    """
    near = 1.0 + data.words["similar"]
    for start in (USUAL, LITERAL):
        typical: dict[str, list[float]] = {"below": [], "above": []}
        slabs = [slab for slab in _slabs(data) if slab.start == start]
        for slab in slabs:
            single, shapes, case = (slab.of(data, n, width=WIDE) for n in ("realizations", "shapes", "crossovers"))
            off = single["difference"].median("realization")
            force = shapes["applied_force"].where(np.isfinite(off))
            low, high = case["interval"].values[[0, -1]]
            below = (force < min(low, case["force"] / near)) & (case["kind"] != BELOW)
            above = (force > max(high, case["force"] * near)) & (case["kind"] != ABOVE)
            typical["below"] += off.values[below].tolist()
            typical["above"] += off.values[above].tolist()
        for side, values in typical.items():
            if len(values) > 2:
                found = replace(over_realizations(values), method="bootstrap of the median over cases and forces")
                yield f"{side} the crossover, {slabs[0].title}", found


def _at_15(data: Data, slab: Slab, name: str) -> xr.Dataset:
    """Under 15 mg, with w = 3."""
    here = np.isclose(slab.of(data, "shapes")["applied_force"].values, 15.0)
    return slab.of(data, name, width=NARROW).isel(step=np.flatnonzero(here)[0])


def fluctuations(data: Data) -> Numbers:  # D10
    for slabs in _by_start(data, "shapes", 0.0, 0.2):
        without, full = (_with_interval(_at_15(data, slab, "shapes"), "spread") for slab in slabs)
        yield slabs[0].case(""), without.per(full)


def _evident_samples(without: FloatArray, full: FloatArray, least: float) -> Quantity:
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
    for slabs in _by_start(data, "realizations", 0.0, 0.2):
        without, full = (_at_15(data, slab, "realizations")["shape"].dropna("realization").values for slab in slabs)
        yield slabs[0].case("", f"{least:.0%}"), _evident_samples(without, full, least)


def collapses(data: Data, **of: float) -> Numbers:
    """D12, D16: the part of the packings that collapse along their load paths, of all cases or of one of them."""
    for slab in _slabs(data, "realizations"):
        if of.items() <= slab._asdict().items():
            one = slab.of(data, "realizations")
            yield slab.case(WHOLE), part_of(np.isfinite(one["collapse_force"].values[: int(one["realizations"])]))


def linear_ends(force: FloatArray, changes: FloatArray, tolerance: float) -> FloatArray:
    """(r, 2) the forces between which realizations leave their linear range, by how far off (r, k) they are.

    Both ends are the same where the change passes the tolerance between two forces (k,): it is taken as linear in the
    logarithm of the force. A path that ends inside its linear range is censored: the ends are its last force and inf.
    Realizations without two forces are left out.
    """
    found = []
    for change in changes:
        known, k = np.isfinite(change), int(np.argmax(change > tolerance))  # 0 where it never is
        if k:
            part = (tolerance - change[k - 1]) / (change[k] - change[k - 1])
            found.append((force[k - 1] * (force[k] / force[k - 1]) ** part,) * 2)
        elif known.sum() > 1:
            found.append((force[known][-1], np.inf))
    return np.array(found).reshape(-1, 2)


def _ends(data: Data, slab: Slab, tolerance: float, whole: bool) -> FloatArray:
    """By the response at x = 0, or the ``whole`` response, beside those to the smallest force."""
    path = slab.of(data, "linear_range").transpose("realization", "step")
    value = path["response_at_centre"].values
    off = path["profile_change"].values if whole else np.abs(value / value[:, :1] - 1.0)
    return linear_ends(path["applied_force"].values, off, tolerance)


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
        least, most = np.sign(after[:, None] - before[:, ::-1]).transpose(2, 0, 1)
        number, value = number + least.size, value + float((least > 0.0).sum() - (most < 0.0).sum())
        low += np.einsum("da,ab,db->d", counts[second], least, counts[first])
        high += np.einsum("da,ab,db->d", counts[second], most, counts[first])
    samples = sum(map(len, groups))
    return of_draws(value / number, (low / number, high / number), "Jonckheere's statistic, bootstrap", samples)


def shorter_range(data: Data) -> Numbers:  # D2
    for slab, tolerance in product(_slabs(data, "linear_range"), TOLERANCES):
        if np.isclose(slab.polydispersity, 0.01):
            ends, lattice = (_ends(data, one, tolerance, whole=False) for one in (slab, slab.lattice))
            yield slab.case("friction {1:g}", f"{tolerance:.0%}"), shorter(ends, lattice[0])


def shorter_with_disorder(data: Data) -> Numbers:
    """A5, by the response as a whole, since that at x = 0 is near zero without friction."""
    for start in (USUAL, LITERAL):
        slabs = [slab for slab in _slabs(data, "linear_range") if slab.start == start]
        deltas = sorted({slab.polydispersity for slab in slabs})
        most = [slab for slab in slabs if slab.polydispersity == deltas[-1]]
        for slab, tolerance in product(most, TOLERANCES):
            cases = [slab.lattice, *(slab._replace(polydispersity=delta) for delta in deltas)]
            ends = [_ends(data, one, tolerance, whole=True) for one in cases]
            lattice, least = (linear_end(one) for one in ends[:2])
            case = Case(f"friction {slab.friction:g}, {tolerance:.0%} off, {slab.title}", f"{deltas[0]:g}")
            yield case, lattice.per(least), order_of(ends[1:]) if len(deltas) > 1 else None
