"""Static equilibrium by Newton iterations on the true contact law, and its certificate.

    F(q; s) + f = 0,    K dq = F + f

with contact forces F at displacements q from a configuration with springs s, gravity and loads f, and the tangent
K = -dF/dq. Which contacts are open, stick or slide is decided by the return map inside each residual, so the iteration
is a semi-smooth Newton method: near a solution it ends in a few steps with residuals at rounding.

:func:`newton` solves one increment; :func:`finish` brings a nearly settled motion to rest with it, and certifies.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..contact.coulomb import limit
from ..errors import EquilibriumError
from ..state import EXCESSES, Certificate, FloatArray, State
from .free import least_at_rest, solved_by, suspicious
from .overlaps import too_deep
from .problem import Problem
from .stability import Spectrum
from .system import OPTIONS as SYSTEM
from .system import Configuration, StaticSystem, Trial


@dataclass(frozen=True)
class NewtonOptions:
    """Numbers by which Newton's method on the true contact law goes. Forces in mean weights, lengths in mean radii."""

    #: Most factorisations in a try to end a motion: of 24 tries that led to an equilibrium the longest took 13.
    tries: int = 15
    #: Of these, how many take whole steps before a search along the step begins: where contacts change their status in
    #: turn, whole steps go round in a circle.
    whole_steps: int = 5
    #: How often a step is halved.
    halvings: int = 5
    #: A step moves no disk farther than this.
    longest_step: float = 0.05
    #: Part to which the force along a step (the slope of the energy, where there is one) falls in a line search.
    flat: float = 0.1
    #: Farthest way of a disk in the static finish of a motion: what is farther is another equilibrium than the one that
    #: the motion was ending in.
    farthest: float = 0.1
    #: Friction below which it may not find which contacts slide.
    least_friction: float = 1e-4


OPTIONS = NewtonOptions()


class Rearranged(EquilibriumError):
    """Disks have met that were not neighbours: equilibrium is not near the start."""


def external_force(problem: Problem, load_factor: float) -> FloatArray:
    """(dof,) gravity and the scene's loads times ``load_factor``; nothing on what is held."""
    return problem.weight_vector + load_factor * problem.load_vector


def attainable(system: StaticSystem, q: FloatArray) -> float:
    """Unbalanced force to reach: the tolerance, or what the rounding of displacements leaves if that is more."""
    rounding = 4.0 * float(np.finfo(float).eps) * system.problem.stiffness
    return max(SYSTEM.tolerance, rounding * float(np.abs(q).max(initial=0.0)))


@dataclass(frozen=True)
class NewtonReport:
    """How a Newton solution went."""

    converged: bool
    iterations: int
    residual: float


