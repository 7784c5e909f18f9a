"""Frictionless equilibrium as a minimum of the potential energy.

Newton's method with Levenberg damping: the Hessian is the tangent stiffness with its geometric part, and
the damping grows when a step does not lower the energy as much as its quadratic model says. It starts from any
configuration, the bare lattice included, and ends in a minimum: a saddle, which a symmetric start may lead to, is
left along its unstable direction.
"""

from __future__ import annotations

import numpy as np

from .equilibrium import TOLERANCE, EquilibriumError, Rearranged, attainable, certify, external_force
from .problem import Problem
from .state import FloatArray, State
from .system import REGULARISATION, StaticSystem, Trial

#: Most iterations of one minimisation.
MAXIMUM_ITERATIONS = 2000
#: Iterations between two looks at whether the packing has rearranged.
LOOK_EVERY = 10
#: No disk moves farther than this in one step (mean radii).
LONGEST_STEP = 0.2
#: A step that gains less than this part of what its quadratic model says is shortened, and damping grows.
POOR = 0.25
#: Least damping where the stiffness of the springs alone makes a step (units of the normal stiffness).
SPRINGS_ALONE = 1e-6
#: Where factorisations are dear, in packings of more disks than this, a saddle is left as soon as one is near: when the
#: stiffness is not positive though little damped and no force out of balance exceeds that many disk weights.
LARGE, NEAR_SADDLE = 20_000, 0.1
#: First length along an unstable direction, times the normal stiffness.
SHORTEST_ESCAPE = 1e-3
#: Factors of the damping after a poor and after a good step.
MORE, LESS = 10.0, 0.1


def energy(system: StaticSystem, trial: Trial, external: FloatArray) -> float:
    """Elastic energy of the contacts minus the work of the external forces."""
    c = trial.configuration
    k, k_wall = system.problem.pair_law[0], system.problem.wall_law[0]
    elastic = 0.5 * k * (np.maximum(c.pair_overlap, 0.0) ** 2).sum()
    elastic += 0.5 * k_wall * (np.maximum(c.wall_overlap, 0.0) ** 2).sum()
    return float(elastic - external @ c.q)


