"""Claims on disordered slabs (abstract, Secs. VI to VIII), by the survey's one definition of two peaks.

The text starts from a lattice with twice the mean radius as its constant, in which disks of unequal size overlap.
Packings from it have more contacts than the paper prints (claim D7a), and those of a start in which the largest disks
touch have its number. That start is primary in every claim here; the literal one and those between and beyond are
others.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, pairwise, product
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from granular_response.scene.lattice import SlabPacking
from granular_response.state import FloatArray

from ...claims.bootstrap import LEVELS, of_draws, over_brackets, over_realizations, part_of
from ...claims.bounds import TOLERANCES, Limits, at_least, at_most, less_than, more_than, rare
from ...claims.claim import OF_THE_TEXT, Ask, Case, Claims, Data, Numbers, at
from ...claims.numbers import Quantity, needs
from ...survey.crossover import ABOVE, BELOW, FOUND, counted

GROUP = "phase_diagram"
claim = Claims(GROUP, {"widths": [3.0, 6.0], "linear_width": 3.0, "numbers": [5, 15]}, disorder=True)

#: The initial lattice of this project, and the literal one.
USUAL, LITERAL = "touching-largest", "2.0"

#: Width of smoothing of Figs. 21 and 22, and of Figs. 19 and 20; realizations in each panel of Fig. 19.
WIDE, NARROW, SHOWN = 6.0, 3.0, 15

#: A case by its disorder and its friction.
WHOLE = "polydispersity {0:g}, friction {1:g}"

#: How intervals over realizations are made.
BOOTSTRAP = "bootstrap of realizations"


class Slab(NamedTuple):
    """What a case is: its polydispersity, its initial lattice, how gravity grows ("": it acts at once), its friction.

    The ramp of gravity is its duration in sqrt(R/g).
    """

    polydispersity: float
    start: str
    ramp: str
    friction: float

    def of(self, data: Data, name: str, **labels: float) -> xr.Dataset:
        """The case in a dataset. Raises NotMeasured if there is none."""
        own: dict[str, Any] = {"lattice_constant": self.start, "gravity_ramp": self.ramp, "friction": self.friction}
        return at(data.get(GROUP, name), polydispersity=self.polydispersity, **own, **labels)

    @property
    def lattice(self) -> Slab:
        """The one without disorder."""
        return self._replace(polydispersity=0.0, start=USUAL)

    def case(self, name: str = "polydispersity {0:g}", further: str = "") -> Case:
        """Its name, with its initial lattice and its gravity if they are not the usual ones."""
        title = "" if self.start == USUAL else f"lattice constant {self.start}"
        title += f", {OF_THE_TEXT}" if self.start == LITERAL else ""
        gravity = f"gravity ramped over {self.ramp} sqrt(R/g)" if self.ramp else ""
        parts = (name.format(self.polydispersity, self.friction), further, title, gravity)
        return Case(", ".join(filter(None, parts)), "gravity" if gravity else "lattice" if title else "")


def _slabs(data: Data, name: str = "crossovers") -> list[Slab]:
    """Every case of disorder: by start this project's first, then by their constants, and by ramp."""
    keys = ("polydispersity", "lattice_constant", "gravity_ramp", "friction")
    columns = (data.get(GROUP, name)[key].values.tolist() for key in keys)
    slabs = sorted(map(Slab, *columns), key=lambda slab: (slab.polydispersity, slab.start != USUAL, *slab[1:]))
    return [slab for slab in slabs if slab.polydispersity > 0.0]


def _by_start(data: Data, name: str, *frictions: float) -> Iterator[list[Slab]]:
    """Those of delta = 0.01 with these frictions, for each start that has them."""
    slabs = _slabs(data, name)
    for start, ramp in dict.fromkeys(slab[1:3] for slab in slabs):
        wanted = [Slab(0.01, start, ramp, mu) for mu in frictions]
        if set(wanted) <= set(slabs):
            yield wanted


def _alike(slabs: Sequence[Slab], *names: str) -> list[list[Slab]]:
    """Cases with the same values of these, in the order of the first of each."""
    found: dict[tuple[Any, ...], list[Slab]] = {}
    for slab in slabs:
        found.setdefault(tuple(getattr(slab, name) for name in names), []).append(slab)
    return list(found.values())


def _with_interval(case: xr.Dataset, name: str, method: str = BOOTSTRAP) -> Quantity:
    """A number of a case with 95 % of its draws."""
    low, high = case[f"{name}_interval"].values[[0, -1]].tolist()
    return Quantity(float(case[name]), low, high, "confidence", method, int(case["realizations"]))


