"""The one place that picks how a scene is solved: the cheapest method that is valid for it.

A :class:`Plan` is decided once, with the problem (``Problem.plan``); whoever solves, stores or reports reads it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..contact import CUT, RULES, Law
from ..errors import require
from ..scene import Packing, Protocol, Scene, SceneError

#: Mean acceleration (g), its largest over half a swing, below which statics takes over from a fall: the forces of the
#: paper's slab are then within 2e-9 mg of those at the end of the motion.
AT_REST = 1e-3
#: The same in disordered packings, whose slips fade slowly. Of eight slabs of 908 disks (polydispersity 0.01 to 0.25,
#: friction 0.2 and 1) tangential forces are then within 2e-3 to 2e-2 mg of those after ten times as many steps, with
#: the same contacts; at 0.001, in 1.7 times the steps, within 1e-3 to 1.5e-2 mg. At 0.01 statics often finds nothing.
DISORDERED_AT_REST = 2e-3
#: The same in ordered packings of more than LARGE disks, where what the time step leaves is more than the 2e-4 mg that
#: the earlier end does. Not with rough walls: along these disks slip for longer, and 9e-3 mg would be left.
NEARLY_AT_REST = 1e-2
#: Disks beyond which a fall goes on with larger steps: the paper's slabs, with 908, and piles do not.
LARGE = 2000
#: The paper's kinetic energy per disk at the end of a fall without friction, whose minimum of the energy is near then.
SMOOTH_STOP = 1e-6


@dataclass(frozen=True)
class Choice:
    """A method for one stage and the reason for it."""

    method: str  #: dynamics, minimise or path; none without loads
    reason: str


@dataclass(frozen=True)
class Plan:
    """How a problem is solved."""

    rest: Choice
    load: Choice
    static: bool  #: whether dynamics hands over to the static finish
    stop_energy: float  #: kinetic energy per disk at which dynamics ends or hands over (Sec. III.C)
    stop_acceleration: float  #: mean acceleration at which it hands over, in g; 0 where that does not count
    larger_steps: bool  #: whether a fall goes on with larger steps once its first swings are over


def plan(scene: Scene, packing: Packing, law: Law, *, rotations: bool) -> Plan:
    """Decide how a scene is solved, with its packing and its law between disks; ``rotations`` : whether disks turn.

    Statics has the friction law ``cut`` only; with another one everything is dynamics, to the end.

    Raises
    ------
    SceneError
        When the scene asks for a method that it does not have.
    """
    protocol, loads = scene.protocol, scene.loads
    asked = protocol.method
    only_motion = getattr(law, "only_motion", "")
    if rotations and RULES[protocol.friction_law] != CUT:
        only_motion = f"protocol.friction_law {protocol.friction_law} is a law of motion that statics does not have"
    rule = f"protocol.method = {asked}: must be dynamics or auto, {only_motion}"
    require(asked not in ("path", "minimise") or not only_motion or not loads, rule, SceneError)
    rule = "protocol.method = minimise: must be path, dynamics or auto in a scene with friction (contact or wall)"
    require(asked != "minimise" or not rotations, rule, SceneError)
    static = protocol.static_finish and not only_motion
    if why := "protocol.method is dynamics" if asked == "dynamics" else only_motion:
        rest = load = Choice("dynamics", why)
    else:
        rest, load = _rest(scene, packing, rotations), _load(protocol, rotations)
    load = load if loads else Choice("none", "loads is empty")
    free = static and asked != "dynamics"  # else the protocol is taken at its word
    large = free and len(packing.radius) > LARGE
    larger = large and protocol.time_step is None and protocol.integrator == _default("integrator")
    stop, still = protocol.stop_kinetic_energy, 0.0
    if free and not rotations:
        stop = max(stop, SMOOTH_STOP)
    elif free and all(getattr(protocol, key) == _default(key) for key in ("stop_kinetic_energy", "stop_rule")):
        quick = larger and not scene.resolved_wall.rubs
        ordered = NEARLY_AT_REST if quick else AT_REST
        still = ordered if packing.ordered else DISORDERED_AT_REST
    return Plan(rest, load, static, stop, still, larger)


def _default(key: str) -> Any:
    return Protocol.model_fields[key].default


def _rest(scene: Scene, packing: Packing, rotations: bool) -> Choice:
    """The state at rest under gravity.

    Friction and disorder make it depend on the fall into it, so it is reached as the paper does, by dynamics. The
    ordered frictionless packing has its minimum from wherever one starts.
    """
    smooth = not rotations or scene.preparation.gravity == "frictionless"
    if not smooth:
        return Choice("dynamics", "with friction the rest state depends on how gravity was applied")
    if not packing.ordered:
        return Choice("dynamics", "the rest state of a disordered packing depends on the fall into it")
    how = "prepared without friction, and no disorder" if rotations else "no friction and no disorder"
    return Choice("minimise", f"{how}: rest is the minimum of the energy")


def _load(protocol: Protocol, rotations: bool) -> Choice:
    """The states under load."""
    if protocol.method == "path":
        return Choice("path", "protocol.method is path")
    if rotations:
        return Choice("path", "friction: a path of equilibria through every load between")
    return Choice("minimise", "no friction: equilibrium is a minimum of the energy")
