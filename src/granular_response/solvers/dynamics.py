"""Relaxation by explicit dynamics: the discrete element method.

    M q'' = F(q, q', s) + gravity + loads

with displacements and angles q, masses and moments of inertia M, and contact forces F by the law of Sec. III.A, of
which the tangential springs s remember the slip (P. A. Cundall and O. D. L. Strack, Geotechnique 29, 47, 1979).

A :class:`Dynamics` advances one packing by an explicit integrator (``kernels.integrators``); :func:`relax` starts ramps
of gravity or load and looks at it until it is at rest. Two criteria of Sec. III.C end it: the kinetic energy, or the
mean acceleration of the disks that bear others, which does not depend on the size of the packing. Disks that touch
nothing but the floor may roll for ever; their rolling is left out of the kinetic energy that decides, and does not
accelerate them. A packing of which a part is in flight is not at rest, however slow it is.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..errors import SolveError
from ..kernels.forces import SCRATCH, forces
from ..kernels.integrators import INTEGRATORS, LOOK_EVERY, Memory, advance
from ..kernels.model import Model, Pairs, Schedule, Walls, rows, springs_of
from ..kernels.neighbours import count_closed, mark_closed
from ..machine.lanes import WIDTH, aligned, aligned_zeros
from ..machine.machine_code import kind, typed
from ..state import FLOOR, FloatArray, Reached, State, wall_normals
from .candidates import Candidates, list_candidates
from .overlaps import overlap_at_start
from .problem import Problem
from .springs import carry_springs, spring_contacts

Ramp = tuple[float, float, float]


def ramped(ramp: Ramp, time: float) -> float:
    """Where a ramp is at a time, as ``kernels.integrators.stepping.ramp`` has it."""
    start, end, duration = ramp
    return float(end if time >= duration else start + (end - start) * (time / duration))


@dataclass(frozen=True)
class RelaxationOptions:
    """Numbers by which a relaxation is watched, and by which it is judged to be at rest or lost."""

    #: Steps between two looks at the stopping criteria: a look costs as much as some steps.
    check_every: int = 100
    #: Looks between two at whether some disks roll freely.
    rolling_checks: int = 10
    #: Least number of readings of the acceleration over half a swing, which is too short for more in a small packing.
    readings: int = 10
    #: Largest part of all disks that may roll fast.
    most_rollers: float = 0.1
    #: Kinetic energy over its limit up to which a packing is nearly at rest: any number of disks may roll then, and one
    #: whose steps have run out may be in equilibrium all the same.
    nearly: float = 1e3
    #: Way of a disk between two looks at displacements from which on its motion has blown up (mean radii).
    blown_up: float = 5.0
    #: Gap above everything else from which on a disk that its load pulls up is torn off (mean radii).
    torn_off: float = 5.0
    #: Some swings of the slowest modes of the paper's slabs, in sqrt(R/g): over them the envelope of the kinetic energy
    #: is taken, of which a single reading is low long before they have died out.
    swings: float = 20.0
    #: Kinetic energy per disk that is rounding: what is left of it need not fall any more.
    motionless: float = 1e-24
    #: Part of its weight by which forces on a part of a packing that touches nothing may be out of balance: rounding.
    floats: float = 1e-9
    #: Kinetic energy of a disk that still rolls, over the mean of those that bear others, where accelerations decide.
    rolls: float = 10.0
    #: Acceleration of a disk with fewer than two contacts from which on it falls, or rolls down another one (g).
    falling: float = 0.1


OPTIONS = RelaxationOptions()


class DynamicsError(SolveError, RuntimeError):
    """A run that blew up."""


@dataclass(frozen=True)
class Stop:
    """When a relaxation ends.

    ``kinetic_energy`` per disk (units of mean weight times mean radius); ``rule``: ``instantaneous`` stops at
    the first reading below it, ``envelope`` when the largest of the last ``RelaxationOptions.swings`` is.
    ``least_time`` since the ramps began: what starts without motion and out of balance has no kinetic energy yet.
    ``fallen`` : part of its largest value since then to which the kinetic energy must have fallen.
    ``acceleration`` : a relaxation also ends when :meth:`Dynamics.unrest` has been below it for half a period of the
    slowest motion (``Problem.swing_time``), in units of g; 0: not by it.
    """

    kinetic_energy: float = 1e-13
    rule: str = "instantaneous"
    maximum_steps: int = 5_000_000
    least_time: float = 0.0
    fallen: float = 1.0
    acceleration: float = 0.0

    @classmethod
    def of(cls, problem: Problem) -> Stop:
        """When a scene's dynamics ends, by its plan and its protocol."""
        plan, protocol = problem.plan, problem.scene.protocol
        by_energy = cls(plan.stop_energy, protocol.stop_rule, protocol.maximum_steps, problem.crossing_time)
        return replace(by_energy, acceleration=plan.stop_acceleration)