def newton(
    system: StaticSystem,
    known: Configuration,
    external: FloatArray,
    start: FloatArray | None = None,
    *,
    maximum_iterations: int | None = None,
    backtracking: bool = False,
) -> tuple[Trial, NewtonReport]:
    """Solve for equilibrium under ``external``, one increment after ``known``.

    Steps are halved while the residual grows more than tenfold (a contact changing its status may raise it
    for a moment). With ``backtracking``, after ``NewtonOptions.whole_steps`` of them, the longest part of a step that
    lowers the 2-norm of the residual is taken. A factorisation serves as long as no contact changes its status and the
    residual falls tenfold with it.
    The end is a residual below ``SystemOptions.enough``, or below its ``tolerance`` where it falls no further.
    Returns the last trial and a report; ``report.converged`` says whether it is a solution,
    ``report.iterations`` counts factorisations, of which there are at most ``maximum_iterations``.
    """
    tolerance, most = SYSTEM.tolerance, SYSTEM.patience if maximum_iterations is None else maximum_iterations
    n = system.problem.n
    q = (known.q if start is None else start).copy()
    trial = system.trial(known, q)
    r = trial.contact_force + external  # (dof,) unbalanced force and torque on each disk
    size = float(np.abs(r).max(initial=0.0))
    best = size
    stalled = iterations = 0
    slow = False
    while True:
        if size < SYSTEM.enough or (size < tolerance and stalled):
            return trial, NewtonReport(True, iterations, size)
        try:
            factor = None if slow else system.kept_factor(trial)
            reused = factor is not None
            if factor is not None:
                step = system.deinterleave(factor.solve(system.interleave(r)))
            else:
                if iterations == most:
                    break
                iterations += 1
                step = system.step(trial, r)
        except RuntimeError:  # exactly singular
            break
        if not np.isfinite(step).all():
            break
        length = float(np.abs(step[: 2 * n]).max())
        if suspicious(system, length, size) and (by := system.kept_factor(trial)) is not None:
            step = least_at_rest(system, solved_by(system, by), step, r)
            length = float(np.abs(step[: 2 * n]).max())
        scale = min(1.0, OPTIONS.longest_step / length) if length > 0 else 1.0
        search = backtracking and iterations > OPTIONS.whole_steps
        for part in 0.5 ** np.arange(OPTIONS.halvings + 1):
            new = system.trial(known, q + part * scale * step)
            r_new = new.contact_force + external
            size_new = float(np.abs(r_new).max())
            lower = np.linalg.norm(r_new) < np.linalg.norm(r) if search else size_new < 10.0 * size
            if lower or size_new < tolerance:
                break
        scale *= part
        slow = reused and size_new > 0.1 * size
        if slow and size_new > size:
            continue  # this step is not taken
        q, trial, r, size = q + scale * step, new, r_new, size_new
        stalled = stalled + 1 if size > 0.5 * best else 0
        best = min(best, size)
    return trial, NewtonReport(size < tolerance, iterations, size)


def unbalanced(problem: Problem, state: State) -> tuple[FloatArray, FloatArray]:
    """(n, 2) force and (n,) torque on each disk: contacts, weight and loads, but not what holds a displaced disk.

    Summed anew from the state's contact forces, not taken from the solver.
    """
    n, radius = problem.n, problem.packing.radius
    pairs, walls = state.pairs, state.walls
    on_pairs, on_walls = state.pair_force(), state.wall_force()
    disk = np.concatenate([np.arange(n), problem.load_disk, pairs.first, pairs.second, walls.first])
    load = state.load_factor * problem.load
    weight = np.stack([np.zeros(n), -problem.weight], axis=1)
    pushes = np.concatenate([weight, load[:, :2], on_pairs, -on_pairs, on_walls])
    force = np.stack([np.bincount(disk, along, n) for along in pushes.T], axis=1).astype(float, copy=False)
    tangential = np.concatenate([pairs.tangential_force, pairs.tangential_force, walls.tangential_force])
    turned = -radius[disk[n + len(load) :]] * tangential
    torque = np.asarray(np.bincount(disk, np.concatenate([np.zeros(n), load[:, 2], turned]), n), float)
    if len(problem.laws) > 1:
        at_pairs, at_walls = state.couples(radius)
        np.add.at(torque, pairs.first, at_pairs)
        np.add.at(torque, pairs.second, -at_pairs)
        np.add.at(torque, walls.first, at_walls)
    return force, torque


def reaction(problem: Problem, state: State) -> FloatArray:
    """(l, 2) force with which each load holds its disk at its displacement; 0 along directions that are free."""
    force, _ = unbalanced(problem, state)
    held = problem.held
    result = np.zeros((len(problem.load_disk), 2))
    result[held.load, held.axis] = -force[held.disk, held.axis]
    return result