@claim("D1", "VI, Fig. 19", Ask("dip at friction 0, 97.5 % quantile of means of 15 packings", at_least("marked"), "%"),
       Ask("dip at friction 0.2, 2.5 % quantile of means of 15 packings", at_most("visible"), "%"),
       finds="any")  # fmt: skip
def two_peaks_or_one(data: Data) -> Numbers:
    """As in the ordered case, the response is very different: there are two very distinct peaks in the frictionless
    case, but one peak in the frictional case.
    Short: Two distinct peaks without friction, one at friction 0.2
    Here: Of forty means of 15 packings the deepest dips by {0} of its peak without friction, the flattest by {1} at
    friction 0.2 (below 0: one peak). From the initial lattice of Fig. 19 these are {lattice constant
    2.0075|0} and {lattice constant 2.0075|1}.
    Remark: The paper shows one mean of each, so that what is asked is only that such ones are not rare. A dip beyond
    100 % has a negative response in the middle, one below 0 a single peak. 15 mg, w = 3"""
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


def crossover(data: Data, slab: Slab, statistic: str = "crossovers") -> Crossover:
    """By the mean of the realizations, as in Fig. 22; ``medians`` by the median one, which survives collapsed packings.

    A dip counts from the threshold of "visible" on. The interval is open to one side where the force is a bound.
    """
    case, visible = slab.of(data, statistic, width=WIDE), data.words["visible"]
    if statistic == "crossovers" and not np.isclose(data.get(GROUP, "crossovers").attrs["tolerance"], visible):
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


def _lines(data: Data, slabs: Sequence[Slab], name: str) -> Numbers:
    """How crossover forces rise along a line of cases, and how many steps against it are clear of their intervals.

    By the mean, and by the median packings. Cases with two peaks at every force are below all others and of no order
    among themselves.
    """
    for statistic, further in (("crossovers", ""), ("medians", "median packings")) if len(slabs) > 1 else ():
        line = [crossover(data, slab, statistic) for slab in slabs]
        steps = [after.per(before) for before, after in pairwise(line) if after.comparable(before)]
        rest = [one for one in line if one.kind != BELOW]
        against = sum(step.high < 1.0 for step in steps)
        yield slabs[0].case(name, further), trend(rest if len(rest) > 1 else line), against


ORDER = (
    Ask("trend of the crossover force (Kendall's tau)", more_than(0.0, "visible")),
    Ask("steps against it, clear of their intervals", at_most(0.0), "count"),
)


@claim("D3a", "VI.A, Figs. 21, 22", *ORDER, primary="polydispersity 0.01")
def rises_with_friction(data: Data) -> Numbers:
    """The larger the coefficient of friction, the larger the applied force at which the crossover from a single peaked
    to a double peaked response occurs, much like in ordered systems (Sec. V A.
    Short: The crossover force grows with friction in disorder too
    Here: At polydispersity 0.01 Kendall's τ of the crossover force with friction is {0} (1: it always rises); at 0.1 it
    is {polydispersity 0.1|0} and at 0.25 {polydispersity 0.25|0}.
    Remark: Crossovers are those of means over packings, as in Fig. 22. Where packings collapse they hang on a few"""
    for line in _alike(_slabs(data), "polydispersity", "start", "ramp"):
        yield from _lines(data, line, "polydispersity {0:g}")  # with growing friction


@claim("D3b", "VI.A, Figs. 21, 22", *ORDER, primary="friction 0.2")
def falls_with_disorder(data: Data) -> Numbers:
    """As mentioned above, the crossover force decreases with increasing polydispersity, or disorder.
    Short: The crossover force decreases with polydispersity
    Here: At friction 0.2 Kendall's τ of the crossover force towards less disorder is {0} (1: it always rises), at 0.05
    {friction 0.05|0} and at 0.5 {friction 0.5|0}.
    Remark: From polydispersity 0.25 to 0.01, by means over packings. Without friction disorder has two peaks at every
    force, so that there is no order"""
    for line in _alike(_slabs(data), "start", "ramp", "friction"):
        found = [crossover(data, slab) for slab in line]
        if any(one.comparable(other) for one, other in pairwise(found)):
            yield from _lines(data, line[::-1], "friction {1:g}")  # towards less disorder


