"""Contact laws and an integrator as somebody else would add them (docs/extending.md)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from pydantic import Field

from granular_response.contact import without_friction
from granular_response.scene import Scene
from granular_response.scene.base import Description, NonNegative, Positive
from granular_response.solvers.problem import Problem


class Cubic(NamedTuple):
    """Normal force by the third power of the overlap."""

    normal_stiffness: float
    normal_damping: float
    tangential_stiffness: float
    tangential_damping: float
    friction: float
    least_force: float
    factor: float

    @classmethod
    def of(cls, normal_stiffness, *constants):
        # stiffness 3 c xi^2 where c xi^3 = 1; the last constant is the reduced radius
        return cls(normal_stiffness, *constants[:-1], (normal_stiffness / 3.0) ** 3)

    def elastic_force(self, overlap, shape):
        return self.factor * overlap * overlap * overlap

    def stiffness(self, overlap, shape):
        return 3.0 * self.factor * overlap * overlap

    def energy(self, overlap, shape):
        return 0.25 * self.factor * overlap * overlap * overlap * overlap

    def shapes(self, first, second):
        return None

    def stiffest(self, force):
        return self.normal_stiffness * max(force, 0.0) ** (2.0 / 3.0)


class Cohesion(Description):
    """Parameters of the law below."""

    strength: NonNegative = Field(
        default=0.1, description="Pull of a contact while it is closed.", json_schema_extra={"unit": "mg"}
    )


class Cohesive(NamedTuple):
    """Linear springs, and a constant pull while in contact."""

    normal_stiffness: float
    normal_damping: float
    tangential_stiffness: float
    tangential_damping: float
    friction: float
    least_force: float
    strength: float

    only_motion = "a contact that pulls lets go at once, which statics does not follow"

    @classmethod
    def of(cls, *constants, strength):
        *constants, least_force, _ = constants
        return cls(*constants, least_force - strength, strength)

    def elastic_force(self, overlap, shape):
        return self.normal_stiffness * overlap - self.strength

    def stiffness(self, overlap, shape):
        return self.normal_stiffness

    def energy(self, overlap, shape):
        return (0.5 * self.normal_stiffness * overlap - self.strength) * overlap

    def shapes(self, first, second):
        return None

    def stiffest(self, force):
        return self.normal_stiffness


class Weakening(Description):
    """Parameters of the law below."""

    half: Positive = Field(
        default=1.0,
        description="Normal force that halves the coefficient of friction.",
        json_schema_extra={"unit": "mg"},
    )


class Weaker(NamedTuple):
    """Linear springs, and a coefficient of friction that falls with the normal force."""

    normal_stiffness: float
    normal_damping: float
    tangential_stiffness: float
    tangential_damping: float
    friction: float
    least_force: float
    half: float

    @classmethod
    def of(cls, *constants, half):
        return cls(*constants[:-1], half)

    def elastic_force(self, overlap, shape):
        return self.normal_stiffness * overlap

    def stiffness(self, overlap, shape):
        return self.normal_stiffness

    def energy(self, overlap, shape):
        return 0.5 * self.normal_stiffness * overlap * overlap

    def shapes(self, first, second):
        return None

    def stiffest(self, force):
        return self.normal_stiffness

    def limit(self, force_normal):
        return self.friction * force_normal / (1.0 + force_normal / self.half)

    def limit_slope(self, force_normal):
        part = 1.0 / (1.0 + force_normal / self.half)
        return self.friction * part * part


class Euler(NamedTuple):
    """Symplectic Euler: velocities first, then displacements with them."""

    rows: int = 1
    order: int = 1

    def predict(self, x, v, a, b, c, dt):
        return x + (v + a * dt) * dt, v, a, b, v + a * dt

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + a * dt, a_new, b, c

    def begin(self, history):
        pass


def problem(friction: float) -> Problem:
    """A small slab with a law of force xi^3, softer where little is borne."""
    packing = {"layers": 4, "disks_per_row": 9, "lattice_constant": 1.99}
    scene = Scene().updated({"packing": packing, "contact.friction": friction, "protocol.time_step": "auto"})
    made = Problem.from_scene(scene)
    pair, wall = (Cubic.of(k, 50.0, 0.8 * k, 40.0, mu, -math.inf, 0.5) for k, mu in ((3000.0, friction), (6000.0, 0.0)))
    if friction == 0.0:
        pair = without_friction(pair)
    return replace(made, laws=((pair, without_friction(wall)),))
