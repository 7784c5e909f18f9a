"""Claims N1 to N7: what the paper says about its numerics (Sec. III)."""

from __future__ import annotations

import numpy as np

from granular_response.state import FloatArray

from ...claims import asked
from ...claims.bootstrap import over_realizations
from ...claims.claim import Claims, Condition, Data, Finding, Quantity, Reading, at
from ...claims.words import Bounds

GROUP = "numerics"
CLAIMS = Claims(GROUP)

#: How the energy that ends a run is read.
RULES = {
    "instantaneous": "stop as soon as the energy is below 1e-13",
    "envelope": "stop when it stays below 1e-13 for a whole swing",
}


@CLAIMS.measures("N1")
def stop_energy(data: Data, words: Bounds) -> Finding:
    study = at(data.get(GROUP, "stop_energy"), stop_kinetic_energy=1e-13)
    errors = {"at rest": study["rest_error"].values.tolist(), "under load": study["loaded_error"].values.tolist()}
    frictions = [f"friction {mu:g}" for mu in study["friction"].values]
    largest = zip(frictions, map(max, *errors.values()), strict=True)
    return Finding(
        "largest error of a floor force per largest one: "
        + ", ".join(f"{error:.1e} ({name})" for name, error in largest),
        [
            Reading(
                f"{name}, {when}", Condition("error of the floor forces", Quantity.exact(error), most=0.01, unit="%")
            )
            for when, each in errors.items()
            for name, error in zip(frictions, each, strict=True)
        ],
    )


@CLAIMS.measures("N2")
def restart(data: Data, words: Bounds) -> Finding:
    largest = float(data.get(GROUP, "restart")["kinetic_energy"].max())
    return asked.one_reading(
        f"at most {largest:.1e} per disk at every look",
        "every load and look",
        Condition("kinetic energy per disk", Quantity.exact(largest), most=1e-22),
    )


@CLAIMS.measures("N3a")
def at_rest(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "at_rest")
    fixed, sliding, loose = (float(study[n]) for n in ("network_fixed_steps", "sliding_contacts", "loose_disks"))
    return asked.one_reading(
        f"network fixed for {fixed:.0f} steps, {sliding:.0f} sliding contacts, {loose:.0f} disks with fewer than two "
        "contacts",
        "at the stop",
        Condition("steps with a fixed network", Quantity.exact(fixed), 100.0 * words["several"], words=("several",)),
        asked.none_of("sliding contacts", sliding),
        asked.none_of("disks with fewer than two contacts", loose),
    )


@CLAIMS.measures("N3b")
def swing(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "swing")
    readings, texts = [], []
    for rule in study["stop_rule"].values.tolist():
        one = study.sel(stop_rule=rule)
        acceleration, energy = one["mean_acceleration"].values, float(one["kinetic_energy"].max())
        texts.append(f"{rule} rule: {acceleration.mean():.1e} g, at most {acceleration.max():.1e}, energy {energy:.1e}")
        for what, value in (("mean over a swing", acceleration.mean()), ("largest of a swing", acceleration.max())):
            below = Condition("mean acceleration in g", Quantity.exact(value), most=1e-5, strict=True)
            readings.append(Reading(f"{RULES[rule]}, {what}", below))
    return Finding("; ".join(texts), readings)


@CLAIMS.measures("N4")
def time_step(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "time_step").sortby("time_step", ascending=False)
    step = study["time_step"].values
    CLAIMS.needs(np.isclose(step[1], 0.5 * step[0]), "time_step holds no time step and its half")
    difference = float(study["difference"].values[1])
    return Finding(
        f"the response changes by {difference:.1e} of its largest value from a step of {step[0]:g} to {step[1]:g}",
        [_unseen(difference, words)],
    )


@CLAIMS.measures("N5")
def integrators(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "integrators")
    CLAIMS.needs(study["integrator"].values[0] == "beeman", "integrators compares with another method than beeman")
    CLAIMS.needs("gear" in study["integrator"].values, "integrators holds no Gear's method")
    difference = float(study["difference"].sel(integrator="gear"))
    return Finding(f"the responses differ by {difference:.1e} of the largest value", [_unseen(difference, words)])


def _unseen(difference: float, words: Bounds) -> Reading:
    return Reading(
        "friction 0.2, 15 mg", asked.at_most("difference per largest response", difference, words, "visible", "%")
    )


@CLAIMS.measures("N6")
def damping(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "damping").sortby("damping_ratio")
    ratio, stable = study["damping_ratio"].values, study["beeman_limit"].values >= 5e-4  # the paper's step
    time = np.where(study["settled"].values > 0, study["relaxation_time"].values, np.inf)
    half = at(study.assign(time=("damping_ratio", time), stable=("damping_ratio", stable)), damping_ratio=0.5)
    paper = float(half["time"])
    CLAIMS.needs(
        ratio.size > 4 and np.isfinite(paper) and half["stable"], "damping needs five ratios, a stable 0.5 among them"
    )
    best = {"any step and integrator": time.min(), "the paper's step": time[stable].min()}
    what, most = "time to rest with sqrt(k) per the shortest", 1.0 + words["nearly"]
    readings = [
        Reading(name, Condition(what, Quantity.exact(paper / shortest), most=most, words=("nearly",)))
        for name, shortest in best.items()
    ]
    return Finding(
        f"nu = sqrt(k) (half of critical): {paper:.0f} sqrt(R/g); ratios from {ratio[0]:g} to {ratio[-1]:g} of "
        f"critical: {time[0]:.0f} to {time[-1]:.0f}; Beeman's method with the paper's step is stable up to a ratio of "
        f"{ratio[stable].max():g}",
        readings,
    )


@CLAIMS.measures("N7")
def disorder(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "disorder")
    stopped, finished = study["stopped"].values, study["finished"].values
    number = len(stopped)

    def difference(picked: FloatArray, axis: int) -> FloatArray:
        """Largest difference of the means of the realizations ``picked``, per largest value of the finished one."""
        early, exact = (one[picked.astype(int)].mean(axis=axis) for one in (stopped, finished))
        return np.asarray(np.abs(early - exact).max(axis=-1) / exact.max(axis=-1))

    single = float(np.median(np.abs(stopped - finished).max(axis=1) / finished.max(axis=1)))
    found = over_realizations(np.arange(number), difference)
    return asked.one_reading(
        f"mean of {number}: {found.text('%')} of its largest value; single realizations: median {single:.2%}",
        "1 %, as for floor forces",
        Condition("error of the mean response", found, most=0.01, unit="%"),
    )
