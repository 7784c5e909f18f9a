"""Claims N1 to N7: what the paper says about its numerics (Sec. III)."""

from __future__ import annotations

import numpy as np

from ...claims.bootstrap import DRAWS, of_draws
from ...claims.bounds import at_least, at_most, less_than, more_than
from ...claims.claim import SLAB, Ask, Claims, Data, Numbers, at
from ...claims.numbers import needs

GROUP = "numerics"
claim = Claims(GROUP, {**SLAB, "force": 15.0, "friction": 0.2, "frictions": [0.0, 0.2]})

#: The paper's time step and energy, and its smallest number of packings in an average.
STEP, ENERGY, FIVE = 5e-4, 1e-13, 5


def _stopped(data: Data, energy: float, friction: float, *errors: str) -> float:
    """The largest error of a run that stops at an energy."""
    found = at(data.get(GROUP, "stop_energy"), stop_kinetic_energy=energy, friction=friction)
    return max(float(found[name]) for name in errors)


@claim("N1", "III.C",
       Ask("largest error of a floor force, at rest and under load, per largest force", at_most(0.01), "%"),
       Ask("error of the response with an energy of 1e-9", more_than(0.01), "%"), primary="friction 0.2")  # fmt: skip
def accurate(data: Data) -> Numbers:
    """We found that in order to obtain an accuracy of less than 1% for the forces on the floor in a given realization,
    which are used here to define the response of the system to a localized force, the system has to be relaxed to a
    kinetic energy of E_k^stop = 10⁻¹³ mgR per particle, which is significantly smaller than that used in previous
    studies (e.g., in [77], the systems are relaxed to E_k^stop = 2·10⁻⁸ mgR per particle).
    Short: Stopping at 1e-13 is accurate to 1 %, stopping much earlier is not
    Here: Stopped at 1e-13 mgR per disk, floor forces are off by {0}. Stopped at 1e-9 they are off by {floor forces,
    friction 0.2, 1e-9|0} and the response by {1}; at 1e-11 by {floor forces, friction 0.2, 1e-11|0} and {response,
    friction 0.2, 1e-11|0}.
    Remark: Friction 0.2: without friction the paper ends its runs in another way. The error of the response decides
    whether so small an energy is needed, since the floor forces are used to define it. The paper compares with 2e-8;
    the nearest energy here is 1e-9. Only powers of a hundred were tried"""
    for mu in (0.2, 0.0):
        enough = _stopped(data, ENERGY, mu, "rest_error", "loaded_error")
        yield f"friction {mu:g}", enough, _stopped(data, 1e-9, mu, "response_error")
        for energy in (1e-9, 1e-11):
            name = f"friction {mu:g}, 1e{round(np.log10(energy))}"
            yield f"floor forces, {name}", None, _stopped(data, energy, mu, "rest_error", "loaded_error")
        yield f"response, friction {mu:g}, 1e-11", None, _stopped(data, 1e-11, mu, "response_error")


@claim("N3", "III.C", Ask("steps with a fixed network", at_least(300.0), "count"),
       Ask("sliding contacts", at_most(0.0), "count"), Ask("disks with fewer than two contacts", at_most(0.0), "count"),
       Ask("mean acceleration in g", less_than(1.0e-5)), primary="stop when the energy stays small")  # fmt: skip
def criteria(data: Data) -> Numbers:
    """We verified that several other criteria for static equilibrium (see [78]) were satisfied: the contact network was
    fixed for at least several hundred time steps (and each particle had at least two contacts), there were no sliding
    contacts, and the mean particle acceleration was less than 10⁻⁵ mg.
    Short: At the end the network is fixed, no contact slides, nothing accelerates
    Here: When a run stops at friction 0.2 and 15 mg, the network has not changed for {0} steps, {1} contact slides and
    {2} disk has fewer than two contacts. The mean acceleration is {3} g if the kinetic energy has to stay below 1e-13
    for some oscillations of the slab, and {stop as soon as the energy is small|0} g if a run stops as soon as it is.
    Remark: Several hundred is at least three hundred. In the asymmetric states of Fig. 16(b) one disk of the floor has
    a single contact, with the floor. The kinetic energy first falls below the limit at a turning point, where the
    acceleration is largest"""
    names = ("network_fixed_steps", "sliding_contacts", "loose_disks")
    counted = [data.value(GROUP, f"at_rest.{name}") for name in names]
    slow, soon = (
        data.value(GROUP, "swing.mean_acceleration", np.mean, stop_rule=rule) for rule in ("envelope", "instantaneous")
    )
    yield "stop when the energy stays small", *counted, slow
    yield "stop as soon as the energy is small", None, None, None, soon