def certify(
    problem: Problem, state: State, *, modes: int | None = None, undetermined: tuple[int, ...] = ()
) -> Certificate:
    """Measure a state's certificate from its own positions and contact forces.

    ``modes`` : unstable directions of its tangent, where they have been counted; ``undetermined`` : disks that a motion
    without resistance moves. A disk that is not where a load holds
    it counts as out of balance by what one contact would feel.
    """
    n, held = problem.n, problem.held
    force, torque = unbalanced(problem, state)
    force[held.disk, held.axis] = problem.stiffness * held.shift(state.position, state.load_factor)
    excess, smallest = [0.0, 0.0], np.inf
    for contacts, laws, _ in problem.kinds(state):
        closed, normal = contacts.touching, contacts.normal_force
        smallest = min(smallest, float(normal[closed].min(initial=np.inf)))
        for row, (law, borne) in enumerate(zip(laws, contacts.forces, strict=False)):
            over = np.abs(borne) - limit(law, np.abs(normal))
            excess[row] = max(excess[row], float(over[closed].max(initial=0.0)))
    bears = np.maximum(problem.weight, state.largest_normal_force())
    turned = np.abs(torque) / problem.packing.radius if problem.rotations else np.zeros(n)
    energy = 0.5 * (problem.weight * (state.velocity**2).sum(axis=1)).sum()
    energy += 0.5 * (problem.packing.inertia * state.angular_velocity**2).sum()
    return Certificate(
        force_residual=float(np.abs(force).max()),
        torque_residual=float(np.abs(torque).max()) if problem.rotations else 0.0,
        smallest_normal_force=smallest,
        kinetic_energy=float(energy) / n,
        negative_modes=modes,
        loose_disks=int((state.contact_count() < 2).sum()),
        unbalanced_part=float((np.maximum(np.abs(force).max(axis=1), turned) / bears).max()),
        undetermined=undetermined,
        **dict(zip(EXCESSES, excess, strict=True)),
    )


def check_overlaps(problem: Problem, state: State) -> None:
    """Refuse a state whose contacts mean nothing any more: raises EquilibriumError where some are too deep."""
    if deep := too_deep(problem, state):
        cure = "a smaller load or a larger contact.normal_stiffness"
        if state.load_factor == 0.0:  # no load does this, whatever the scene has
            cure = "a larger contact.normal_stiffness"
        raise EquilibriumError(f"{deep} at load factor {state.load_factor:g}, as much as a radius: take {cure}")


def _cure(problem: Problem) -> str:
    """What helps where Newton's method does not converge."""
    for name, friction in (("contact", problem.pair_law.friction), ("wall", problem.wall_law.friction)):
        if 0.0 < friction < OPTIONS.least_friction:
            return (
                f"{name}.friction = {friction:g} is so small that contacts slide back and forth at zero force: "
                f"take 0, or at least {OPTIONS.least_friction:g}"
            )
    return "relax it further first"


def finish(problem: Problem, state: State, *, maximum_iterations: int | None = None) -> State:
    """Bring a nearly settled state to rest by Newton iterations (Sec. III.C), with its certificate.

    Springs start from the state's own, so friction remembers what it went through. Ordered packings backtrack: in
    disordered ones that saved none of ten tries which failed without, and lost one.

    Raises
    ------
    EquilibriumError
        When the state is too far from rest for Newton's method, or what that finds is far away or no equilibrium of
        each disk: relax it further first.
    """
    factor = state.load_factor
    system = StaticSystem(problem, state)
    known = system.start(state)
    external, ordered = external_force(problem, factor), problem.packing.ordered
    trial, report = newton(system, known, external, maximum_iterations=maximum_iterations, backtracking=ordered)
    if not report.converged:
        raise EquilibriumError(
            f"no static equilibrium within {report.iterations} Newton iterations of the state "
            f"(largest unbalanced force {report.residual:.1e}); {_cure(problem)}"
        )
    solved = system.state(trial, factor)
    moved = float(np.hypot(*(solved.position - state.position).T).max())
    if moved > OPTIONS.farthest or system.meets_unlisted(trial.configuration.q):
        raise EquilibriumError(
            f"the equilibrium that Newton's method finds is {moved:.2g} mean radii away; {_cure(problem)}"
        )
    spectrum = Spectrum(system, trial)
    undetermined = spectrum.undetermined
    certificate = certify(problem, solved, modes=spectrum.negative_modes, undetermined=undetermined)
    if not certificate.balanced:
        raise EquilibriumError(
            f"a disk is out of balance by {certificate.unbalanced_part:.1g} of what it bears; {_cure(problem)}"
        )
    reached = replace(
        state.reached, newton_iterations=report.iterations, certificate=certificate, finish_displacement=moved
    )
    return replace(solved, reached=reached)