def minimise(problem: Problem, start: State, *, load_factor: float = 0.0) -> State:
    """The minimum of the energy reached downhill from ``start``, certified.

    Raises
    ------
    ValueError
        When the scene has friction (no energy to minimise).
    EquilibriumError
        When no minimum is found: something falls for ever, or too many iterations.
    Rearranged
        When disks meet that were not neighbours at the start.
    """
    if problem.rotations:
        raise ValueError("method minimise needs a scene without friction; use path or dynamics")
    system = StaticSystem(problem, start)
    external = external_force(problem, load_factor)
    k = problem.pair_law[0]
    known = system.start(start)
    q = known.q.copy()
    trial = system.trial(known, q)
    value = energy(system, trial, external)
    damping = 1e-3 * k
    iterations = escapes = 0
    while iterations < MAXIMUM_ITERATIONS:
        r = trial.contact_force + external
        size = float(np.abs(r).max())
        tolerance = attainable(system, q)
        settled = size < 0.01 * TOLERANCE or (size < tolerance and damping == 0.0)
        if (settled or iterations % LOOK_EVERY == LOOK_EVERY - 1) and system.meets_unlisted(q):
            raise Rearranged("the packing rearranges on its way to a minimum of the energy; use method dynamics")
        if settled:
            modes = system.negative_modes(trial)
            if modes == 0:
                break
            if escapes == 20:
                raise EquilibriumError("the minimisation keeps returning to a saddle of the energy")
            escapes += 1
            if problem.n > LARGE:
                q, trial = _down_from_saddle(system, known, external, q, trial)
            else:
                q = q + 1e-4 * system.unstable_direction(trial)
                trial = system.trial(known, q)
            value = energy(system, trial, external)
            damping = 1e-4 * k
            iterations += 1
            continue
        lu = system.definite_factor(trial, damping + REGULARISATION * k)
        iterations += 1
        if lu is None and problem.n > LARGE and size < NEAR_SADDLE and damping < 1e-7 * k and escapes < 20:
            escapes += 1
            q, trial = _down_from_saddle(system, known, external, q, trial)
            value = energy(system, trial, external)
            damping = 1e-7 * k
            continue
        if lu is None:
            lu = system.definite_factor(system.without_prestress(trial), max(damping, SPRINGS_ALONE * k))
        if lu is None:
            damping = max(MORE * damping, 1e-8 * k)
            continue
        step = system.deinterleave(lu.solve(system.interleave(r)))
        length = float(np.abs(step).max())
        if length > LONGEST_STEP:
            if not np.isfinite(length) or damping > 1e6 * k:
                raise EquilibriumError("the minimisation found no minimum: part of the packing falls")
            damping = max(4.0 * damping, 1e-8 * k)
            continue
        new = system.trial(known, q + step)
        new_value = energy(system, new, external)
        predicted = 0.5 * float(step @ r) + 0.5 * damping * float(step @ step)
        gained = value - new_value
        new_size = float(np.abs(new.contact_force + external).max())
        rounding = 1e-11 * (abs(value) + 1.0)
        if predicted <= rounding and problem.n > LARGE:
            # Energies have lost their digits, slopes have not. Contacts that open or close may raise the residual for a
            # moment; to stop at each of them would take many steps.
            ratio = 1.0
            if new_size > 10.0 * size and new_size > tolerance:
                step, new = _shorter(system, known, external, q, step, float(step @ r), new)
                new_value = energy(system, new, external)
                ratio = float(np.abs(step).max()) / length
        elif predicted > rounding:
            ratio = gained / predicted
        else:
            ratio = 1.0 if new_size < 2.0 * size or new_size < tolerance else 0.0
        if ratio < POOR and predicted > rounding:
            step, new = _shorter(system, known, external, q, step, float(step @ r), new)
            new_value = energy(system, new, external)
            if new_value > value:
                damping = max(MORE * damping, 1e-8 * k)
                continue
        elif ratio < POOR:
            damping = max(MORE * damping, 1e-8 * k)
            continue
        q, trial, value = q + step, new, new_value
        if ratio > 0.5:
            damping = LESS * damping if damping > 1e-9 * k else 0.0
        elif ratio < POOR:
            damping = max(MORE * damping, 1e-8 * k)
    else:
        raise EquilibriumError(f"no minimum of the energy within {MAXIMUM_ITERATIONS} iterations")
    state = system.state(trial, load_factor, method="minimise", newton_iterations=iterations, escapes=escapes)
    state.information["certificate"] = certify(problem, state, modes=0)
    return state


def _shorter(system: StaticSystem, known, external, q, step, slope, full: Trial) -> tuple[FloatArray, Trial]:
    """The part of a step that is too long at which the energy's slope has fallen to a quarter."""
    low, at_low = 0.0, slope
    high, at_high = 1.0, float((full.contact_force + external) @ step)
    part, trial = 1.0, full
    for k in range(8):
        if at_high >= 0.0:
            return step, trial
        secant = low + (high - low) * at_low / (at_low - at_high)
        part = secant if k % 2 == 0 else 0.5 * (low + high)
        part = min(max(part, low + 0.05 * (high - low)), high - 0.05 * (high - low))
        trial = system.trial(known, q + part * step)
        here = float((trial.contact_force + external) @ step)
        if abs(here) < 0.25 * slope:
            break
        if here > 0:
            low, at_low = part, here
        else:
            high, at_high = part, here
    return part * step, trial


def _down_from_saddle(system: StaticSystem, known, external, q, trial: Trial) -> tuple[FloatArray, Trial]:
    """Go from near a saddle along its unstable direction, in doubled lengths as long as energy falls."""
    direction = system.unstable_direction(trial)
    best = (q, trial)
    for sense in (1.0, -1.0):
        length = SHORTEST_ESCAPE / system.problem.pair_law[0] * sense
        while abs(length) < LONGEST_STEP:
            there = system.trial(known, q + length * direction)
            if sense * float((there.contact_force + external) @ direction) <= 0.0:
                break
            best = (q + length * direction, there)
            length *= 2.0
        if best[1] is not trial:
            break
    return best