class Dynamics:
    """One packing in motion.

    Parameters
    ----------
    problem : the scene's arrays (with loads chosen, if it has any).
    state : where to start: positions, angles, velocities and springs are taken over.
    integrator : a name in ``kernels.integrators.INTEGRATORS``.
    time_step : in units of sqrt(R/g).
    uncut : whether the motion has the same bits wherever :meth:`advance` cuts it; candidates are listed elsewhere then.
    """

    def __init__(
        self, problem: Problem, state: State, integrator: str = "beeman", time_step: float = 5e-4, *, uncut=False
    ) -> None:
        self.problem = problem
        self.integrator = INTEGRATORS[integrator]
        self.time_step = float(time_step)
        self.uncut = uncut
        self.steps = self.began = self.rebuilds = 0
        self.time = 0.0
        self.gravity: Ramp = (1.0, 1.0, 0.0)
        self.load: Ramp = (0.0, 0.0, 0.0)
        n, freedoms = problem.n, problem.freedoms
        self.angle0 = state.angle.copy()
        self.v = aligned(np.concatenate([state.velocity.T.ravel(), state.angular_velocity])[: n * freedoms])
        self.q = aligned_zeros(n * freedoms)
        rows = aligned_zeros(self.integrator.rows + 1, n * freedoms + -n * freedoms % WIDTH)
        self.history = rows[:-1]
        b, c = ([*self.history[1:], None, None])[:2]
        self.rows = Memory(self.history[0], b, c, force=rows[-1], seen=aligned_zeros(n * freedoms))
        self.rim = aligned_zeros(n) if problem.rotations else None
        self._held = problem.held.unknowns(n)
        self._inverse_mass = aligned(problem.inverse_mass)
        self._inverse_mass[self._held] = 0.0  # no force accelerates what is held
        self._list(state)
        self._fill_history()

    def _list(self, state: State, stride: float = 0.0) -> None:
        """List candidates around a state's positions and take over its springs."""
        problem = self.problem
        self.candidates: Candidates = list_candidates(problem.packing, problem.laws[0], state.position, stride)
        c = self.candidates
        pair_laws, wall_laws = zip(*problem.laws, strict=True)
        springs = [c.in_slots(row) for row in carry_springs(problem.n, state.pairs, c.first, c.second)]
        wall_springs = carry_springs(problem.n, state.walls, c.wall_disk, c.wall)
        arm, wall_arm = problem.arms(c.first, c.second, c.wall_disk)
        pair_rows = rows(pair_laws, springs, c.in_slots(arm), aligned_zeros(problem.n))
        self.model = Model(
            problem.n, problem.weight, self._inverse_mass, problem.packing.radius, self.rim,
            problem.load, problem.load_disk,
            Pairs(
                c.runs, c.separation[0], c.separation[1], c.reach, c.shape, *pair_rows,
                aligned_zeros(SCRATCH), problem.pair_law,
            ),
            Walls(
                c.wall_disk, wall_normals(c.wall), c.wall_gap, c.wall_shape,
                *rows(wall_laws, wall_springs, wall_arm), problem.wall_law,
            ),
            problem.rule,
        )  # fmt: skip
        self._advance_all = typed(advance, kind(self.integrator, self.rows, self.model))

    def _fill_history(self) -> None:
        self.history[:] = 0.0
        acceleration = self.history[0, : self.q.size]
        forces(self.q, self.v, acceleration, self._now(self.gravity), self._now(self.load), 0.0, self.model)
        acceleration *= self._inverse_mass
        self.integrator.begin(self.history)

    def _now(self, ramp: Ramp) -> float:
        """Where a ramp is now."""
        return ramped(ramp, self.time)

    def set_ramps(self, gravity: Ramp = (1.0, 1.0, 0.0), load: Ramp = (0.0, 0.0, 0.0)) -> None:
        """Start new linear ramps ``(from, to, duration)`` now; the clock restarts at zero."""
        self.gravity, self.load, self.time, self.began = gravity, load, 0.0, self.steps
        start, end, duration = load
        self._move_held((end - start) / duration if duration > 0.0 else 0.0)
        self._fill_history()

    def _move_held(self, rate: float) -> None:
        """Put held coordinates where the load factor has them now, and let them go on as it grows by ``rate``."""
        held = self.problem.held
        if len(held):
            self.q[self._held] = held.shift(self.candidates.reference, self._now(self.load))
            self.v[self._held] = rate * held.travel

    def advance(self, steps: int) -> None:
        """Advance by ``steps`` time steps, listing candidates again whenever disks have moved too far."""
        if self._held.size and self.v[self._held].any():
            ramp = math.ceil((self.load[2] - self.time) / self.time_step - 1e-6)
            self._advance(min(ramp, steps))
            if ramp > steps:
                return
            self.time = max(self.time, self.load[2])  # a rounding short of it
            self._move_held(0.0)
            steps -= ramp
        self._advance(steps)

    def _advance(self, steps: int) -> None:
        left = steps
        listed = False
        while left:
            start, taken = (0.0, self.steps - self.began) if self.uncut else (self.time, 0)
            schedule = Schedule(start, *map(float, self.gravity), *map(float, self.load))
            done = self._advance_all(
                self.integrator, left, self.time_step, schedule, self.candidates.limit,
                self.q, self.v, self.rows, self.model, taken,
            )  # fmt: skip
            self.steps += done
            self.time = start + (taken + done) * self.time_step
            left -= done
            if left:
                self._relist(self._stride() if done == 0 and listed else 0.0)
                listed = True

    def _stride(self) -> float:
        """How far the fastest disk gets until displacements are looked at again, and half as much more."""
        speed = float(np.hypot(*self.v[: 2 * self.problem.n].reshape(2, -1)).max())
        stride = 1.5 * speed * self.time_step * LOOK_EVERY
        if not stride < OPTIONS.blown_up:
            raise DynamicsError(self._blow_up())
        return stride

    def _relist(self, stride: float = 0.0) -> None:
        """List candidates again around the present positions, keeping every spring, for displacements up to ``stride``.

        Usual lists do for any motion but long steps of fast disks.
        """
        if not np.isfinite(self.q).all():
            raise DynamicsError(self._blow_up())
        state = self.state()
        self.angle0 = self.angle
        self._list(state, stride)
        self.q[:] = 0.0
        self.rebuilds += 1

    def _blow_up(self) -> str:
        load = float(np.abs(self.load[1] * self.problem.load[:, :2]).max(initial=0.0))
        if self.problem.too_soft:
            cure = self.problem.too_soft
        elif load > self.problem.stiffness:
            cure = f"the largest load, {load:.3g} mg, is more than the contacts bear: take a smaller one"
        else:
            cure = overlap_at_start(self.problem) or "take a smaller protocol.time_step"
        return f"the motion blew up after {self.steps} steps with time_step {self.time_step:g}; {cure}"

    @property
    def position(self) -> FloatArray:
        """(n, 2) disk centres now."""
        n = self.problem.n
        return self.candidates.reference + self.q[: 2 * n].reshape(2, n).T

    @property
    def angle(self) -> FloatArray:
        """(n,) rotations now."""
        n = self.problem.n
        return self.angle0 + self.q[2 * n :] if self.problem.rotations else self.angle0

    def state(self) -> State:
        """The present state, with spring forces only (what remains at rest)."""
        problem, c, n = self.problem, self.candidates, self.problem.n
        bare = State(
            position=self.position,
            angle=self.angle.copy(),
            velocity=self.v[: 2 * n].reshape(2, n).T.copy(),
            angular_velocity=self.v[2 * n :].copy() if problem.rotations else np.zeros(n),
            pairs=spring_contacts(c.first, c.second, [row[c.slot] for row in springs_of(self.model.pairs)]),
            walls=spring_contacts(c.wall_disk, c.wall, [row.copy() for row in springs_of(self.model.walls)]),
            box=problem.packing.box,
            load_factor=self._now(self.load),
            reached=Reached(
                method="dynamics", steps=self.steps, time_step=self.time_step, time=self.time, rebuilds=self.rebuilds
            ),
        )
        return problem.with_static_forces(bare)

    def touching(self) -> NDArray[np.bool_]:
        """Which listed contacts (pairs, then walls) are closed now."""
        c = self.candidates
        closed = np.empty(len(c.first) + len(c.wall_disk), dtype=bool)
        mark_closed(
            self.q, self.problem.n, c.separation, c.reach, c.slot, (c.first, c.second),
            (c.wall_disk, self.model.walls.normal, c.wall_gap), closed,
        )  # fmt: skip
        return closed

    def contact_count(self, touching: NDArray[np.bool_] | None = None) -> NDArray[np.int64]:
        """(n,) number of closed contacts of each disk; ``touching`` if it is known."""
        c = self.candidates
        count = np.empty(self.problem.n, np.int64)
        count_closed(self.touching() if touching is None else touching, c.first, c.second, c.wall_disk, count)
        return count

    def kinetic_energy(self, *, bearing_only: bool = False) -> float:
        """Kinetic energy per disk; optionally of the disks with two contacts or more."""
        energies = 0.5 * self.v**2 / self.problem.inverse_mass
        if bearing_only:
            energies = energies.reshape(self.problem.freedoms, -1)[:, self.contact_count() >= 2]
        return float(energies.sum()) / self.problem.n

    def rolling(self, touching: NDArray[np.bool_], count: NDArray[np.int64]) -> tuple[int, float]:
        """How many disks touch the floor and nothing else, and the kinetic energy of their rolling per disk of all.

        They bear no load and may roll for ever. ``touching``, ``count`` : closed contacts, and how many each disk has.
        """
        c, n = self.candidates, self.problem.n
        on_floor = c.wall_disk[touching[len(c.first) :] & (c.wall == FLOOR)]
        rollers = on_floor[count[on_floor] == 1]
        energies = (0.5 * self.v**2 / self.problem.inverse_mass).reshape(-1, n)[::2, rollers]
        return len(rollers), float(np.cumsum(np.append(0.0, energies.T))[-1]) / n  # one after the other

    def in_flight(self, touching: NDArray[np.bool_]) -> bool:
        """Whether some disks fall: no chain of closed contacts leads to what could bear their weight."""
        problem, c = self.problem, self.candidates
        n = problem.n
        pair, wall = touching[: len(c.first)], touching[len(c.first) :]
        graph = coo_array((np.ones(int(pair.sum()), np.int8), (c.first[pair], c.second[pair])), shape=(n, n))
        parts, part = connected_components(graph, directed=False)
        held = np.zeros(parts, bool)
        held[part[c.wall_disk[wall & (problem.wall_friction | (c.wall == FLOOR))]]] = True
        held[part[problem.held.disk[problem.held.axis == 1]]] = True
        if held.all():
            return False
        weight = self._now(self.gravity) * problem.weight
        force = -weight
        np.add.at(force, problem.load_disk, self._now(self.load) * problem.load[:, 1])
        borne = np.bincount(part, weight, parts)
        return bool((np.abs(np.bincount(part, force, parts)) > OPTIONS.floats * borne)[~held].any())

    def lifted_disk(self) -> int | None:
        """A disk that its load has torn off the packing and carries up for good; None without one."""
        n, problem = self.problem.n, self.problem
        if not (self.load[1] * problem.load[:, 1] > 0.0).any():
            return None
        pull = self.load[1] * np.bincount(problem.load_disk, problem.load[:, 1], minlength=n)
        risen = np.flatnonzero(pull > problem.weight)
        if len(risen) == 0:
            return None
        z, radius = self.position[:, 1], problem.packing.radius
        rest = np.setdiff1d(np.arange(n), risen)
        top = float((z + radius)[rest].max(initial=0.0))
        gone = risen[(z - radius)[risen] > top + OPTIONS.torn_off]
        gone = gone[self.v[n + gone] > 0]
        return int(gone[0]) if len(gone) else None

    def mean_acceleration(self) -> float:
        """Mean magnitude of the acceleration of disks with two contacts or more, in units of g."""
        bearing = self.contact_count() >= 2
        return float(self._accelerations()[bearing].mean()) if bearing.any() else 0.0

    def unrest(self, count: NDArray[np.int64]) -> float:
        """The same, infinite while other disks fall; of all disks where none has two contacts.

        ``count`` (n,) : closed contacts of each disk.
        """
        size, bearing = self._accelerations(), count >= 2
        if float(size[~bearing].max(initial=0.0)) > OPTIONS.falling:
            return math.inf
        return float(size[bearing].mean() if bearing.any() else size.mean())

    def _accelerations(self) -> FloatArray:
        """(n,) their magnitudes, in units of g."""
        n = self.problem.n
        return np.hypot(self.history[0][:n], self.history[0][n : 2 * n])