@claim("D4", "VI.A", Ask("largest change of the dip or the asymmetry between neighbouring forces per largest response",
           at_most("gradual"), "%"), primary="polydispersity 0.1", figures=[21])  # fmt: skip
def gradual(data: Data) -> Numbers:
    """For polydisperse systems we observed a rather gradual crossover even for µ = 1, unlike the sharp transition to a
    highly asymmetric response in lattice configurations [Sec. V E].
    Short: In disorder the crossover is gradual even at friction 1
    Here: At friction 1 and polydispersity 0.1 the mean response changes between neighbouring forces by {0} of its
    largest value, that of a typical packing by {polydispersity 0.1, median packing|0}.
    Remark: At polydispersity 0.01 no crossover is seen up to 420 mg"""
    for slab in _slabs(data):
        if slab.friction == 1.0 and slab.of(data, "crossovers", width=WIDE)["kind"] == FOUND:
            single = slab.of(data, "realizations", width=WIDE)[["shape", "asymmetry"]]
            yield slab.case(), _with_interval(slab.of(data, "shapes", width=WIDE), "largest_step")
            steps = abs(single.diff("step")).to_array().max(["variable", "step"])
            yield slab.case(further="median packing"), over_realizations(steps)


@claim("D5", "VI.A", Ask("samples of five with a crossover", at_least(0.5), "part"),
       primary="polydispersity 0.1, friction 0.2", figures=[21])  # fmt: skip
def five_enough(data: Data) -> Numbers:
    """It is quite remarkable that an average over a very small ensemble of only five realizations (with coarse
    graining) is sufficient to demonstrate the crossover from a single peak to a double peak, and even results (in some
    cases) in nearly symmetrical graphs.
    Short: Five realizations are enough to show the crossover
    Here: At polydispersity 0.1 and friction 0.2 the crossover is seen in {0} of the samples of five packings, at
    polydispersity 0.01 in {polydispersity 0.01, friction 0.2|0}.
    Remark: It must hold in most samples. Where a load path ends below the crossover, samples may have one beyond it"""
    for slab in _slabs(data):
        case = slab.of(data, "crossovers", width=WIDE)
        seen = _with_interval(case, "seen", "samples of five, bootstrap")
        if case["kind"] != BELOW:
            yield slab.case(WHOLE), replace(seen, high=1.0) if case["kind"] == ABOVE else seen


@claim("D6", "VIII, Fig. 22",
       Ask("crossover force, above the smallest and up to the largest force", more_than(0.0), "mg"),
       Ask("the same per that of the lattice with the same friction", less_than(1.0, "visible")),
       primary="polydispersity 0.01, friction 0.2")  # fmt: skip
def as_the_lattice(data: Data) -> Numbers:
    """The same behavior is observed in polydisperse systems, which is the typical case in nature, although in
    polydisperse systems the forces at which induced anisotropy becomes large are smaller.
    Short: Disordered slabs behave as ordered ones, at smaller forces
    Here: At polydispersity 0.01 and friction 0.2 one peak turns into two at {0}, which is {1} times the force of the
    lattice. At friction 0.05 it is {polydispersity 0.01, friction 0.05|1} times.
    Remark: The lattice is treated as disorder is, smoothed with w = 6 and beside rough walls, so that its crossover
    forces are 3.4 and 37.6 mg at friction 0 and 0.2 and not the 3 and 20 mg of Figs. 3 and 16. Without friction there
    are two peaks under the smallest force already"""
    for slab in _slabs(data):
        own, lattice = (crossover(data, one) for one in (slab, slab.lattice))
        turns = per = None
        if lattice.kind == FOUND:  # within the simulated forces
            smallest, largest = slab.of(data, "crossovers", width=WIDE)["limits"].values
            turns = own.found, Limits(smallest, largest, strict=True)
        if own.comparable(lattice):
            per = own.per(lattice)
        yield slab.case(WHOLE), turns, per


@claim("D8", "VI.A",
       Ask("crossover force from the lattice constant 2 per that from touching disks", more_than(1.0, "visible")),
       primary="friction 0.2", figures=[22], row="check")  # fmt: skip
def preparation(data: Data) -> Numbers:
    """In any case, it is likely that the crossover does not depend on the polydispersity alone but also on the
    preparation method (as observed in experiments on granular piles [15] and slabs [20]).
    Short: The crossover is likely to depend on the preparation too
    Here: At friction 0.2 the crossover force from the lattice constant 2 is {friction 0.2|0} times that from touching
    largest disks.
    Remark: A sentence on what is likely could hardly fail"""
    for mu in (0.0, 0.2):
        usual, literal = (crossover(data, Slab(0.01, start, "", mu)) for start in (USUAL, LITERAL))
        yield f"friction {mu:g}", literal.per(usual)


