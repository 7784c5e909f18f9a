"""The largest time step that is stable for a scene.

Forces are evaluated once a step with a predicted velocity, so dashpots limit the step more than springs do; and the
tangential springs are advanced by that predicted velocity, which without much damping costs up to half of the step
that the same spring on a position would allow. An integrator's limit for one motion follows from its amplification
matrix, which has a spring of either kind and the dashpot. The motions that are looked at, for disks of mass 1 with
moment of inertia 1/2 (radius 1), so that a tangential spring of stiffness k_T turns a disk at the rate 2 k_T:

* *translation* of disks of a dense packing against their six neighbours, which move the opposite way: twice
  ``sum n n = 3`` gives ``6 k_N`` and ``6 k_T``;
* *rotation* of all disks the same way, when every contact slips at twice the rim's speed: ``6 · 2 · 2 k_T = 24 k_T``.
  It decides in most scenes with friction;
* *a disk on the floor* with four neighbours, *a disk in a corner* with two: the wall's springs couple translation and
  rotation, ``slip = u_x - sqrt(2) w`` for the floor and ``u_z - sqrt(2) w`` for a side wall, ``w`` scaled with the
  square root of the moment of inertia;
* *the smallest disk* alone among heavier ones of radius 1, as many as fit around it; half of these where it lies on the
  floor, a quarter in a corner.

Rolling resistance turns two equal disks with a quarter of its stiffness where they spin the opposite ways, tangential
springs where they spin the same way; so the larger of ``k_T`` and ``k_R / 4`` counts at each contact between disks, and
``k_R`` adds to ``k_T`` at a wall, whose arm is the radius.

The study ``stability`` measures the limit of kicked packings against this one: they settle at 0.95 of it, and cycle
or blow up between 1.05 and 1.7 times the limit.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..contact import Law
from ..contact.rolling import FREE, Rolling
from ..errors import SolveError
from ..kernels.integrators import INTEGRATORS, amplification
from ..scene.protocol import PAPERS_TIME_STEP
from ..state import State
from .choice import AT_REST, LARGE
from .problem import Problem
from .springs import static_contacts

#: Part of the limit that ``time_step: auto`` takes.
SAFETY = 0.6
#: Step beyond which no limit is looked for, in sqrt(R/g): nothing that a packing does takes so long.
LONGEST_STEP = 1e6
#: The integrator of the later part of a long fall, the part of its limit that it takes, and how many times the step of
#: the first part it takes at most: 3 leave 2e-4 to 7e-4 mg in floor forces of slabs, less than the first part does.
LATER, LATER_SAFETY, MOST_LONGER = "leapfrog", 0.9, 3.0
#: Periods of the breathing that the first part lasts: after four of them a slab of 60 layers is off by 2.5e-3 mg, and
#: two of its contacts differ; after seven by 6.5e-4 mg, and none does.
FIRST_PERIODS = 7.0
#: Error of floor forces (mg) that the paper's step leaves in ordered slabs four times as wide as deep, by their disks:
#: against a quarter of the step, in the largest one half.
TIME_STEP_ERROR = {908: 1.4e-3, 3615: 2.7e-3, 14430: 8.7e-3}
#: Of a time step, for each disk, with friction: 9 to 11 ns up to 14,430 disks, 20 ns at 102,480, out of cache.
SECONDS_A_DISK = 1.5e-8
#: Expected time of a fall from which on a progress says it (s).
LONG = 60.0
#: Time steps in a collision of a motion, for a restitution within 1e-3 of the speed: dashpots and friction begin at the
#: first step in touch, which is off by up to one. 400 leave 1.1e-3, 600 7e-4 (Beeman; leapfrog 1.7e-3 and 1.1e-3). The
#: force of an elastic contact begins at zero: 50 leave 4e-4, 100 1.2e-4.
COLLISION_STEPS, ELASTIC_COLLISION_STEPS = 600, 100
#: Contacts around a disk of a dense packing, on the floor of one, and in its corner.
NEIGHBOURS, ON_FLOOR, IN_CORNER = 6, 4, 2


class UnstableTimeStep(SolveError, ValueError):
    """The time step of a scene is beyond its stability limit."""


@lru_cache(maxsize=1024)
def oscillator_limit(integrator: str, stiffness: float, damping: float, spring: float = 0.0) -> float:
    """Largest stable step for ``x'' = -stiffness x - spring s - damping x'``.

    ``s`` follows ``x`` as tangential springs do, advanced by the predicted velocity. The step grows until the largest
    eigenvalue of the amplification matrix exceeds 1 by more than 1e-4 (Gear's corrector is weakly unstable without
    damping, far below what matters in a packing). What is unstable at one step is so at all longer ones.
    """

    def stable(dt: float) -> bool:
        step = amplification(INTEGRATORS[integrator], stiffness * dt * dt, damping * dt, spring * dt * dt)
        return bool(np.abs(np.linalg.eigvals(step)).max() <= 1.0 + 1e-4)

    row = [1e-3 / max(np.sqrt(stiffness + spring), damping, 1e-300)]
    while row[-1] < LONGEST_STEP:
        row.append(1.1 * row[-1])
    first_unstable = bisect_left(row, True, lo=1, key=lambda dt: not stable(dt))
    step = row[first_unstable - 1]
    unstable = 1.1 * step
    for _ in range(20):
        middle = 0.5 * (step + unstable)
        step, unstable = (middle, unstable) if stable(middle) else (step, middle)
    return float(step)


#: Moment of inertia over mass times squared radius, of a homogeneous disk.
MOMENT = 0.5

#: Stiffness that follows positions, stiffness of tangential springs, and damping rate, all over the mass.
Motion = tuple[float, float, float]

#: Normal stiffness, normal damping, tangential stiffness, tangential damping, rolling stiffness, rolling damping.
Constants = tuple[float, float, float, float, float, float]


def _constants(force: float, law: Law, rolling: Rolling = FREE) -> Constants:
    """Of a law at normal forces up to ``force``."""
    tangential, along = ((one.tangential_stiffness, one.tangential_damping) for one in (law, rolling))
    return law.stiffest(force), law.normal_damping, *tangential, *along


def largest_force(problem: Problem) -> float:
    """Estimate of the largest normal force of a contact: twice the weight of a column, for its fall, and the loads.

    The loads at the largest of the protocol's load factors; a displacement counts as if one contact took all of it.
    """
    columns = max(0.5 * problem.packing.width, 1.0)
    loads, largest = problem.scene.loads, float(np.abs(problem.scene.protocol.load_factors).max(initial=0.0))
    force = 2.0 * problem.n / columns + largest * sum(float(np.hypot(*load.force)) for load in loads) + 1.0
    travel = largest * sum(math.hypot(*(part or 0.0 for part in load.displacement or ())) for load in loads)
    if travel > 0.0:
        one, law = np.ones(1), problem.pair_law
        contact = static_contacts(one, one, travel * one, np.zeros((1, 1)), law.shapes(one, one), (law,))
        force += float(contact.normal_force[0])
    return force


def _at_wall(pair: Constants, wall: Constants, neighbours: float, walls: int) -> list[Motion]:
    """Stiffest motions of a disk at one wall or two: coordinates (x, z, rotation times sqrt(moment))."""
    kn, nun, kt, nut, kr, nur = pair
    rim = 1.0 / np.sqrt(MOMENT)
    along = np.array([[1.0, 0.0, -rim], [0.0, 1.0, -rim]])[:walls]
    inward = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])[:walls]
    around = np.diag([1.0, 1.0, 0.0]) * neighbours
    turn = 2.0 / MOMENT
    spinning, spin_damping = (
        np.diag([tangential, tangential, turn * max(tangential, 0.25 * rolling)]) * neighbours
        for tangential, rolling in ((kt, kr), (nut, nur))
    )
    direct = kn * around + wall[0] * inward.T @ inward
    tangential = spinning + wall[2] * along.T @ along
    damping = nun * around + spin_damping + wall[1] * inward.T @ inward + wall[3] * along.T @ along
    tangential[2, 2] += walls * wall[4] / MOMENT
    damping[2, 2] += walls * wall[5] / MOMENT
    motions: list[Motion] = []
    for matrix in (direct + tangential, damping):
        mode = np.linalg.eigh(matrix)[1][:, -1]
        motions.append((float(mode @ direct @ mode), float(mode @ tangential @ mode), float(mode @ damping @ mode)))
    return motions


def stiffest_motions(problem: Problem, *, smallest: bool = False) -> list[Motion]:
    """Motions among which the one that limits the time step is; see the module.

    ``smallest`` : as if all disks had the smallest mass.
    """
    force = largest_force(problem)
    pair, wall = (_constants(force, *laws) for laws in zip(*problem.laws, strict=True))
    kn, nun, kt, nut, kr, nur = pair
    small = float(problem.packing.radius.min())
    turn = 2.0 * NEIGHBOURS / MOMENT
    motions: list[Motion] = [(NEIGHBOURS * kn, NEIGHBOURS * kt, NEIGHBOURS * (nun + nut)), (0.0, turn * kt, turn * nut)]
    if kr:
        motions.append((0.0, 0.25 * turn * kr, 0.25 * turn * nur))
    motions += _at_wall(pair, wall, ON_FLOOR, 1) + _at_wall(pair, wall, IN_CORNER, 2)
    mass = float(problem.packing.mass.min())
    if smallest:
        return [(direct / mass, spring / mass, damping / mass) for direct, spring, damping in motions]
    around = float(np.pi / np.arcsin(1.0 / (1.0 + small)))  # how many disks of radius 1 fit, not a whole number
    at_wall = _at_wall(pair, wall, 0.25 * around, 1) + _at_wall(pair, wall, 0.125 * around, 2)
    motions += [(direct / mass, spring / mass, damping / mass) for direct, spring, damping in at_wall]
    half = 0.5 * around / mass
    motions += [(half * kn, half * kt, half * (nun + nut)), (0.0, 4 * half * kt, 4 * half * nut)]
    if kr:  # the arm of its rolling is small / (1 + small)
        part = 4 * half / (1.0 + small) ** 2
        motions.append((0.0, part * kr, part * nur))
    return motions


def stability_limit(problem: Problem, integrator: str | None = None, *, smallest: bool = False) -> float:
    """Estimated largest stable time step in sqrt(R/g).

    ``integrator`` : that of the scene unless given. ``smallest`` : as if all disks had the mass of the smallest; the
    estimate is then on the safe side for a disordered packing, by up to that mass.
    """
    name = problem.scene.protocol.integrator if integrator is None else integrator
    motions = stiffest_motions(problem, smallest=smallest)
    return min(oscillator_limit(name, direct, damping, spring) for direct, spring, damping in motions)


def _chosen(problem: Problem) -> tuple[float, str]:
    """The time step of a scene's dynamics, and where it comes from.

    Among poured disks and in own packings, where small ones may gather, the paper's counts as stable where it is so if
    all were the smallest: three small disks that touch in a poured packing of two sizes bear 0.92 of the estimate, and
    above it never rest.
    """
    step = problem.scene.protocol.time_step
    if not (step is None or step == "auto"):
        return float(step), "protocol.time_step"
    reason = f"auto: {SAFETY:g} of the stability limit"
    if step is None:
        if stability_limit(problem, smallest=problem.scene.small_disks_gather) >= PAPERS_TIME_STEP:
            return PAPERS_TIME_STEP, "the paper's"
        reason += f", as the paper's {PAPERS_TIME_STEP:g} is unstable for this scene"
    return SAFETY * stability_limit(problem, smallest=True), reason


def resolve_time_step(problem: Problem) -> float:
    """The scene's time step, or the one that is taken where it gives none (see :func:`time_step_reason`).

    Raises
    ------
    UnstableTimeStep
        When the given step exceeds the limit.
    """
    step = _chosen(problem)[0]
    if step == problem.scene.protocol.time_step and step > (limit := stability_limit(problem)):
        raise UnstableTimeStep(
            f"protocol.time_step: {step:g} is unstable with {problem.scene.protocol.integrator}, "
            f"must be at most {limit:.3g} for this scene, or auto"
        )
    return step


def motion_step(problem: Problem, energy: float, force: float = 0.0) -> float:
    """The time step of a motion: that of the scene, or without one a step that resolves its collisions too.

    ``energy``, ``force`` : with which the disks hit each other (mg R), and press at the start, at most: with laws that
    stiffen they make collisions short.
    """
    step, mass = resolve_time_step(problem), float(problem.packing.mass.min())
    if problem.scene.protocol.time_step is not None:
        return step
    for law, moving in ((problem.pair_law, 0.5 * mass), (problem.wall_law, mass)):
        force = least = max(largest_force(problem), force)
        for _ in range(20):
            force = max(least, math.sqrt(2.0 * energy * law.stiffest(force)))
        elastic = law.normal_damping == 0.0 and not problem.rotations
        duration = math.pi * math.sqrt(moving / law.stiffest(force))
        step = min(step, duration / (ELASTIC_COLLISION_STEPS if elastic else COLLISION_STEPS))
    return step


def breathing_time(problem: Problem) -> float:
    """Period of the vertical breathing of a packing, the motion that lasts longest in a fall, in sqrt(R/g).

    A wave of compression up and down twice. Measured in ordered slabs of 15, 30, 60 and 160 layers: 0.825, 1.64, 3.26
    and 8.8, which are speeds of 2.24 to 2.31 sqrt(k R/m).
    """
    return 4.0 * float(problem.packing.position[:, 1].max()) / (2.3 * problem.stiffness**0.5)


class Pace(NamedTuple):
    """How a fall goes on once its first swings are over."""

    integrator: str
    time_step: float
    after: float  #: time since gravity is whole, in sqrt(R/g)


def later_pace(problem: Problem) -> Pace | None:
    """The larger steps with which a fall goes on; None where it does not.

    Most of the time-step error of a fall is made in its first swings. Leapfrog bears the longest steps.
    """
    if not problem.plan.larger_steps:
        return None
    first = resolve_time_step(problem)
    limit = stability_limit(problem, LATER, smallest=problem.scene.small_disks_gather)
    step = min(LATER_SAFETY * limit, MOST_LONGER * first)
    after = max(FIRST_PERIODS * breathing_time(problem), problem.swing_time)
    return Pace(LATER, step, after) if step > first else None


def expected_fall(problem: Problem) -> tuple[float, float]:
    """About how many time steps a fall takes, and seconds on one core. Ordered slabs take 0.8 to 1.3 of these steps.

    The breathing decays with the rate omega^2 nu / (2 k), so the time grows as the square of the height.
    """
    first, pace, law = resolve_time_step(problem), later_pace(problem), problem.pair_law
    rate = 0.5 * (2.0 * math.pi / breathing_time(problem)) ** 2 * law.normal_damping / law.normal_stiffness
    time = -math.log(problem.plan.stop_acceleration or AT_REST) / max(rate, 1e-300)
    early = time if pace is None else min(time, pace.after)
    steps = early / first + (0.0 if pace is None else (time - early) / pace.time_step)
    return steps, steps * problem.n * SECONDS_A_DISK


def long_fall(problem: Problem) -> str:
    """What a progress says of a fall that takes minutes; nothing of others."""
    steps, seconds = expected_fall(problem)
    if not (problem.plan.static and seconds > LONG):
        return ""
    return (
        f": some {round(steps, -4):.0f} steps, about {seconds / 60.0:.0f} min (preparation.gravity: frictionless takes "
        "less and leads to another equilibrium)"
    )


def time_step_reason(problem: Problem) -> str:
    """Where the time step of a scene's dynamics comes from."""
    return _chosen(problem)[1]


def time_steps_taken(problem: Problem, rest: State) -> str:
    """Which time steps a fall to ``rest`` took, and in large packings what error they are known to leave."""
    reached, said = rest.reached, time_step_reason(problem)
    if reached.time_step is None or problem.n <= LARGE:
        return said
    if reached.first_steps:
        said = f"{said} {reached.first_time_step:g} for {reached.first_steps} steps, then {LATER} with "
        said += f"{reached.time_step:.4g} for {(reached.steps or 0) - reached.first_steps}"
    sizes, errors = np.log([*TIME_STEP_ERROR]), np.log([*TIME_STEP_ERROR.values()])
    error = math.exp(float(np.interp(math.log(problem.n), sizes, errors)))
    known = f"{'more than' if problem.n > max(TIME_STEP_ERROR) else 'about'} {error:.1e}"
    return f"{said}; in ordered slabs of this size the time step leaves an error of {known} mg in floor forces"
