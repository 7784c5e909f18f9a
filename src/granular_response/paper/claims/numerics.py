"""Claims N1 to N6: what the paper says about its numerics (Sec. III)."""

from __future__ import annotations

import numpy as np

from .claim import Claim, Condition, Data, Finding, NotMeasured, at

GROUP = "numerics"


def stop_energy(data: Data) -> Finding:
    study = data.get(GROUP, "stop_energy", "rest_error", "loaded_error", "response_error", "stop_kinetic_energy")
    study = at(study, stop_kinetic_energy=1e-13)
    forces = float(np.maximum(study["rest_error"], study["loaded_error"]).max())
    response = float(study["response_error"].max())
    return Finding(
        f"floor forces within {forces:.1e} of the largest one; their difference, the response, within {response:.1e}",
        forces,
        [Condition("floor forces at rest and under load within 1 % of the largest", forces < 0.01, f"{forces:.1e}")],
        (float(study["rest_error"].min()), forces),
    )


def restart(data: Data) -> Finding:
    study = data.get(GROUP, "restart", "kinetic_energy", "load")
    largest = float(study["kinetic_energy"].max())
    return Finding(
        f"at most {largest:.1e} per disk at every reading",
        largest,
        [Condition("below 1e-22 per disk at every reading", largest < 1e-22, f"{largest:.1e}")],
    )


def at_rest(data: Data) -> Finding:
    study = data.get(GROUP, "at_rest", "network_fixed_steps", "sliding_contacts", "mean_acceleration", "loose_disks")
    fixed, sliding = float(study["network_fixed_steps"]), float(study["sliding_contacts"])
    acceleration, loose = float(study["mean_acceleration"]), float(study["loose_disks"])
    return Finding(
        f"network fixed for {fixed:.0f} steps, {sliding:.0f} sliding contacts, mean acceleration {acceleration:.1e} g, "
        f"{loose:.0f} disks with fewer than two contacts",
        acceleration,
        [
            Condition("contact network fixed for at least 300 steps", fixed >= 300, f"{fixed:.0f} steps"),
            Condition("no sliding contact", sliding == 0, f"{sliding:.0f} sliding"),
            Condition("mean acceleration below 1e-5 g", acceleration < 1e-5, f"mean acceleration {acceleration:.1e} g"),
            Condition("every disk has at least two contacts", loose == 0, f"{loose:.0f} have not"),
        ],
        remark="At 1e-13 per disk speeds are near 4e-7; contacts swing at up to sqrt(3000), so accelerations near 2e-5 "
        "are to be expected",
    )


#: Largest difference of a response, per largest response, that no figure would show.
UNSEEN = 1e-3


def time_step(data: Data) -> Finding:
    study = data.get(GROUP, "time_step", "difference", "time_step").sortby("time_step", ascending=False)
    step = study["time_step"].values
    if step.size < 2 or not np.isclose(step[1], 0.5 * step[0]):
        raise NotMeasured(f"data/{GROUP}.nc: time_step holds no time step and its half")
    difference = float(study["difference"].values[1])
    return Finding(
        f"the response changes by {difference:.1e} of its largest value from a step of {step[0]:g} to {step[1]:g}",
        difference,
        [Condition(f"at most {UNSEEN:g} of the largest response", difference <= UNSEEN, f"{difference:.1e}")],
    )


def integrators(data: Data) -> Finding:
    study = data.get(GROUP, "integrators", "difference", "integrator")
    names = study["integrator"].values.tolist()
    if names[0] != "beeman" or "gear" not in names:
        raise NotMeasured(f"data/{GROUP}.nc: integrators does not compare gear with beeman")
    difference = float(study["difference"].values[names.index("gear")])
    return Finding(
        f"the responses differ by {difference:.1e} of the largest value",
        difference,
        [Condition(f"at most {UNSEEN:g} of the largest response", difference <= UNSEEN, f"{difference:.1e}")],
    )


def damping(data: Data) -> Finding:
    study = data.get(GROUP, "damping", "relaxation_time", "settled", "damping_ratio").sortby("damping_ratio")
    ratio, settled = study["damping_ratio"].values, study["settled"].values.astype(bool)
    time = np.where(settled, study["relaxation_time"].values, np.inf)
    here = np.flatnonzero(np.isclose(ratio, 0.5))
    if not here.size or ratio.size < 5 or not settled.any():
        raise NotMeasured(f"data/{GROUP}.nc: damping needs five ratios or more, 0.5 among them")
    paper, best = float(time[here[0]]), int(np.argmin(time))
    slower = float(paper / time[best])
    return Finding(
        f"nu = sqrt(k) (half of critical): {paper:.0f} sqrt(R/g); fastest of {ratio.size} ratios: {ratio[best]:g} of "
        f"critical, {time[best]:.0f}",
        paper,
        [
            Condition(
                "nu = sqrt(k) at most 10 % slower than the fastest ratio",
                slower <= 1.1,
                f"{slower:.2f} times the shortest time, at {ratio[best]:g} of critical",
                True,
            ),
            Condition(
                "a fifth of that damping is at least 20 % slower",
                bool(time[0] >= 1.2 * paper),
                f"{time[0] / paper:.2f} times at {ratio[0]:g} of critical",
            ),
        ],
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
        "N3",
        "III.C",
        "friction 0.2, 15 mg, stopped at 1e-13: the other criteria of rest",
        "network fixed for hundreds of steps, two contacts for each disk, no sliding contact, mean acceleration below "
        "1e-5 g",
        at_rest,
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
)