@claim("D18", "IV.C", Ask("dip of the mean response under the smallest force", at_least("visible"), "%"),
       primary="polydispersity 0.01", modal=True)  # fmt: skip
def without_contacts(data: Data) -> Numbers:
    """However, as the stiffness increases, this requirement may be hard to comply with, as the particles must fit
    exactly between the walls in order to remain in contact: in the limit k_N → ∞ most horizontal contacts may be absent
    already in the reference state, rendering it isostatic (therefore, extremely anisotropic), and this would lead to a
    hyperbolic-like response even for an infinitesimal applied force, as suggested in, e.g., [7, 8, 9, 10, 11].
    Short: Without horizontal contacts: ray-like response to any force
    Here: Without friction the mean response to the smallest force dips by {0} of its peak at polydispersity 0.01.
    Remark: Disordered packings lack horizontal contacts; they stand for the limit of infinite stiffness. w = 3"""
    for slab in _slabs(data, "shapes"):
        if slab.friction == 0.0:
            yield slab.case(), _with_interval(slab.of(data, "shapes", width=NARROW).isel(step=0), "shape")


@claim("D19", "VII", Ask("crossover force", more_than(5.0), "mg"), primary="polydispersity 0.25, friction 1",
       figures=[22])  # fmt: skip
def sand(data: Data) -> Numbers:
    """The experiments reported in [19, 20] used disordered systems with a rather small applied force (a few times the
    particle weight), for which a single peak was observed, in agreement with the phase diagram.
    Short: Under a few weights sand has one peak, as the phase diagram
    Here: At polydispersity 0.25 and friction 1 the crossover to two peaks is at {0}, far above a few particle weights.
    Remark: A few is taken as five. Sand is taken as the largest disorder and friction of Fig. 22; the effective
    friction of sand may be larger"""
    for slab in _slabs(data):
        if slab.friction >= 0.5:
            yield slab.case(WHOLE), crossover(data, slab).found


@claim("D20", "VI.A",
       Ask("asymmetry of a typical packing under the smallest force per largest response", at_least("visible"), "%"),
       primary="polydispersity 0.1, friction 1", row="check")  # fmt: skip
def asymmetric(data: Data) -> Numbers:
    """A possible explanation may be that for a single disordered realization, the response is not symmetric even for a
    small external force.
    Short: A single realization is not symmetric even at small force
    Here: Under the smallest force the response of a typical packing of polydispersity 0.1 differs from its mirror image
    by {0} of its peak at friction 1.
    Remark: Disorder could hardly be symmetric. That this explains the gradual crossover is not tested. w = 6"""
    for slab in _slabs(data):
        if slab.friction > 0.0:
            single = slab.of(data, "realizations", width=WIDE)["asymmetry"].isel(step=0)
            yield slab.case(WHOLE), over_realizations(single)


#: What is counted as contacts of a disk.
COUNTED = {"contacts of disks": "", "walls counted": "_with_walls", "away from the boundaries": "_bulk"}


@claim("D7a", "VII", Ask("contacts per disk", more_than(4.0), paper=4.25), primary="contacts of disks", row="check")
def above_isostatic(data: Data) -> Numbers:
    """Note, however, that the mean coordination number in the frictionless polydisperse systems studied here (e.g., z ∼
    4.25 for δ = 0.01) is well above the isostatic limit of z = 4.
    Short: z ≈ 4.25 is well above the isostatic 4
    Here: At polydispersity 0.01 without friction a disk has {0} contacts with other disks, {walls counted|0} with walls
    counted and {away from the boundaries|0} away from the boundaries.
    Remark: The text does not say what is counted; its number lies within ours. From the lattice constant 2 of the text
    a disk has more contacts. Without friction no stable packing has fewer than 4, so that this could hardly fail"""
    for (slab,) in _by_start(data, "packings", 0.0):
        for name, kind in COUNTED.items():
            number = slab.of(data, "packings")[f"coordination_number{kind}"]
            yield slab.case(name), over_realizations(number, np.mean)


@claim("D7b", "VII", Ask("missing contacts per disk, of the two above the isostatic limit", at_least("marked"), "%",
           (6.0 - 4.25) / 2.0), Ask("horizontal part of the missing contacts", at_least("marked"), "part"))  # fmt: skip
