"""Claims N1 to N8: what the paper says about its numerics (Sec. III)."""

from __future__ import annotations

import numpy as np

from ...claims.claim import Claim, Condition, Data, Finding, NotMeasured, Quantity, Reading, at, missing
from ...claims.words import Bounds

GROUP = "numerics"


def stop_energy(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "stop_energy", "rest_error", "loaded_error", "stop_kinetic_energy", "friction")
    study = at(study, stop_kinetic_energy=1e-13)
    return Finding(
        "largest error of a floor force per largest one: "
        + ", ".join(
            f"{max(r, u):.1e} (friction {mu:g})"
            for mu, r, u in zip(
                study["friction"].values, study["rest_error"].values, study["loaded_error"].values, strict=True
            )
        ),
        [
            Reading(
                f"friction {mu:g}, {text}",
                Condition("error of the floor forces", Quantity.exact(error), most=0.01, unit="%"),
            )
            for text, name in (("at rest", "rest_error"), ("under load", "loaded_error"))
            for mu, error in zip(study["friction"].values.tolist(), study[name].values.tolist(), strict=True)
        ],
    )


def restart(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "restart", "kinetic_energy", "load")
    largest = float(study["kinetic_energy"].max())
    return Finding(
        f"at most {largest:.1e} per disk at every look",
        [
            Reading(
                "every load and look",
                Condition("kinetic energy per disk", Quantity.exact(largest), most=1e-22),
            )
        ],
    )


def at_rest(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "at_rest", "network_fixed_steps", "sliding_contacts", "loose_disks")
    fixed, sliding, loose = (float(study[n]) for n in ("network_fixed_steps", "sliding_contacts", "loose_disks"))
    return Finding(
        f"network fixed for {fixed:.0f} steps, {sliding:.0f} sliding contacts, {loose:.0f} disks with fewer than two "
        "contacts",
        [
            Reading(
                "at the stop",
                Condition(
                    "steps with a fixed network", Quantity.exact(fixed), 100.0 * words["several"], words=("several",)
                ),
                Condition("sliding contacts", Quantity.exact(sliding), most=0.0),
                Condition("disks with fewer than two contacts", Quantity.exact(loose), most=0.0),
            )
        ],
    )


def time_step(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "time_step", "difference", "time_step").sortby("time_step", ascending=False)
    step = study["time_step"].values
    if step.size < 2 or not np.isclose(step[1], 0.5 * step[0]):
        raise NotMeasured(f"data/{GROUP}.nc: time_step holds no time step and its half")
    difference = float(study["difference"].values[1])
    return Finding(
        f"the response changes by {difference:.1e} of its largest value from a step of {step[0]:g} to {step[1]:g}",
        [_unseen(difference, words)],
    )


def integrators(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "integrators", "difference", "integrator")
    names = study["integrator"].values.tolist()
    if names[0] != "beeman" or "gear" not in names:
        raise NotMeasured(f"data/{GROUP}.nc: integrators does not compare gear with beeman")
    difference = float(study["difference"].values[names.index("gear")])
    return Finding(f"the responses differ by {difference:.1e} of the largest value", [_unseen(difference, words)])


def _unseen(difference: float, words: Bounds) -> Reading:
    return Reading(
        "friction 0.2, 15 mg",
        Condition(
            "difference per largest response",
            Quantity.exact(difference),
            most=words["visible"],
            words=("visible",),
            unit="%",
        ),
    )


def damping(data: Data, words: Bounds) -> Finding:
    names = ("relaxation_time", "settled", "damping_ratio", "beeman_limit")
    study = data.get(GROUP, "damping", *names).sortby("damping_ratio")
    ratio, settled = study["damping_ratio"].values, study["settled"].values.astype(bool)
    time = np.where(settled, study["relaxation_time"].values, np.inf)
    here = np.flatnonzero(np.isclose(ratio, 0.5))
    if not here.size or ratio.size < 5 or not np.isfinite(time[here[0]]):
        raise NotMeasured(f"data/{GROUP}.nc: damping needs five ratios or more, 0.5 among them")
    paper, step = float(time[here[0]]), 5e-4
    stable = study["beeman_limit"].values >= step
    if not stable[here[0]]:
        raise NotMeasured(f"data/{GROUP}.nc: the paper's step is unstable with the paper's damping")
    readings = []
    for name, allowed in (("any step and integrator", np.full(ratio.shape, True)), ("the paper's step", stable)):
        best = int(np.argmin(np.where(allowed, time, np.inf)))
        readings.append(
            Reading(
                name,
                Condition(
                    "time to rest with sqrt(k) per the shortest",
                    Quantity.exact(paper / time[best]),
                    most=1.0 + words["nearly"],
                    words=("nearly",),
                ),
            )
        )
    return Finding(
        f"nu = sqrt(k) (half of critical): {paper:.0f} sqrt(R/g); ratios from {ratio[0]:g} to {ratio[-1]:g} of "
        f"critical: {time[0]:.0f} to {time[-1]:.0f}; Beeman's method with the paper's step is stable up to a ratio of "
        f"{ratio[stable].max():g}",
        readings,
        "Times by velocity Verlet and half the step; with the paper's integrator and step more damping is unstable",
    )


CLAIMS = (
    Claim(
        "N1",
        "III.C",
        "floor forces of a run that stops at 1e-13 per disk against the static equilibrium it was settling to, at rest "
        "and under 15 mg",
        "below 1 %",
        stop_energy,
        (),
        GROUP,
    ),
    Claim(
        "N2",
        "III.C",
        "statically finished frictionless states put back into the dynamics: largest kinetic energy per disk",
        "below 1e-22",
        restart,
        (),
        GROUP,
    ),
    Claim(
        "N3a",
        "III.C",
        "friction 0.2, 15 mg, stopped at 1e-13: the other criteria of rest",
        "network fixed for several hundred steps, two contacts for each disk, no sliding contact",
        at_rest,
        (),
        GROUP,
    ),
    Claim(
        "N3b",
        "III.C",
        "the same: mean acceleration of a disk",
        "below 1e-5 g",
        missing(
            "the mean acceleration over a whole swing; stored are single instants, those of the stop, at about 2e-5 g"
        ),
        (),
        GROUP,
    ),
    Claim(
        "N4",
        "III.B",
        "friction 0.2, 15 mg: floor response with the paper's time step and with half of it",
        "no effect",
        time_step,
        (),
        GROUP,
    ),
    Claim(
        "N5",
        "III",
        "friction 0.2, 15 mg: floor response by Gear's method with five values and by Beeman's, same time step",
        "no significant change",
        integrators,
        (),
        GROUP,
    ),
    Claim(
        "N6",
        "III.B",
        "friction 0.2: time to rest under gravity against the damping of a contact",
        "nu = sqrt(k), half of critical, relaxes fastest",
        damping,
        (),
        GROUP,
    ),
    Claim(
        "N7",
        "III.C",
        "disordered averages stopped at 1e-9 per disk against statically finished ones",
        "sufficient accuracy",
        missing("ensembles stopped at 1e-9 per disk without the static finish"),
        (),
        GROUP,
    ),
)
