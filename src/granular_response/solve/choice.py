"""The one place that picks how a scene is solved: the cheapest method that is valid for it."""

from __future__ import annotations

from dataclasses import dataclass

from ..contact import CUT
from ..scene import SceneError
from ..scene.errors import show
from .problem import Problem


@dataclass(frozen=True)
class Choice:
    """A method for one stage and the reason for it."""

    method: str  #: dynamics, minimise or path
    reason: str


def _of_motion(problem: Problem) -> bool:
    """Whether the friction law is one that statics does not have: all but the cut."""
    return problem.rotations and problem.rule != CUT


def _why(problem: Problem) -> str:
    return f"protocol.friction_law {problem.scene.protocol.friction_law} is a law of motion that statics does not have"


def finishes_statically(problem: Problem) -> bool:
    """Whether dynamics hands over to the static finish."""
    return problem.scene.protocol.static_finish and not _of_motion(problem)


def rest_method(problem: Problem) -> Choice:
    """How to find the state at rest under gravity.

    Friction and disorder make the rest state depend on the fall into it, so it is reached as the paper does, by
    dynamics. The ordered frictionless packing has its minimum from wherever one starts.

    Raises
    ------
    SceneError
        When ``minimise`` is asked for a scene with friction.
    """
    asked = problem.scene.protocol.method
    if asked == "minimise" and problem.rotations:
        raise SceneError(
            "protocol.method = minimise: must be path, dynamics or auto in a scene with friction (contact or wall)"
        )
    if asked == "dynamics":
        return Choice("dynamics", "protocol.method is dynamics")
    if _of_motion(problem):
        return Choice("dynamics", _why(problem))
    if problem.rotations and problem.scene.preparation.gravity == "frictionless":
        if problem.packing.ordered:
            return Choice("minimise", "prepared without friction, and no disorder: rest is the minimum of the energy")
        return Choice("dynamics", "the rest state of a disordered packing depends on the fall into it")
    if problem.rotations:
        return Choice("dynamics", "with friction the rest state depends on how gravity was applied")
    if not problem.packing.ordered:
        return Choice("dynamics", "the rest state of a disordered packing depends on the fall into it")
    return Choice("minimise", "no friction and no disorder: rest is the minimum of the energy")


def load_method(problem: Problem) -> Choice:
    """How to find the states under load.

    Raises
    ------
    SceneError
        When ``path`` is asked for a scene with a friction law that statics does not have.
    """
    asked = problem.scene.protocol.method
    if asked == "dynamics":
        return Choice("dynamics", "protocol.method is dynamics")
    if _of_motion(problem):
        if asked == "path":
            raise SceneError(f"protocol.method = path: must be dynamics or auto, {_why(problem)}")
        return Choice("dynamics", _why(problem))
    if asked == "path":
        return Choice("path", "protocol.method is path")
    if problem.rotations:
        return Choice("path", "friction: a path of equilibria through every load between")
    return Choice("minimise", "no friction: equilibrium is a minimum of the energy")


def stop_energy(problem: Problem) -> float:
    """Kinetic energy per disk at which dynamics hands over to the static finish (Sec. III.C).

    The paper's own: 1e-6 without friction, 1e-9 with disorder, and else what the protocol says. With
    ``method: dynamics``, or without a static finish, the protocol is taken at its word.
    """
    protocol = problem.scene.protocol
    if protocol.method == "dynamics" or not finishes_statically(problem):
        return protocol.stop_kinetic_energy
    if not problem.rotations:
        return max(protocol.stop_kinetic_energy, 1e-6)
    if not problem.packing.ordered:
        return max(protocol.stop_kinetic_energy, 1e-9)
    return protocol.stop_kinetic_energy


def idle_settings(problem: Problem) -> list[str]:
    """Settings of preparation and protocol that differ from their default and change nothing, each with the reason."""
    scene = problem.scene
    preparation, protocol = scene.preparation, scene.protocol
    rest = rest_method(problem)
    load = load_method(problem) if scene.loads else Choice("none", "loads is empty")
    slow, falls = preparation.gravity == "slow", rest.method == "dynamics"
    hand_over = stop_energy(problem)
    reasons = {
        "preparation.gravity": rest.reason if slow and not falls else "",
        "preparation.ramp_time": "" if slow and falls else rest.reason if slow else "preparation.gravity is not slow",
        "protocol.load_factors": "" if scene.loads else load.reason,
        "protocol.friction_law": "" if problem.rotations else "no friction",
        "protocol.stop_kinetic_energy": ""
        if hand_over == protocol.stop_kinetic_energy
        else f"statics takes over at {hand_over:g} already",
    }
    idle = []
    for key, reason in reasons.items():
        part, name = key.split(".")
        section = getattr(scene, part)
        value = getattr(section, name)
        if reason and value != type(section).model_fields[name].default:
            idle.append(f"{key} = {show(value)} has no effect ({reason})")
    return idle