def missing_horizontal(data: Data) -> Numbers:
    """It is, however, much smaller than that of the ideal triangular lattice, z = 6, the "missing" contacts being
    predominantly horizontal.
    Short: z is much smaller than 6; missing contacts are mostly horizontal
    Here: Of the two contacts per disk by which the ideal lattice exceeds the isostatic limit, {0} are missing; {1} of
    the missing contacts are horizontal.
    Remark: No stable packing without friction has fewer than 4 contacts per disk, so that much smaller is asked of what
    lies between 4 and 6"""
    packing = SlabPacking().build()
    i, j = packing.neighbour_pairs().T  # type: ignore[union-attr]
    level = packing.row[i] == packing.row[j]
    ideal = {"horizontal": level.sum() / packing.n, "oblique": (~level).sum() / packing.n}
    for (slab,) in _by_start(data, "packings", 0.0):
        case = slab.of(data, "packings")
        missing = {name: number - case[f"{name}_contacts"] for name, number in ideal.items()}
        part = (6.0 - case["coordination_number"]) / 2.0
        whole = missing["horizontal"] / sum(missing.values())
        yield slab.case(""), over_realizations(part, np.mean), over_realizations(whole, np.mean)


@claim("D9", "VI.A", Ask("difference of a typical packing from the mean below the crossover", at_most("similar"), "%"),
       Ask("above the crossover", at_most("similar"), "%"), figures=[21])  # fmt: skip
def resembles(data: Data) -> Numbers:
    """It appears that, at least when the force is not too close to its crossover value, the fluctuations within the
    ensemble are rather small for this choice of coarse graining length (see [91] for a detailed study of another set of
    simulations in the linear force regime), so that the typical response of a realization resembles that of the
    ensemble average.
    Short: Away from the crossover packings resemble their average
    Here: A typical packing differs from the mean response by {0} below the crossover and by {1} above it, in root mean
    squares.
    Remark: w = 6, at forces that are known to be away from the crossover: by half more, and outside of its interval"""
    near = 1.0 + data.words["similar"]
    by_start = sorted(_slabs(data), key=lambda slab: (slab.start != USUAL, slab.start))
    for slabs in _alike(by_start, "start", "ramp"):
        typical: dict[str, list[float]] = {"below": [], "above": []}
        for slab in slabs:
            single, shapes, case = (slab.of(data, n, width=WIDE) for n in ("realizations", "shapes", "crossovers"))
            off, force = single["difference"].median("realization").values, shapes["applied_force"].values
            (low, *_, high), at, kind = case["interval"].values, case["force"].values, case["kind"].values
            below = np.isfinite(off) & (force < min(low, at / near)) & (kind != BELOW)
            above = np.isfinite(off) & (force > max(high, at * near)) & (kind != ABOVE)
            typical["below"] += off[below].tolist()
            typical["above"] += off[above].tolist()
        found = [over_realizations(values) if len(values) > 2 else None for values in typical.values()]
        method = "bootstrap of the median over cases and forces"
        if any(found):
            yield slabs[0].case(""), *(one and replace(one, method=method) for one in found)


def _at_15(data: Data, slab: Slab, name: str) -> xr.Dataset:
    """Under 15 mg, with w = 3."""
    here = np.isclose(slab.of(data, "shapes")["applied_force"].values, 15.0)
    return slab.of(data, name, width=NARROW).isel(step=np.flatnonzero(here)[0])


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


@claim("D10", "VI, Fig. 19", Ask("standard deviation without friction per that with 0.2", more_than(1.0)),
       Ask("samples of 15 and 15 packings in which 95 % of the pairs differ", rare("holds"), "part"))  # fmt: skip
def fluctuations(data: Data) -> Numbers:
    """The fluctuations are quite large even for this small degree of polydispersity (and larger for the frictionless
    case), but for the magnitude of the applied force used in this case the difference between the frictionless and
    frictional case is quite evident even for individual realizations.
    Short: Packings scatter more without friction, yet each shows what friction does
    Here: Under 15 mg the response scatters {0} times as much from packing to packing without friction as at friction
    0.2. In {1} of the samples of 15 packings nearly every frictionless packing has a deeper dip than those at friction
    0.2.
    Remark: Quite large has no scale in the text and is not asked. The paper shows one sample, so that what is asked is
    only that such a one is not rare. w = 3"""
    least = 1.0 - data.words["holds"]
    for slabs in _by_start(data, "shapes", 0.0, 0.2):
        without, full = (_with_interval(_at_15(data, slab, "shapes"), "spread") for slab in slabs)
        first, second = (_at_15(data, one, "realizations")["shape"].dropna("realization").values for one in slabs)
        needs(first.size and second.size, "realizations holds no shapes")
        yield slabs[0].case(""), without.per(full), _evident_samples(first, second, least)


