"""How disks start, how a packing is prepared, and how its equilibrium is to be reached."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ..state import FloatArray
from .base import Count, Description, Finite, Flag, NonNegative, Positive, allowed
from .errors import SceneError, describe
from .names import MOTION
from .packing import Packing

TimeStep = Annotated[Positive | Literal["auto"], allowed("must be a number greater than 0, or auto")]
#: The time step of Sec. III.
PAPERS_TIME_STEP = 5e-4
LoadFactors = Annotated[
    tuple[Finite, ...], Field(min_length=1), allowed("must be a list of one or more finite numbers")
]
COLUMN = "column"
Numbers = Annotated[
    Annotated[float, Field(strict=True)]
    | Annotated[tuple[Annotated[float, Field(strict=True)], ...], Field(min_length=1)]
    | Literal["column"],
    allowed("must be a finite number, a list of one for each disk, or column"),
]
Method = Literal["auto", "dynamics", "path", "minimise"]
Integrator = Literal["beeman", "verlet", "leapfrog", "gear"]


class Taps(Description):
    """Taps of a packing at rest, one after another: one period of a triangular wave of vertical acceleration, up first.

    Beyond 1 g disks leave each other. Waves through a deep packing open contacts below 1 g too.

    Examples
    --------
    >>> scene = gr.Scene(preparation=gr.Preparation(gravity="slow", taps=gr.Taps(number=3)))
    >>> scene.updated({"preparation.taps.amplitude": 1.5}).preparation.taps
    Taps(number=3, amplitude=1.5)
    """

    number: Count = Field(default=10, description="Number of taps; each begins when the packing is at rest again.")
    amplitude: Positive = Field(default=0.5, description="Largest acceleration of the box.")
    duration: Positive = Field(default=3.0, description="Duration of a tap, rounded to a multiple of four time steps.")


class Preparation(Description):
    """How the unloaded packing comes to rest. With friction the initial equilibrium depends on it.

    Examples
    --------
    >>> gr.Scene(preparation=gr.Preparation(gravity="slow")).preparation.ramp_time
    100.0
    """

    sparse: ClassVar[tuple[str, ...]] = ("taps",)

    gravity: Literal["at-once", "slow", "frictionless"] = Field(
        default="at-once",
        description="at-once: gravity is applied instantaneously, as in the paper; slow: it grows linearly over "
        "ramp_time; frictionless: the packing settles without friction, which acts from then on, with tangential "
        "springs at zero.",
    )
    ramp_time: Positive = Field(default=100.0, description="Time over which slow gravity grows.")
    taps: Taps | None = Field(default=None, description="Taps of the packing at rest, before the loads.")


class Protocol(Description):
    """How equilibrium is reached. Sec. III of the paper, with its values as defaults.

    Examples
    --------
    >>> loop = gr.Scene(protocol=gr.Protocol(load_factors=[0.5, 1.0, 0.5, 0.0]))
    """

    method: Method = Field(
        default="auto",
        description="auto: the cheapest method that is valid for the scene; dynamics: equations of motion, as in the "
        "paper; path: quasi-static continuation from one contact event to the next; minimise: the nearest minimum of "
        "the energy, without friction.",
    )
    load_factors: LoadFactors = Field(
        default=(1.0,),
        description="Load programme: factors of the loads at which states are stored, in turn; [0.5, 1, 0.5, 0] loads "
        "and unloads. Each load continues from the previous state. Dynamics instead starts from the initial "
        "equilibrium until the programme first reverses, as in the paper.",
    )
    integrator: Integrator = Field(
        default="beeman",
        description="Beeman, velocity Verlet, leapfrog (dashpots see the velocity half a step earlier; stable for "
        "twice the step), or Gear's predictor-corrector with five values.",
    )
    time_step: TimeStep | None = Field(
        default=None,
        description="auto: 0.6 of the stability limit. null: the paper's 5e-4 if that is stable, otherwise auto; in "
        "packings of more than 2,000 disks a fall under gravity goes on with leapfrog and up to three times the step "
        "after seven periods of its vertical oscillation; a motion resolves its collisions.",
    )
    ramp_time: NonNegative = Field(default=20.0, description="Time over which the loads grow linearly to their values.")
    stop_kinetic_energy: Positive = Field(
        default=1e-13,
        description="Kinetic energy per disk below which a packing counts as settled (E_stop). With this default, the "
        "default stop_rule and friction, a fall ends earlier if statics follows: at a mean acceleration of 0.001 g for "
        "half a period of the slowest oscillation (0.002 g in disordered packings, 0.01 g in ordered ones with larger "
        "steps and smooth walls).",
    )
    stop_rule: Literal["instantaneous", "envelope"] = Field(
        default="instantaneous",
        description="instantaneous: the kinetic energy is below the limit once, as in the paper; envelope: it has been "
        "below the limit for 20 sqrt(R/g), some oscillations of the slowest modes.",
    )
    static_finish: Flag = Field(
        default=True, description="Whether Newton's method solves the equations of equilibrium after dynamics."
    )
    friction_law: Literal["cut", "literal", "unloading"] = Field(
        default="cut",
        description="At the Coulomb limit, cut: force of spring and dashpot are cut to the limit, and the spring takes "
        "the value of the cut force; literal, as printed in the paper: the spring is frozen beyond the limit and the "
        "force is not cut; unloading: the same, but slip may shorten the spring. The last two are for dynamics only.",
    )
    tensile_dashpot: Flag = Field(
        default=True, description="Whether the normal force may be tensile while a contact opens fast, as in the paper."
    )
    maximum_steps: Count = Field(
        default=5_000_000,
        description="Maximum number of time steps for gravity, for each load, and on a path for each dynamic jump.",
    )


class Motion(Description):
    """Velocities and spins with which disks start, for :func:`granular_response.motion`.

    A number is that of all disks, a list has one for each; ``column`` takes them from the file of the packing: the
    column of that name, without a unit, in a CSV table, the velocities of a LAMMPS data file, ``vx vy omegaz`` of a
    dump. Equilibria are found from rest, so ``solve`` refuses a scene with a motion.

    Examples
    --------
    >>> scene = gr.Scene(packing=gr.Slab(layers=1, disks_per_row=2), motion=gr.Motion(vx=[0.1, -0.1]), loads=[])
    >>> scene.motion.vx
    (0.1, -0.1)
    """

    sparse: ClassVar[tuple[str, ...]] = (*MOTION, "weightless")

    vx: Numbers = Field(default=0.0, description="Velocity to the right at the start.")
    vz: Numbers = Field(default=0.0, description="Velocity upwards at the start.")
    spin: Numbers = Field(
        default=0.0, description="Angular velocity at the start, counter-clockwise; needs friction of disks or walls."
    )
    weightless: Flag = Field(default=False, description="Whether the disks move without gravity.")

    @property
    def key(self) -> str:
        """The first key that is not its default; empty where the disks start at rest."""
        changed = [name for name, info in type(self).model_fields.items() if getattr(self, name) != info.default]
        return f"motion.{changed[0]}" if changed else ""

    def of(self, packing: Packing) -> FloatArray:
        """(n, 3) velocities and spins of the disks of a packing; SceneError where the numbers are not those of it."""
        found = np.zeros((packing.n, 3))
        for k, name in enumerate(MOTION):
            given = getattr(self, name)
            if given == COLUMN:
                columns = packing.columns or {}
                if name not in columns:
                    rule = f"must be numbers, the packing is from no file with a column {name} in reduced units"
                    raise SceneError(describe(("motion", name), given, rule))
                given = columns[name]
                if not np.isfinite(given).all():
                    bad = int(np.argmin(np.isfinite(given)))
                    rule = f"column {name}: must be a finite number for each disk, disk {bad} (counted from 0) has none"
                    raise SceneError(describe(("motion", name), COLUMN, rule))
            elif not isinstance(given, float) and len(given) != packing.n:
                rule = f"must have one number for each of the {packing.n} disks, has {len(given)}"
                raise SceneError(describe(("motion", name), list(given), rule))
            found[:, k] = given
        return found
