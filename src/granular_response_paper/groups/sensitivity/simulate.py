"""How much each reading of the paper matters: the same slab and load with one thing changed at a time.

For each variant the floor response is compared, disk by disk, with that of the reference: the paper's protocol with
Beeman, and where the paper says nothing, gravity at once, a ramp of 20, spring and dashpot cut at the Coulomb limit,
Newton finish. Stored are the largest and the root-mean-square difference, and what the variant itself settled to.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe.floor import floor_disks, floor_response
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.solvers.timestep import resolve_time_step
from granular_response.state import FloatArray, State
from granular_response.sweeps.rest import rest_state
from granular_response_paper.groups.sensitivity.parameters import Parameters
from granular_response_paper.records import axes, column, labels, record, table, variables
from granular_response_paper.tasks import computed

REFERENCE = "reference"


@dataclass(frozen=True)
class Variant:
    """One change to the reference scene. ``rest`` and ``load`` are changes to the two stages, by key of a scene."""

    name: str
    text: str
    rest: Mapping[str, Any]
    load: Mapping[str, Any]


#: What a variant changes, in words and by key of a scene.
Change = tuple[str, Mapping[str, Any]]

#: Changes to both stages.
_BOTH: Mapping[str, Change] = {
    REFERENCE: ("the paper's protocol as read here", {}),
    "time_step_halved": ("time step halved", {"protocol.time_step": 2.5e-4}),
    "gear": ("Gear at half the time step (its limit is lower)",
             {"protocol.integrator": "gear", "protocol.time_step": 2.4e-4}),
    "verlet": ("velocity Verlet in place of Beeman", {"protocol.integrator": "verlet"}),
    "no_tensile_dashpot": ("normal force cut off at zero", {"protocol.tensile_dashpot": False}),
    "damping_halved": ("dashpots halved", {"contact.damping_ratio": 0.25}),
    "slow_gravity": ("gravity grows over 100 in place of at once", {"preparation.gravity": "slow"}),
    "stop_1e-9": ("stopped at 1e-9 per disk, without the static finish",
                  {"protocol.stop_kinetic_energy": 1e-9, "protocol.static_finish": False}),
    "no_static_finish": ("stopped at 1e-13 per disk, without the static finish", {"protocol.static_finish": False}),
}  # fmt: skip
#: Changes to the load alone.
_LOAD: Mapping[str, Change] = {
    "ramp_80": ("load ramp of 80 in place of 20", {"protocol.ramp_time": 80.0}),
    "sudden_load": ("load applied at once", {"protocol.ramp_time": 0.0}),
    "path": ("quasi-static path in place of dynamics", {"protocol.method": "path"}),
}
#: Changes while the load acts: friction laws that statics does not have.
LAWS_OF_MOTION: Mapping[str, Change] = {
    "literal_friction": ("the paper's equation for the spring taken literally", {"protocol.friction_law": "literal"}),
    "unloading_friction": ("the spring frozen at the limit, free to unload", {"protocol.friction_law": "unloading"}),
}


def variants() -> list[Variant]:
    """All variants, the reference first."""
    both = [Variant(name, text, changes, changes) for name, (text, changes) in _BOTH.items()]
    return both + [Variant(name, text, {}, changes) for name, (text, changes) in _LOAD.items()]


@record
class Outcome:
    floor_response: FloatArray = column("floor response per applied force", "floor_disk")
    kinetic_energy: float = column(
        "kinetic energy per disk where the dynamics stopped, in mean weight times mean radius"
    )
    force_residual: float = column("largest unbalanced force on a disk in mean disk weights")
    x: FloatArray = column("lattice position from the loaded disk in mean radii", "floor_disk")


def compute(scene: Scene, variant: Variant, steps: int) -> Outcome:
    """The floor response of one variant.

    ``steps`` is the length of the run by a friction law that statics does not have; 0 for an ordinary variant.
    """
    rest_scene = scene.updated({"protocol.method": "dynamics", **variant.rest})
    load_scene = scene.updated({"protocol.method": "dynamics", **variant.load})
    rest = rest_state(Problem.from_scene(rest_scene))
    problem = Problem.from_scene(load_scene).with_loads(rest.position)
    if steps:
        loaded = _by_another_law(problem, rest, LAWS_OF_MOTION[variant.name][1], steps)
    else:
        _, (loaded,) = loaded_states(problem, rest, [1.0])
    bottom = floor_disks([rest, loaded], np.flatnonzero(problem.packing.row == 0))
    total = float(np.hypot(problem.load[:, 0], problem.load[:, 1]).sum())
    certificate = loaded.reached.certificate
    energy = loaded.reached.kinetic_energy
    if energy is None:
        energy = certificate.kinetic_energy if certificate else np.nan
    return Outcome(
        floor_response=floor_response(rest, loaded, bottom, total),
        x=problem.packing.position[bottom, 0] - problem.packing.position[problem.load_disk[0], 0],
        kinetic_energy=float(energy),
        force_residual=certificate.force_residual if certificate else np.nan,
    )


def _by_another_law(problem: Problem, rest: State, law: Mapping[str, Any], steps: int) -> State:
    """The loaded state after a fixed time by a friction law that need not have a rest."""
    other = Problem.from_scene(problem.scene.updated(law))
    other = replace(other, load_disk=problem.load_disk, load=problem.load)
    dynamics = Dynamics(other, rest, problem.scene.protocol.integrator, resolve_time_step(other))
    ramp = (0.0, 1.0, problem.scene.protocol.ramp_time)
    return relax(dynamics, Stop(1e-30, maximum_steps=steps), load=ramp)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """One dataset for each coefficient of friction; see the module."""
    known = variants() + [Variant(name, text, {}, {}) for name, (text, _) in LAWS_OF_MOTION.items()]
    load = {"disk": "top-centre", "force": [0.0, -parameters.force]}
    tasks = {}
    for friction in parameters.friction:
        scene = parameters.scene.updated({"contact.friction": friction, "loads": [load]})
        for variant in known:
            steps = parameters.literal_steps if variant.name in LAWS_OF_MOTION else 0
            tasks[friction, variant.name] = partial(compute, scene, variant, steps)
    outcomes = computed(tasks, "variants")
    attributes = {"force": parameters.force, "layers": int(parameters.scene.packing.build().row_count.size)}
    return {
        f"mu_{friction:g}": _dataset(known, [outcomes[friction, one.name] for one in known]).assign_attrs(attributes)
        for friction in parameters.friction
    }


def _dataset(known: list[Variant], outcomes: list[Outcome]) -> xr.Dataset:
    found = table(outcomes, "variant")
    response, x = found["floor_response"].values, found["x"].variable.isel(variant=0)
    difference = response - response[0]
    derived = variables(
        largest_difference=("variant", np.abs(difference).max(axis=1), "largest difference of the floor response"),
        rms_difference=("variant", np.sqrt((difference**2).mean(axis=1)), "rms difference of the floor response"),
        response_sum=("variant", response.sum(axis=1), "sum of the floor response"),
    )
    texts = labels("variant", known, text="what is changed")
    names = axes(variant=([one.name for one in known], "name of the variant"))
    return found.drop_vars("x").assign(derived | texts).assign_coords(names | {"x": x})