@claim("D16", "VI.A", Ask("packings that collapse", rare(), "part"), primary="polydispersity 0.25, friction 0.2",
       figures=[21], modal=True)  # fmt: skip
def collapses(data: Data) -> Numbers:
    """In addition, it may be impossible to apply very large forces to polydisperse systems without causing major
    rearrangements.
    Short: Very large forces may cause major rearrangements in disorder
    Here: At polydispersity 0.25 and friction 0.2, {0} of the packings collapse along their load path.
    Remark: The most disordered packings at the friction of Figs. 19 and 21. Other paths end at 5.8 to 420 mg, so that
    where nothing collapses larger forces were not tried. At polydispersity 0.1 and friction 0.2 paths end at 26 mg, as
    in Fig. 21(h), where nothing collapses; the paper lost two of five under a force that it does not name"""
    for slab in _slabs(data, "realizations"):
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
    ends = np.array(found).reshape(-1, 2)
    needs(not np.isnan(ends).any(), "linear_range holds no forces")
    return ends


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
    each = [Quantity.exact(low) if low == high else Quantity.bracket(low, high) for low, high in ends.tolist()]
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


@claim("D2", "VI.A, Fig. 20", Ask("packings with a shorter range", more_than(0.5), "part"),
       primary="friction 0.2, 1 % off")  # fmt: skip
def shorter_range(data: Data) -> Numbers:
    """A notable difference between monodisperse and polydisperse systems is that in the latter, the range of linear
    response is smaller (see Fig. 20 compared to Fig. 6).
    Short: The linear range is shorter in disorder
    Here: The linear range (1 % departure) is shorter than in the lattice in {0} of the packings at friction 0.2, and in
    {friction 0, 1 % off|0} without friction.
    Remark: Polydispersity 0.01, w = 3. Packings whose path ends inside their linear range may be shorter or longer
    where the lattice's range ends later"""
    for slab, tolerance in product(_slabs(data, "linear_range"), TOLERANCES):
        if np.isclose(slab.polydispersity, 0.01):
            ends, lattice = (_ends(data, one, tolerance, whole=False) for one in (slab, slab.lattice))
            yield slab.case("friction {1:g}", f"{100 * tolerance:g} % off"), shorter(ends, lattice[0])


@claim("A5", "abstract", Ask("linear range of the lattice per that at polydispersity 0.01", more_than(1.0)),
       Ask("order of the realizations from 0.01 to 0.25 (Kendall's tau)", less_than(0.0)),
       primary="friction 0.2, 1 % off", figures=[20])  # fmt: skip
def shorter_with_disorder(data: Data) -> Numbers:
    """Increasing the degree of polydispersity (for the range studied, up to 25%) decreases the range of elastic
    response.
    Short: Polydispersity decreases the elastic range
    Here: The linear range of the lattice is {0} times that at polydispersity 0.01 at friction 0.2, and {friction 0, 1 %
    off|0} times without friction. From 0.01 to 0.25 it falls at friction 0.2, where Kendall's τ is {1} (0: no
    trend); without friction τ is {friction 0, 1 % off|1}.
    Remark: Smooth walls, w = 3, by the whole response, since that at x = 0 is near zero without friction. From the
    literal lattice only polydispersity 0.01 was simulated, so that the order is not asked there"""
    for slabs in _alike(_slabs(data, "linear_range"), "start", "ramp"):
        deltas = sorted({slab.polydispersity for slab in slabs})
        most = [slab for slab in slabs if slab.polydispersity == deltas[-1]]
        for slab, tolerance in product(most, TOLERANCES):
            cases = [slab.lattice, *(slab._replace(polydispersity=delta) for delta in deltas)]
            ends = [_ends(data, one, tolerance, whole=True) for one in cases]
            lattice, least = (linear_end(one) for one in ends[:2])
            order = order_of(ends[1:]) if len(deltas) > 1 else None
            yield slab.case("friction {1:g}", f"{100 * tolerance:g} % off"), lattice.per(least), order
