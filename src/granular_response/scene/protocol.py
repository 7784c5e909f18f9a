"""How a scene is prepared and how its equilibrium is to be reached."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from .base import Count, Description, Flag, NonNegative, Positive, allowed
from .errors import Problem

TimeStep = Annotated[
    Annotated[float, Field(strict=True, gt=0)] | Literal["auto"],
    allowed("must be a number greater than 0, or auto"),
]
#: The time step of Sec. III.
PAPERS_TIME_STEP = 5e-4


LoadFactors = Annotated[
    tuple[Annotated[float, Field(strict=True, allow_inf_nan=False)], ...],
    Field(min_length=1),
    allowed("must be a list of one or more finite numbers"),
]
#: Methods that are gone, each with the one that took its place.
REPLACED_METHODS = {"stages": "path"}


def _check_method(value: Any) -> Any:
    if isinstance(value, str) and value in REPLACED_METHODS:
        raise Problem(f"is gone, must be {REPLACED_METHODS[value]}, which follows disordered packings too")
    return value


Method = Annotated[Literal["auto", "dynamics", "path", "minimise"], BeforeValidator(_check_method)]
Integrator = Literal["beeman", "verlet", "leapfrog", "gear"]


class Preparation(Description):
    """How gravity is brought onto the unloaded packing. A rest state with friction remembers it.

    Examples
    --------
    >>> gr.Scene(preparation=gr.Preparation(gravity="slow")).preparation.ramp_time
    100.0
    """

    gravity: Literal["at-once", "slow", "frictionless"] = Field(
        default="at-once",
        description="at-once: gravity acts in full from the start, and the packing falls into its "
        "contacts, as in the paper; slow: gravity grows linearly from 0 to 1 over ramp_time; "
        "frictionless: the packing comes to rest without friction, which acts from then on, with "
        "tangential springs at zero: the rest state is then found by statics in ordered packings of any size.",
    )
    ramp_time: Positive = Field(
        default=100.0,
        description="Time over which slow gravity grows, in sqrt(R/g). For slow gravity only.",
    )


class Protocol(Description):
    """How equilibrium is reached. Sec. III of the paper, with its values as defaults.

    Examples
    --------
    >>> loop = gr.Scene(protocol=gr.Protocol(load_factors=[0.5, 1.0, 0.5, 0.0]))
    """

    replaced: ClassVar[Mapping[str, str]] = {
        "path_tolerance": "is gone, must be left out: a path is exact from one contact event to the next",
        "inertia": "is gone, must be left out: it was for method stages, now path",
        "stage_damping": "is gone, must be left out: it was for method stages, now path",
    }

    method: Method = Field(
        default="auto",
        description="auto: the cheapest method that is valid for the scene; dynamics: equations of motion "
        "until rest, as in the paper; path: equilibria under a slowly growing load, "
        "from one contact event to the next; minimise: the nearest minimum of the energy, for scenes without friction.",
    )
    load_factors: LoadFactors = Field(
        default=(1.0,),
        description="Load programme: multipliers of the loads at which states are kept, in turn. They may grow, fall, "
        "change sign and repeat: [0.5, 1, 0.5, 0] loads and unloads. Every method goes on from the state before, but "
        "dynamics starts each ramp at rest until the programme first turns, as in the paper.",
    )
    integrator: Integrator = Field(
        default="beeman",
        description="Integrator of the equations of motion: Beeman, velocity Verlet, leapfrog (Verlet whose dashpots "
        "see the velocity half a step earlier, stable for twice the step), or the Gear predictor-corrector with five "
        "values.",
    )
    time_step: TimeStep | None = Field(
        default=None,
        description="Time step in sqrt(R/g); auto takes the largest one that is safe for the scene. Left out, it is "
        "the paper's 5e-4 where that is stable, and auto else; one that is given is taken at its word.",
    )
    ramp_time: NonNegative = Field(
        default=20.0, description="Time over which the loads grow linearly to their values, in sqrt(R/g)."
    )
    stop_kinetic_energy: Positive = Field(
        default=1e-13,
        description="A packing is at rest when its kinetic energy per disk is below this, in m g R (E_stop).",
    )
    stop_rule: Literal["instantaneous", "envelope"] = Field(
        default="instantaneous",
        description="instantaneous: the first time the kinetic energy is below the limit, as in the "
        "paper; envelope: its largest value over a slow swing must be below the limit.",
    )
    static_finish: Flag = Field(
        default=True,
        description="Solve the equations of equilibrium from the state at which the dynamics stopped.",
    )
    friction_law: Literal["cut", "literal", "unloading"] = Field(
        default="cut",
        description="At the Coulomb limit, cut: spring and dashpot together are cut to friction times "
        "normal force, and the spring takes what is left; literal: the spring keeps its "
        "length while it is beyond the limit, which never quite settles; unloading: the same, but slip that "
        "shortens the spring does so. Neither cuts the force, and both are for dynamics alone.",
    )
    tensile_dashpot: Flag = Field(
        default=True,
        description="Whether the normal force may pull for a moment while a contact opens fast, as in the "
        "paper; false cuts it off at zero.",
    )
    maximum_steps: Count = Field(
        default=5_000_000,
        description="Most time steps that one stage, gravity or load, may take to reach rest; on a path, each motion "
        "from a lost equilibrium to the next one.",
    )


def without_replaced(scene: Any) -> Any:
    """The data of a scene as versions before wrote it, without the keys and methods of its protocol that are gone.

    They said how equilibrium was to be reached, not what was simulated, so that a stored result is read without them.
    """
    protocol = scene.get("protocol") if isinstance(scene, Mapping) else None
    if not isinstance(protocol, Mapping):
        return scene
    kept = {key: value for key, value in protocol.items() if key not in Protocol.replaced}
    method = kept.get("method")
    if isinstance(method, str):
        kept["method"] = REPLACED_METHODS.get(method, method)
    return {**scene, "protocol": kept}
