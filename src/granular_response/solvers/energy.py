"""Frictionless equilibrium as a minimum of the potential energy.

    E(q) = sum of contact energies - f q,    (K + lambda) dq = f + F(q)

with contact forces F, gravity and loads f. Newton's method with damping lambda (K. Levenberg, Quart. Appl. Math. 2,
164, 1944): the Hessian is the tangent stiffness K with its geometric part, and the damping grows when a step does not
lower the energy as much as its quadratic model says. It starts from any configuration, the bare lattice included, and
ends in a minimum: a saddle, which a symmetric start may lead to, is left along its unstable direction.

:func:`minimise` repeats: damped step, its length (:mod:`.line_search`), new damping; at equilibrium, whether it is a
minimum (:mod:`.stability`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import EquilibriumError, require
from ..state import FloatArray, Reached, State
from .equilibrium import Rearranged, attainable, certify, external_force
from .line_search import shortened
from .problem import Problem
from .stability import Spectrum
from .system import OPTIONS as SYSTEM
from .system import StaticSystem, Trial


@dataclass(frozen=True)
class MinimiseOptions:
    """Numbers by which a minimisation goes. Dampings in units of the normal stiffness, lengths in mean radii."""

    #: Most iterations.
    iterations: int = 2000
    #: Iterations between two looks at whether the packing has rearranged.
    look_every: int = 10
    #: No disk moves farther than this in one step.
    longest_step: float = 0.2
    #: A step that gains less than this part of what its quadratic model says is shortened, and damping grows.
    poor: float = 0.25
    #: Factor of the damping after a poor step, and of its inverse after a good one.
    more: float = 10.0
    #: First damping.
    first_damping: float = 1e-3
    #: Where factorisations are expensive, in packings of more disks than this, the search begins little damped, and a
    #: saddle is left as soon as one is near: when the stiffness is not positive though little damped and no force out
    #: of balance exceeds that many disk weights. The rest state of 57,660 disks takes 2.1 times as long without.
    large: int = 20_000
    near_saddle: float = 0.1
    #: First length along an unstable direction there, times the normal stiffness.
    shortest_escape: float = 1e-3

    @property
    def little_damped(self) -> float:
        """Least damping where the stiffness of the springs alone makes a step, and the first of large packings."""
        return 10.0 * SYSTEM.soft


OPTIONS = MinimiseOptions()

REARRANGES = (
    "disks leave their neighbours on the way to a minimum of the energy: take protocol.method: dynamics, or a larger "
    "contact.normal_stiffness, in proportion to the height of the packing"
)


def energy(system: StaticSystem, trial: Trial, external: FloatArray) -> float:
    """Elastic energy of the contacts minus the work of the external forces."""
    return system.elastic_energy(trial.configuration.overlap) - float(external @ trial.configuration.q)


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
    require(not problem.rotations, "method minimise needs a scene without friction; use path or dynamics")
    descent = _Descent(problem, start, load_factor)
    while not descent.at_minimum():
        rule = f"no minimum of the energy within {OPTIONS.iterations} iterations"
        require(descent.iterations < OPTIONS.iterations, rule, EquilibriumError)
        descent.go_on()
    state = descent.system.state(descent.trial, load_factor)
    certificate = certify(problem, state, modes=0, undetermined=descent.undetermined)
    reached = Reached("minimise", certificate, newton_iterations=descent.iterations, escapes=descent.escapes)
    return replace(state, reached=reached)


class _Descent:
    """A configuration on its way down, and how much its steps are damped."""

    def __init__(self, problem: Problem, start: State, load_factor: float) -> None:
        self.problem, self.stiffness = problem, problem.stiffness
        self.system = StaticSystem(problem, start)
        self.external = external_force(problem, load_factor)
        self.known = self.system.start(start)
        self.damping = (OPTIONS.little_damped if self._large else OPTIONS.first_damping) * self.stiffness
        self.iterations = self.escapes = 0
        self.undetermined: tuple[int, ...] = ()  #: disks that nothing determines at the last equilibrium looked at
        q = self.system.displaced(self.known.q, load_factor).copy()
        self._move(q, self.system.trial(self.known, q))

    def _move(self, q: FloatArray, trial: Trial) -> None:
        self.q, self.trial = q, trial
        self.value = energy(self.system, trial, self.external)
        self.unbalanced = trial.contact_force + self.external
        self.size = float(np.abs(self.unbalanced).max())
        self.tolerance = attainable(self.system, q)

    @property
    def _large(self) -> bool:
        return self.problem.n > OPTIONS.large

    def _settled(self) -> bool:
        return self.size < 0.01 * SYSTEM.tolerance or (self.size < self.tolerance and self.damping == 0.0)

    def at_minimum(self) -> bool:
        """Whether nothing is out of balance and the stiffness is positive; looks for rearrangements now and then."""
        settled = self._settled()
        look = settled or self.iterations % OPTIONS.look_every == OPTIONS.look_every - 1
        require(not look or not self.system.meets_unlisted(self.q), REARRANGES, Rearranged)
        if not settled:
            return False
        spectrum = Spectrum(self.system, self.trial)
        if not spectrum.stiff and spectrum.negative_modes != 0:
            return False
        self.undetermined = spectrum.undetermined
        return spectrum.negative_modes == 0

    def go_on(self) -> None:
        """One iteration: away from a saddle, or a damped step, or more damping where a step would be no good."""
        if self._settled():
            self._leave_saddle()
            return
        shift = self.damping + SYSTEM.regularisation * self.stiffness
        step = self.system.definite_step(self.trial, self.unbalanced, shift)
        self.iterations += 1
        if step is None:
            near = self.size < OPTIONS.near_saddle and self.damping < SYSTEM.soft * self.stiffness
            if self._large and near and self.escapes < SYSTEM.patience:
                self.escapes += 1
                self._go_down_from_saddle()
                return
            springs = self.system.without_prestress(self.trial)
            shift = max(self.damping, OPTIONS.little_damped * self.stiffness)
            step = self.system.definite_step(springs, self.unbalanced, shift)
        if step is None:
            self._damp(OPTIONS.more)
            return
        length = float(np.abs(step).max())
        if length > OPTIONS.longest_step:
            rule = "the minimisation found no minimum: part of the packing falls"
            require(np.isfinite(length) and self.damping <= 1e6 * self.stiffness, rule, EquilibriumError)
            self._damp(4.0)
            return
        self._take(step)

    def _leave_saddle(self) -> None:
        rule = "the minimisation keeps returning to a saddle of the energy"
        require(self.escapes != SYSTEM.patience, rule, EquilibriumError)
        self.escapes += 1
        self.iterations += 1
        if self._large:
            self._go_down_from_saddle()
        else:
            q = self.q + 1e-4 * Spectrum(self.system, self.trial).direction
            self._move(q, self.system.trial(self.known, q))
            self.damping = 1e-4 * self.stiffness

    def _go_down_from_saddle(self) -> None:
        """Go from near a saddle along its unstable direction, in doubled lengths as long as energy falls."""
        direction = Spectrum(self.system, self.trial).direction
        best = (self.q, self.trial)
        for sense in (1.0, -1.0):
            length = OPTIONS.shortest_escape / self.stiffness * sense
            while abs(length) < OPTIONS.longest_step:
                q = self.q + length * direction
                there = self.system.trial(self.known, q)
                if sense * float((there.contact_force + self.external) @ direction) <= 0.0:
                    break
                best = (q, there)
                length *= 2.0
            if best[1] is not self.trial:
                break
        self._move(*best)
        self.damping = SYSTEM.soft * self.stiffness

    def _damp(self, factor: float) -> None:
        self.damping = max(factor * self.damping, 1e-8 * self.stiffness)

    def _shorter(self, step: FloatArray, slope: float, full: Trial) -> tuple[FloatArray, Trial]:
        beyond = OPTIONS.poor if self._large else 0.0
        return shortened(
            self.system, self.known, self.external, self.q, step, slope, full=full, until=OPTIONS.poor, beyond=beyond
        )

    def _take(self, step: FloatArray) -> None:
        """Take a step, or the part of it that is good for something, and set the damping by how good it was."""
        slope = float(step @ self.unbalanced)
        new = self.system.trial(self.known, self.q + step)
        new_value = energy(self.system, new, self.external)
        predicted = 0.5 * slope + 0.5 * self.damping * float(step @ step)
        rounding = 1e-11 * (abs(self.value) + 1.0)
        if predicted > rounding:
            ratio = (self.value - new_value) / predicted
            if ratio < OPTIONS.poor:
                step, new = self._shorter(step, slope, new)
                if energy(self.system, new, self.external) > self.value:
                    self._damp(OPTIONS.more)
                    return
        elif self._large:
            # Energies have lost their digits, slopes have not.
            step, new = self._shorter(step, slope, new)
            ratio = 1.0
        else:
            new_size = float(np.abs(new.contact_force + self.external).max())
            if new_size >= 2.0 * self.size and new_size >= self.tolerance:
                self._damp(OPTIONS.more)
                return
            ratio = 1.0
        self._move(self.q + step, new)
        if ratio > 0.5:
            self.damping = self.damping * (1.0 / OPTIONS.more) if self.damping > 1e-9 * self.stiffness else 0.0
        elif ratio < OPTIONS.poor:
            self._damp(OPTIONS.more)