def half_swing(problem: Problem, time_step: float) -> int:
    """How many looks half a swing takes, at least as many as a judgement needs."""
    return max(math.ceil(0.5 * problem.swing_time / (OPTIONS.check_every * time_step)), OPTIONS.readings)


class _Relaxation:
    """What has been seen of a relaxation so far."""

    def __init__(self, dynamics: Dynamics, stop: Stop, gravity: Ramp, load: Ramp):
        dynamics.set_ramps(gravity, load)
        self.dynamics = dynamics
        self.stop = stop
        self.started = dynamics.steps
        self.ramp_time = max(gravity[2], load[2])
        checks = max(1, round(OPTIONS.swings / (OPTIONS.check_every * dynamics.time_step)))
        self.envelope: deque[float] = deque(maxlen=checks if stop.rule == "envelope" else 1)
        self.unrest: deque[float] = deque(maxlen=half_swing(dynamics.problem, dynamics.time_step))
        self.network: NDArray[np.bool_] | None = None
        self.fixed = 0
        self.energy = self.largest = 0.0
        self.settled = self.rolling = False
        self.scale = 1e6 * (1.0 + abs(load[1]) * float(np.abs(dynamics.problem.load).sum()))

    @property
    def ended(self) -> bool:
        """Whether the packing is at rest, or ``maximum_steps`` have been taken."""
        return self.settled or self.dynamics.steps - self.started >= self.stop.maximum_steps

    @property
    def left(self) -> float:
        """What the stop compares with its limit: the largest acceleration of the last readings, or the energy."""
        return max(self.unrest, default=math.inf) if self.stop.acceleration > 0.0 else self.energy

    def look(self) -> None:
        """Judge the state after ``RelaxationOptions.check_every`` more steps."""
        dynamics, stop = self.dynamics, self.stop
        self.energy = energy = dynamics.kinetic_energy()
        if not energy < self.scale:
            raise DynamicsError(dynamics._blow_up())
        self.largest = max(self.largest, energy)
        fallen = max(stop.fallen * self.largest, OPTIONS.motionless)
        if dynamics.time < self.ramp_time:
            return
        if dynamics.load[1] and (lifted := dynamics.lifted_disk()) is not None:
            raise DynamicsError(f"a load lifts disk {lifted} off the packing for good; nothing can hold it")
        slow = energy < OPTIONS.nearly * stop.kinetic_energy
        watched = slow or stop.acceleration > 0.0
        look_at_rolling = (dynamics.steps // OPTIONS.check_every) % OPTIONS.rolling_checks == 0
        if not (watched or look_at_rolling or self.rolling):  # far from rest, whatever touches
            self.envelope.append(energy)
            self.settled, self.network = False, None
            return
        touching = dynamics.touching()
        count = dynamics.contact_count(touching)
        if look_at_rolling or (energy > min(stop.kinetic_energy, fallen) and (slow or self.rolling)):
            rollers, of_rolling = dynamics.rolling(touching, count)
            if look_at_rolling:
                self.rolling = 0 < rollers <= OPTIONS.most_rollers * dynamics.problem.n
            if slow or self.rolling:
                energy -= of_rolling
        self.envelope.append(energy)
        if watched:
            changed = self.network is None or not np.array_equal(touching, self.network)
            self.fixed = 0 if changed else self.fixed + OPTIONS.check_every
            self.network = touching
        ends = max(self.envelope) < stop.kinetic_energy and len(self.envelope) == self.envelope.maxlen
        ends = ends and energy <= fallen
        if stop.acceleration > 0.0:
            self.unrest.append(dynamics.unrest(count))
            ends = ends or (len(self.unrest) == self.unrest.maxlen and max(self.unrest) < stop.acceleration)
        self.settled = ends and dynamics.time >= stop.least_time and not dynamics.in_flight(touching)

    def state(self) -> State:
        """The state reached, with all that :class:`Reached` says of dynamics."""
        dynamics = self.dynamics
        state = dynamics.state()
        loose, problem = dynamics.contact_count() < 2, dynamics.problem
        # what rolls on the floor alone never stops by itself: its energy is left out of the criterion of rest
        energy = problem.weight * (state.velocity**2).sum(axis=1) + problem.packing.inertia * state.angular_velocity**2
        still = OPTIONS.rolls * dynamics.kinetic_energy(bearing_only=True) if self.stop.acceleration else 0.0
        rolling = int((loose & (0.5 * energy > max(self.stop.kinetic_energy, still))).sum()) if self.settled else 0
        reached = replace(
            state.reached,
            kinetic_energy=dynamics.kinetic_energy(),
            settled=self.settled,
            relaxation_steps=dynamics.steps - self.started,
            network_fixed_steps=self.fixed,
            sliding_contacts=int(state.pairs.sliding.sum() + state.walls.sliding.sum()),
            mean_acceleration=dynamics.mean_acceleration(),
            loose_disks=int(loose.sum()),
            stopped_rattlers=rolling or None,
        )
        return replace(state, reached=reached)


def relax(
    dynamics: Dynamics,
    stop: Stop,
    *,
    gravity: Ramp = (1.0, 1.0, 0.0),
    load: Ramp = (0.0, 0.0, 0.0),
    progress: Callable[[Dynamics, float], None] | None = None,
) -> State:
    """The state at rest after ramps of gravity and load that start now.

    Parameters
    ----------
    dynamics : the packing; ``stop`` : when it ends; ``gravity``, ``load`` : linear ramps ``(from, to, duration)``.
    progress : called with the dynamics, and with what the stop compares with its limit: the acceleration, infinite
        before the end of ramps and while disks fall, or the kinetic energy per disk.

    Raises
    ------
    DynamicsError
        When the motion blows up, or a load carries a disk off.
    """
    relaxation = _Relaxation(dynamics, stop, gravity, load)
    while not relaxation.ended:
        left = stop.maximum_steps - (dynamics.steps - relaxation.started)
        dynamics.advance(min(OPTIONS.check_every, left))  # not a step more than the scene allows
        relaxation.look()
        if progress is not None:
            progress(dynamics, relaxation.left)
    return relaxation.state()
