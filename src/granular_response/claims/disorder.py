"""Claims D1 to D7 and U1 to U3: polydisperse slabs and superposition (Secs. VI and VII)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from .claim import Claim, Condition, Data, Finding, NotMeasured, at

AVERAGES = "polydisperse_averages"
PHASES = "phase_diagram"
SUPERPOSITION = "superposition"
LATTICE = "friction_linear_range"


def two_peaks_or_one(data: Data) -> Finding:
    study = data.get(AVERAGES, "comparison", "mean_double_peaked", "double_peaked", "friction")
    without, rough = at(study, friction=0.0), at(study, friction=0.2)
    single = [float(one["double_peaked"].mean()) for one in (without, rough)]
    mean = [bool(one["mean_double_peaked"]) for one in (without, rough)]
    number = study.sizes["realization"]
    return Finding(
        f"mean of {number} realizations: {1 + mean[0]} peaks at friction 0, {1 + mean[1]} at 0.2; two peaks in "
        f"{single[0]:.0%} and {single[1]:.0%} of the realizations",
        single[0] - single[1],
        [
            Condition("at least 15 realizations", number >= 15, f"{number}"),
            Condition("two peaks in the mean at friction 0", mean[0], f"{1 + mean[0]}"),
            Condition("one peak in the mean at friction 0.2", not mean[1], f"{1 + mean[1]}"),
        ],
        (single[1], single[0]),
    )


def shorter_range(data: Data) -> Finding:
    ratios = {}
    for mu in (0.0, 0.2, 1.0):
        lattice, disorder = data.event(LATTICE, "linear_range", mu), data.event(AVERAGES, "linear_range", mu)
        ratios[mu] = disorder.middle / lattice.middle
    return Finding(
        "linear range over that of the lattice: "
        + ", ".join(f"{r:.2g} at friction {mu:g}" for mu, r in ratios.items()),
        max(ratios.values()),
        [Condition(f"shorter at friction {mu:g}", r < 1.0, f"{r:.2g} times") for mu, r in ratios.items()],
        (min(ratios.values()), max(ratios.values())),
    )


def _crossovers(data: Data) -> xr.Dataset:
    names = ("crossover_force", "interval_low", "interval_high", "polydispersity", "friction")
    return data.get(PHASES, "crossover", *names).sortby("polydispersity").sortby("friction")


def _ordered(low: np.ndarray, high: np.ndarray, *, rising: bool) -> tuple[int, int]:
    """Neighbours along the last axis that follow the order, or not by more than their intervals; and all of them."""
    if not rising:
        low, high = low[..., ::-1], high[..., ::-1]
    before, after = low[..., :-1], high[..., 1:]
    known = np.isfinite(before) & np.isfinite(after)
    return int((after[known] >= before[known]).sum()), int(known.sum())


def crossover_order(data: Data) -> Finding:
    study = _crossovers(data)
    disordered = study.isel(polydispersity=study["polydispersity"].values > 0.0)
    dims = ("polydispersity", "friction")
    low, high = (disordered[name].transpose(*dims).values for name in ("interval_low", "interval_high"))
    force = disordered["crossover_force"].transpose(*dims).values
    rises, of_frictions = _ordered(low, high, rising=True)
    falls, of_disorders = _ordered(low.T, high.T, rising=False)
    if not of_frictions or not of_disorders:
        raise NotMeasured(f"data/{PHASES}.nc: crossover holds too few crossover forces to compare")
    return Finding(
        f"rises with friction in {rises} of {of_frictions} steps, falls with polydispersity in {falls} of "
        f"{of_disorders}, within the intervals; {np.nanmin(force):.2g} to {np.nanmax(force):.2g} mg",
        (rises + falls) / (of_frictions + of_disorders),
        [
            Condition(
                "rises with friction, every step, within the intervals",
                rises == of_frictions,
                f"{rises} of {of_frictions}",
            ),
            Condition(
                "falls with polydispersity, every step, within the intervals",
                falls == of_disorders,
                f"{falls} of {of_disorders}",
            ),
        ],
    )


def gradual(data: Data) -> Finding:
    names = ("asymmetry", "central_dip", "force", "friction", "polydispersity")
    study = data.get(AVERAGES, "averages", *names)
    rough = at(study, friction=1.0).sortby("force")
    step = np.abs(rough["asymmetry"].diff("force"))
    largest = float(step.max())
    return Finding(
        f"largest change of the asymmetry of the mean between neighbouring forces: {largest:.2f}",
        largest,
        [Condition("no jump of the asymmetry by 0.5 or more", largest < 0.5, f"{largest:.2f}")],
    )


def five_enough(data: Data) -> Finding:
    study = data.get(AVERAGES, "averages", "double_peaked", "double_peaked_of_five", "central_dip", "central_dip_error")
    dip, error = study["central_dip"].values, study["central_dip_error"].values
    clear = np.isfinite(dip) & (np.abs(dip) > 3.0 * error)
    if not clear.any():
        raise NotMeasured(f"data/{AVERAGES}.nc: averages holds no force away from its crossover")
    share = float((study["double_peaked"].values == study["double_peaked_of_five"].values)[clear].mean())
    return Finding(
        f"the mean of five has the number of peaks of the mean of all in {share:.0%} of {clear.sum()} cases away from "
        "the crossover",
        share,
        [
            Condition(
                "in at least 95 % of the cases in which the dip at x = 0 is farther from 0 than 3 standard errors",
                share >= 0.95,
                f"{share:.0%}",
            )
        ],
    )


def diagram(data: Data) -> Finding:
    study = _crossovers(data)
    force = study["crossover_force"].values
    width = (study["interval_high"] - study["interval_low"]).values
    found = np.isfinite(force)
    barred = int((found & np.isfinite(width)).sum())
    disorders = study["polydispersity"].values
    expected = all(np.isclose(disorders, d).any() for d in (0.0, 0.01, 0.1, 0.25))
    return Finding(
        f"{found.sum()} crossover forces on {force.size} pairs of friction and polydispersity, {barred} with intervals",
        float(found.sum()),
        [
            Condition("polydispersities 0, 0.01, 0.1 and 0.25", expected, ", ".join(f"{d:g}" for d in disorders)),
            Condition("at least two crossover forces", bool(found.sum() >= 2), f"{found.sum()}", essential=True),
            Condition("an interval for every crossover force", barred == found.sum(), f"{barred} of {found.sum()}"),
        ],
    )


def coordination(data: Data) -> Finding:
    study = data.get(AVERAGES, "packings", "coordination_number", "polydispersity", "friction")
    smooth = at(study, friction=0.0)
    values = {}
    for delta in (0.0, 0.01):
        numbers = at(smooth, polydispersity=delta)["coordination_number"].values
        values[delta] = float(np.nanmean(numbers))
    return Finding(
        f"{values[0.0]:.2f} in the lattice, {values[0.01]:.2f} at polydispersity 0.01",
        values[0.01],
        [
            Condition("lattice: 6 within 0.1", abs(values[0.0] - 6.0) <= 0.1, f"{values[0.0]:.2f}"),
            Condition("polydispersity 0.01: 4.25 within 0.15", abs(values[0.01] - 4.25) <= 0.15, f"{values[0.01]:.2f}"),
        ],
    )


def superposition(force: float, limit: float):
    def measure(data: Data) -> Finding:
        study = at(data.get(SUPERPOSITION, "error", "superposition_error", "force", "distance"), force=force)
        error = study["superposition_error"].values
        worst = float(np.nanmax(error))
        return Finding(
            f"largest difference of sum and whole {np.nanmin(error):.1%} to {worst:.1%} of the largest response, "
            f"{np.isfinite(error).sum()} distances",
            worst,
            [Condition(f"at most {limit:.0%} of the largest response, every distance", worst <= limit, f"{worst:.1%}")],
            (float(np.nanmin(error)), worst),
        )

    return measure


def superposition_range(data: Data) -> Finding:
    bracket = data.event(SUPERPOSITION, "linear_range")
    return Finding(
        f"ends at {bracket.text(' mg')}",
        bracket.middle,
        [
            Condition("the linear range ends", bracket.happens, bracket.text(" mg"), essential=True),
            Condition(
                "between 0.2 and 0.6 mg (half of about 0.4 mg to either side)",
                bracket.within(0.2, 0.6),
                bracket.text(" mg"),
            ),
        ],
        (bracket.low, bracket.high),
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
        "friction 1: asymmetry of the mean response at growing forces",
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
        "disk by disk",
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
        (23,),
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
