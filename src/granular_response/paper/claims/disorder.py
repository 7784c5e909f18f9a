"""Claims D1 to D7 and U1 to U3: polydisperse slabs and superposition (Secs. VI and VII)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .claim import Claim, Condition, Data, Finding, NotMeasured, at

FloatArray = NDArray[np.float64]

AVERAGES = "polydisperse_averages"
PHASES = "phase_diagram"
SUPERPOSITION = "superposition"
LATTICE = "friction_linear_range"


def central_dip(x: FloatArray, response: FloatArray) -> float:
    """How far ``response`` at x = 0 is below the lower of the maxima beside it, per largest value; negative without."""
    centre = float(np.interp(0.0, x, response))
    beside = min(response[x < 0.0].max(), response[x > 0.0].max())
    return float((beside - centre) / response.max())


#: A dip that counts as two peaks, as in the other studies.
TWO_PEAKS = 1e-3


def _case(dataset: xr.Dataset, polydispersity: float, friction: float) -> xr.Dataset:
    """The first case (the usual start) with these numbers."""
    here = np.isclose(dataset["polydispersity"].values, polydispersity) & np.isclose(
        dataset["friction"].values, friction
    )
    if not here.any():
        raise NotMeasured(f"data/{AVERAGES}.nc: no case with polydispersity {polydispersity:g}, friction {friction:g}")
    return dataset.isel(case=int(np.flatnonzero(here)[0]))


def _averages(data: Data, width: float) -> xr.Dataset:
    names = ("mean", "standard_error", "mean_of_few", "count_at_rest", "force", "x", "polydispersity", "friction")
    return at(data.get(AVERAGES, "averages", *names), width=width)


def two_peaks_or_one(data: Data) -> Finding:
    study = _averages(data, 3.0)
    dips, numbers = {}, []
    for mu in (0.0, 0.2):
        case = _case(study, 0.01, mu)
        step = np.flatnonzero(np.isclose(case["force"].values, 15.0))
        if not step.size:
            raise NotMeasured(f"data/{AVERAGES}.nc: no 15 mg at polydispersity 0.01, friction {mu:g}")
        one = case.isel(step=int(step[0]))
        numbers.append(int(one["count_at_rest"]))
        if not numbers[-1]:
            raise NotMeasured(f"data/{AVERAGES}.nc: no realization at rest at 15 mg, friction {mu:g}")
        dips[mu] = central_dip(one["x"].values, one["mean"].values)
    return Finding(
        f"mean of {numbers[0]} and {numbers[1]} realizations: dip at x = 0 of {dips[0.0]:.1%} of the largest response "
        f"at friction 0, {dips[0.2]:.1%} at 0.2",
        dips[0.0],
        [
            Condition("at least 15 realizations at rest", min(numbers) >= 15, f"{min(numbers)} realizations"),
            Condition("two peaks at friction 0", dips[0.0] > TWO_PEAKS, f"dip {dips[0.0]:.1%} at friction 0"),
            Condition("one peak at friction 0.2", dips[0.2] <= TWO_PEAKS, f"dip {dips[0.2]:.1%} at friction 0.2"),
        ],
        (dips[0.2], dips[0.0]),
    )


def shorter_range(data: Data) -> Finding:
    names = ("linear_until", "nonlinear_from", "polydispersity", "friction")
    study = data.get(AVERAGES, "linear_range", *names)
    ratios = {}
    for mu in (0.0, 0.2, 1.0):
        here = np.isclose(study["polydispersity"].values, 0.01) & np.isclose(study["friction"].values, mu)
        if not here.any():
            raise NotMeasured(f"data/{AVERAGES}.nc: linear_range holds no polydispersity 0.01 with friction {mu:g}")
        path = study.isel(path=int(np.flatnonzero(here)[0]))
        lattice = data.event(LATTICE, "linear_range", mu)
        # the end is known to lie below the first force at which it is over
        ratios[mu] = float(path["nonlinear_from"]) / lattice.low
    text = ", ".join(f"{r:.2g} at friction {mu:g}" for mu, r in ratios.items())
    return Finding(
        f"linear range at most this part of that of the lattice: {text}",
        max(ratios.values()),
        [Condition(f"shorter at friction {mu:g}", r < 1.0, f"{r:.2g} at friction {mu:g}") for mu, r in ratios.items()],
        (min(ratios.values()), max(ratios.values())),
    )


#: Kinds of crossover force: found, or a bound because there are two peaks, or one, at every force.
FOUND, BELOW, ABOVE = 0, 1, 2


def _crossovers(data: Data) -> xr.Dataset:
    """Crossover forces with w = 6 on the grid of polydispersity and friction: ``force``, ``low``, ``high``, ``kind``.

    ``low`` and ``high`` hold 95 % of the bootstrap draws; a bound is open to one side. nan where there is no case.
    """
    study = at(
        data.get(PHASES, "crossovers", "force", "kind", "interval", "level", "polydispersity", "friction"), width=6.0
    )
    disorders, frictions = (np.unique(study[name].values) for name in ("polydispersity", "friction"))
    shape = (len(disorders), len(frictions))
    force, low, high, kind = (np.full(shape, np.nan) for _ in range(4))
    ends = at(study, level=0.025)["interval"].values, at(study, level=0.975)["interval"].values
    for case in range(study.sizes["case"]):
        where = (
            int(np.searchsorted(disorders, study["polydispersity"].values[case])),
            int(np.searchsorted(frictions, study["friction"].values[case])),
        )
        if np.isfinite(force[where]):  # another start of the same packing: the usual one comes first
            continue
        force[where], kind[where] = study["force"].values[case], study["kind"].values[case]
        low[where] = 0.0 if kind[where] == BELOW else force[where] if kind[where] == ABOVE else ends[0][case]
        high[where] = np.inf if kind[where] == ABOVE else force[where] if kind[where] == BELOW else ends[1][case]
    dims = ("polydispersity", "friction")
    return xr.Dataset(
        {"force": (dims, force), "low": (dims, low), "high": (dims, high), "kind": (dims, kind)},
        {"polydispersity": disorders, "friction": frictions},
    )


def _ordered(low: FloatArray, high: FloatArray, *, rising: bool) -> tuple[int, int]:
    """Neighbours along the last axis that follow the order, or miss it within their intervals; and all of them."""
    if not rising:
        low, high = low[..., ::-1], high[..., ::-1]
    before, after = low[..., :-1], high[..., 1:]
    known = ~np.isnan(before) & ~np.isnan(after)
    return int((after[known] >= before[known]).sum()), int(known.sum())


def _decided(low: FloatArray, high: FloatArray) -> int:
    """Neighbours along the last axis between which the value rises by more than the intervals."""
    return int((low[..., 1:] > high[..., :-1]).sum())


def _clear(low: FloatArray, high: FloatArray) -> bool:
    """Whether the value rises somewhere along the last axis by more than the intervals."""
    return any(bool((low[:, b] > high[:, a]).any()) for a in range(low.shape[1]) for b in range(a + 1, low.shape[1]))


def crossover_order(data: Data) -> Finding:
    study = _crossovers(data)
    disordered = study.isel(polydispersity=study["polydispersity"].values > 0.0)
    low, high, force = (disordered[name].values for name in ("low", "high", "force"))
    clear = {"friction": _clear(low, high), "polydispersity": _clear(low.T[:, ::-1], high.T[:, ::-1])}
    rises, of_frictions = _ordered(low, high, rising=True)
    falls, of_disorders = _ordered(low.T, high.T, rising=False)
    if not of_frictions or not of_disorders:
        raise NotMeasured(f"data/{PHASES}.nc: crossovers holds too few crossover forces to compare")
    return Finding(
        f"rises with friction in {rises} of {of_frictions} steps ({_decided(low, high)} of them clear of the "
        f"intervals), falls with polydispersity in {falls} of {of_disorders} "
        f"({_decided(low.T[:, ::-1], high.T[:, ::-1])} clear); {np.nanmin(force):.2g} to {np.nanmax(force):.0f} mg",
        (rises + falls) / (of_frictions + of_disorders),
        [
            Condition(
                "rises with friction, every step, within the intervals",
                rises == of_frictions,
                f"rises in {rises} of {of_frictions}",
            ),
            Condition(
                "falls with polydispersity, every step, within the intervals",
                falls == of_disorders,
                f"falls in {falls} of {of_disorders}",
            ),
            Condition(
                "a rise and a fall are somewhere clear of the intervals",
                all(clear.values()),
                ", ".join(f"{name}: {'clear' if found else 'intervals overlap'}" for name, found in clear.items()),
            ),
        ],
    )


def gradual(data: Data) -> Finding:
    study = _averages(data, 6.0)
    rough = np.isclose(study["friction"].values, 1.0) & (study["polydispersity"].values > 0.0)
    x = study["x"].values
    jumps, single = {}, []
    for case in np.flatnonzero(rough):
        one = study.isel(case=int(case))
        mean = one["mean"].values[np.isfinite(one["mean"].values).all(axis=1)]
        if len(mean) < 3:
            continue
        jumps[float(one["polydispersity"])] = _largest_change(x, mean)
        single += [_largest_change(x, responses) for responses in _smoothed(data, int(case), x, 6.0)]
    if not jumps:
        raise NotMeasured(f"data/{AVERAGES}.nc: no disordered case with friction 1 at three forces")
    largest = max(jumps.values())
    calm = sum(change < 0.5 for change in single)
    return Finding(
        "largest change between neighbouring forces, of the asymmetry of the mean or its dip at x = 0: "
        + ", ".join(f"{jump:.2f} (polydispersity {delta:g})" for delta, jump in jumps.items()),
        largest,
        [
            Condition("no change of the mean by 0.5 or more", largest < 0.5, f"change by {largest:.2f}"),
            Condition(
                "nor of any single realization",
                calm == len(single),
                f"less than 0.5 in {calm} of {len(single)}, up to {max(single, default=np.nan):.2f}",
            ),
        ],
    )


def _largest_change(x: FloatArray, responses: FloatArray) -> float:
    """Of the asymmetry or the central dip, between neighbouring rows of (forces, x)."""
    asymmetry = np.abs(responses - responses[:, ::-1]).max(axis=1) / responses.max(axis=1)
    dip = np.array([central_dip(x, response) for response in responses])
    return float(max(np.abs(np.diff(asymmetry)).max(), np.abs(np.diff(dip)).max()))


def _smoothed(data: Data, case: int, x: FloatArray, width: float) -> list[FloatArray]:
    """(forces at rest, x) responses of the realizations of a case, as their means are smoothed; at least two forces."""
    study = data.get(AVERAGES, "ensembles", "floor_response", "x").isel(case=case)
    place = study["x"].transpose("realization", "slot").values
    response = study["floor_response"].transpose("realization", "step", "slot").values
    found = []
    for at_disk, of_disk in zip(place, response, strict=True):
        here = np.isfinite(at_disk)
        if not here.any():  # it never came to rest
            continue
        rows = of_disk[:, here][np.isfinite(of_disk[:, here]).all(axis=1)]
        weight = np.exp(-(((x[:, None] - at_disk[here]) / width) ** 2)) / (width * np.sqrt(np.pi))
        if len(rows) > 1:
            found.append(rows @ weight.T)
    return found


def five_enough(data: Data) -> Finding:
    study = _averages(data, 6.0)
    x = study["x"].values
    agree, clear = 0, 0
    far = _agreement_far_from_crossover(data)
    for case in np.flatnonzero(study["polydispersity"].values > 0.0):
        one = study.isel(case=int(case))
        for step in np.flatnonzero(one["count_at_rest"].values >= 10):
            mean, few = one["mean"].values[step], one["mean_of_few"].values[step]
            error = float(np.interp(0.0, x, one["standard_error"].values[step])) / mean.max()
            dip = central_dip(x, mean)
            if abs(dip) > 3.0 * error:
                clear += 1
                agree += (dip > TWO_PEAKS) == (central_dip(x, few) > TWO_PEAKS)
    if not clear:
        raise NotMeasured(f"data/{AVERAGES}.nc: averages holds no force away from its crossover")
    share = agree / clear
    return Finding(
        f"the mean of five has as many peaks as the mean of all in {agree} of {clear} cases away from the crossover",
        share,
        [
            Condition(
                "in at least 95 % of the cases in which the dip at x = 0 is farther from 0 than 3 standard errors",
                share >= 0.95,
                f"{share:.0%}",
            ),
            Condition(
                "in at least 95 % of draws of five, at every force more than a factor 2 from the crossover force",
                bool((far >= 0.95).all()),
                f"{far.min():.0%} at the worst of {far.size} forces, {np.median(far):.0%} in their median",
            ),
        ],
    )


def _agreement_far_from_crossover(data: Data) -> FloatArray:
    """Part of the draws of five realizations with as many peaks as all, where the crossover force is known; w = 6."""
    shapes = at(data.get(PHASES, "shapes", "few_agree", "applied_force", "polydispersity"), width=6.0)
    crossover = at(data.get(PHASES, "crossovers", "force", "kind"), width=6.0)
    force = shapes["applied_force"].transpose("case", "step").values / crossover["force"].values[:, None]
    known = (crossover["kind"].values == FOUND) & (shapes["polydispersity"].values > 0.0)
    agree = shapes["few_agree"].transpose("case", "step").values
    chosen = known[:, None] & np.isfinite(agree) & (np.abs(np.log(np.maximum(force, 1e-300))) > np.log(2.0))
    if not chosen.any():
        raise NotMeasured(f"data/{PHASES}.nc: shapes holds no force away from a crossover")
    return agree[chosen]


def diagram(data: Data) -> Finding:
    study = _crossovers(data)
    kind = study["kind"].values
    found, bounds = kind == FOUND, (kind == BELOW) | (kind == ABOVE)
    barred = found & ~np.isnan(study["low"].values) & ~np.isnan(study["high"].values)
    disorders = study["polydispersity"].values
    expected = all(np.isclose(disorders, d).any() for d in (0.0, 0.01, 0.1, 0.25))
    listed = ", ".join(f"{d:g}" for d in disorders)
    return Finding(
        f"{found.sum()} crossover forces, {barred.sum()} of them with intervals, and {bounds.sum()} bounds, at "
        f"polydispersities {listed}",
        float(found.sum()),
        [
            Condition("polydispersities 0, 0.01, 0.1 and 0.25", expected, listed),
            Condition("at least two crossover forces", bool(found.sum() >= 2), f"{found.sum()}", essential=True),
            Condition(
                "an interval for every crossover force of a disordered slab",
                bool((barred | ~found)[disorders > 0.0].all()),
                f"{barred.sum()} of {found.sum()}",
            ),
        ],
    )


def coordination(data: Data) -> Finding:
    names = ("coordination_number", "coordination_number_bulk", "polydispersity", "friction")
    study = data.get(AVERAGES, "packings", *names)
    values = {}
    for delta in (0.0, 0.01):
        case = _case(study, delta, 0.0)
        values[delta] = [float(np.nanmean(case[name].values)) for name in names[:2]]
    lattice, disorder = values[0.0], values[0.01]
    return Finding(
        f"away from the boundaries {lattice[1]:.2f} in the lattice and {disorder[1]:.2f} at polydispersity 0.01; over "
        f"all disks {lattice[0]:.2f} and {disorder[0]:.2f}",
        disorder[1],
        [
            Condition("lattice: 6 within 0.1", abs(lattice[1] - 6.0) <= 0.1, f"lattice {lattice[1]:.2f}"),
            Condition(
                "polydispersity 0.01: 4.25 within 0.15",
                abs(disorder[1] - 4.25) <= 0.15,
                f"polydispersity 0.01: {disorder[1]:.2f}",
            ),
        ],
    )


def superposition(force: float, limit: float):
    def measure(data: Data) -> Finding:
        study = at(data.get(SUPERPOSITION, "errors", "floor_error_largest", "force", "distance"), force=force)
        error = study["floor_error_largest"].transpose("realization", "distance").values
        if not np.isfinite(error).any():
            raise NotMeasured(f"data/{SUPERPOSITION}.nc: errors holds no error at {force:g} mg")
        worst = np.nanmax(error, axis=1)  # over distances
        typical, within = float(np.median(worst)), int((worst <= limit).sum())
        return Finding(
            f"largest difference of whole and sum, of the largest added floor force: {typical:.1%} in the median of "
            f"{len(worst)} realizations, each at the worst of {study.sizes['distance']} distances, and "
            f"{worst.max():.1%} in the worst; at most {limit:.0%} in {within} of {len(worst)}",
            typical,
            [
                Condition(
                    f"at most {limit:.0%} in the median realization, every distance", typical <= limit, f"{typical:.1%}"
                ),
                Condition(f"at most {limit:.0%} in every realization", within == len(worst), f"{worst.max():.1%}"),
            ],
            (float(np.nanmin(error)), float(worst.max())),
        )

    return measure


def superposition_range(data: Data) -> Finding:
    study = data.get(SUPERPOSITION, "linear_range", "linear_until", "nonlinear_from")
    until, beyond = study["linear_until"].values, study["nonlinear_from"].values
    ended = np.isfinite(beyond)
    # a path that does not end is beyond all others
    low, high = float(np.median(until)), float(np.median(np.where(ended, beyond, np.inf)))
    farthest = f"{beyond[ended].max():.3g} mg" if ended.all() else f"beyond {until.max():.3g} mg"
    return Finding(
        f"the median ends between {low:.3g} and {high:.3g} mg; single ones of {until.size} realizations between "
        f"{until.min():.3g} mg and {farthest}",
        0.5 * (low + high),
        [
            Condition(
                "it ends in most of them", bool(np.isfinite(high)), f"{ended.sum()} of {ended.size}", essential=True
            ),
            Condition(
                "median between 0.2 and 0.8 mg (a factor 2 to either side of about 0.4 mg)",
                bool(low >= 0.2 and high <= 0.8),
                f"between {low:.3g} and {high:.3g} mg",
            ),
            Condition(
                "every one of them between 0.2 and 0.8 mg",
                bool(ended.all() and until.min() >= 0.2 and beyond.max() <= 0.8),
                f"from {until.min():.3g} mg to {farthest}",
            ),
        ],
        (low, high),
    )


CLAIMS = (
    Claim(
        "D1",
        "VI, Fig. 19",
        "delta = 0.01, 15 mg, w = 3: peaks of the mean response over realizations, friction 0 and 0.2",
        "two peaks without friction, one with 0.2",
        two_peaks_or_one,
        (19,),
        AVERAGES,
    ),
    Claim(
        "D2",
        "VI.A, Fig. 20",
        "delta = 0.01: end of the linear range at x = 0 over that of the lattice with the same friction",
        "shorter than in the lattice",
        shorter_range,
        (20,),
        AVERAGES,
    ),
    Claim(
        "D3",
        "VI.A, Fig. 21",
        "crossover force against friction and polydispersity (0.01, 0.1, 0.25), with intervals over realizations",
        "grows with friction, falls with polydispersity",
        crossover_order,
        (21, 22),
        PHASES,
    ),
    Claim(
        "D4",
        "VI.A",
        "friction 1: asymmetry of the mean response and its dip at x = 0 at growing forces, w = 6",
        "gradual crossover, no jump",
        gradual,
        (21,),
        AVERAGES,
    ),
    Claim(
        "D5",
        "VI.A",
        "number of peaks of the mean of five realizations against that of all, away from the crossover",
        "five are enough when the force is not near its crossover",
        five_enough,
        (21,),
        AVERAGES,
    ),
    Claim(
        "D6",
        "Fig. 22",
        "crossover force on the plane of friction and force for each polydispersity, with intervals",
        "a sketch",
        diagram,
        (22,),
        PHASES,
    ),
    Claim(
        "D7",
        "VII",
        "friction 0: contacts per disk at rest, away from the boundaries, in the lattice and at delta = 0.01",
        "6 and about 4.25",
        coordination,
        (),
        AVERAGES,
    ),
    Claim(
        "U1",
        "VI.B, Fig. 23",
        "delta = 0.01, friction 0.05, 0.2 mg: floor response to two loads against the sum of their single responses, "
        "disk by disk, in a typical realization",
        "holds force by force",
        superposition(0.2, 0.05),
        (23,),
        SUPERPOSITION,
    ),
    Claim(
        "U2",
        "VI.B",
        "end of the linear range of that slab",
        "up to about 0.4 mg",
        superposition_range,
        (24,),
        SUPERPOSITION,
    ),
    Claim(
        "U3",
        "VI.B, Fig. 24",
        "the same at 1 mg",
        "holds quite well",
        superposition(1.0, 0.2),
        (24,),
        SUPERPOSITION,
    ),
)