@claim("N4", "III.B", Ask("difference per largest response", at_most("visible"), "%"))
def time_step(data: Data) -> Numbers:
    """We verified that decreasing the time step did not affect the results of the simulations.
    Short: A smaller time step gives the same results
    Here: With half of the time step the response differs by {0} of its largest value."""
    yield data.value(GROUP, "time_step.difference", time_step=2.5e-4)


@claim("N5", "III", Ask("difference per largest response", at_most("visible"), "%"))
def gear(data: Data) -> Numbers:
    """We verified that the use of a Gear 5-value predictor-corrector algorithm [48] does not result in any significant
    changes in the results.
    Short: Gear's method gives the same results
    Here: By Gear's method the response differs by {0} of its largest value, with the same time step."""
    yield data.value(GROUP, "integrators.difference", integrator="gear")


@claim("N6", "III.B", Ask("time to rest at half of critical per the shortest", at_most("nearly", plus=1.0)),
       primary="the paper's integrator and step")  # fmt: skip
def damping(data: Data) -> Numbers:
    """This value was found to produce the fastest relaxation of the system towards static equilibrium and is irrelevant
    in the state of mechanical equilibrium itself.
    Short: Half of critical damping relaxes fastest
    Here: Of the dampings at which Beeman's method is stable with the paper's step, half of critical takes {0} times the
    shortest time. With smaller steps more damping settles sooner: half of critical takes {any step|0} times as long as
    the fastest.
    Remark: Gravity at friction 0.2; times are those of velocity Verlet with half of the step. In equilibrium itself no
    dashpot acts; what depends on them is which equilibrium is reached (N10)"""
    study = data.get(GROUP, "damping").sortby("damping_ratio")
    settled = study.isel(damping_ratio=study["settled"].values > 0)
    time = settled["relaxation_time"].values
    needs(time.size > 4 and np.isfinite(time).all(), "damping needs five ratios that settle")
    half = float(at(settled, damping_ratio=0.5)["relaxation_time"])
    stable = settled["beeman_limit"].values >= STEP
    needs(stable[np.isclose(settled["damping_ratio"].values, 0.5)].all(), "damping: half of critical is not stable")
    yield "the paper's integrator and step", half / time[stable].min()
    yield "any step", half / time.min()


@claim("N7", "III.C", Ask("error of the mean response", at_most(0.01), "%"), finds="any")
def disorder(data: Data) -> Numbers:
    """In this case, sufficient accuracy was obtained with E_k^stop = 10⁻⁹ mgR.
    Short: For averages over disorder 1e-9 is enough
    Here: Stopping at 1e-9 mgR per disk changes the mean response of five disordered packings by {0} of its largest
    value.
    Remark: Sufficient is taken as 1 %, as for floor forces. Five is the smallest number that the paper averages over;
    the interval holds 95 % of the samples of five"""
    study = data.get(GROUP, "disorder")
    stopped, finished = (study[name].transpose("realization", ...).values for name in ("stopped", "finished"))
    needs(np.isfinite(stopped).all() and np.isfinite(finished).all(), "disorder holds responses without numbers")
    samples = np.random.default_rng(0).permuted(np.tile(np.arange(len(stopped)), (DRAWS, 1)), axis=1)[:, :FIVE]
    early, exact = (one[samples].mean(axis=1) for one in (stopped, finished))
    off = np.abs(early - exact).max(axis=1) / exact.max(axis=1)
    yield of_draws(np.median(off), off, "samples of five", len(stopped))
