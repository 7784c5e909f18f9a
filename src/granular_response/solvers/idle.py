"""Settings of a scene that change nothing of what is computed, each with the reason."""

from __future__ import annotations

from ..scene import Scene
from ..scene.errors import show
from .choice import Plan


def idle_settings(scene: Scene, decided: Plan, *, rotations: bool) -> list[str]:
    """Settings of preparation and protocol that differ from their default and change nothing, each with the reason."""
    rest, load, preparation, protocol = decided.rest, decided.load, scene.preparation, scene.protocol
    slow, falls = preparation.gravity == "slow", rest.method == "dynamics"
    hand_over = decided.stop_energy
    reasons = {
        "preparation.gravity": rest.reason if slow and not falls else "",
        "preparation.ramp_time": "" if slow and falls else rest.reason if slow else "preparation.gravity is not slow",
        "protocol.load_factors": "" if scene.loads else load.reason,
        "protocol.friction_law": "" if rotations else "no friction",
        "protocol.stop_kinetic_energy": ""
        if hand_over == protocol.stop_kinetic_energy
        else f"statics takes over at {hand_over:g} already",
    }
    return _idle(scene, reasons)


def idle_in_motion(scene: Scene) -> list[str]:
    """The same settings of a scene whose motion is followed."""
    begins = "a motion begins where the disks are"
    ends = "a motion ends at the last time"
    reasons = {f"preparation.{key}": begins for key in ("gravity", "ramp_time", "taps")}
    reasons |= {f"protocol.{key}": ends for key in ("stop_kinetic_energy", "stop_rule", "static_finish")}
    return _idle(scene, reasons)


def _idle(scene: Scene, reasons: dict[str, str]) -> list[str]:
    idle = []
    for key, reason in reasons.items():
        part, name = key.split(".")
        section = getattr(scene, part)
        value = getattr(section, name)
        if reason and value != type(section).model_fields[name].default:
            idle.append(f"{key} = {show(value)} has no effect ({reason})")
    return idle
