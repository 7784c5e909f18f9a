"""How much each reading of the paper matters: the same slab and load with one thing changed at a time.

For each variant the floor response is compared, disk by disk, with that of the reference: the paper's protocol with
Beeman, and where the paper says nothing, gravity at once, a ramp of 20, spring and dashpot cut at the Coulomb limit,
Newton finish. Stored are the largest difference, and what the variant itself settled to.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib import resources
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe.floor import floor_disks, floor_response
from granular_response.scene import Scene, text
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.solvers.timestep import resolve_time_step
from granular_response.state import FloatArray, State
from granular_response.sweeps.rest import rest_state
from granular_response_paper.groups.sensitivity.parameters import Parameters
from granular_response_paper.records import axes, column, labels, record, table, variables
from granular_response_paper.tasks import computed


@dataclass(frozen=True)
class Variant:
    """One change to the reference scene, by key of a scene."""

    text: str
    both: Mapping[str, Any] = field(default_factory=dict)  #: to both stages
    load: Mapping[str, Any] = field(default_factory=dict)  #: to the load alone
    law: Mapping[str, Any] = field(default_factory=dict)  #: a friction law under load that statics does not have
    matched: str = ""  #: a contact law that gives the mean contact force at rest at the same overlap


#: By name, the reference first.
VARIANTS = {
    name: Variant(**said)
    for name, said in text.read(resources.files(__package__).joinpath("variants.yaml").read_text("utf-8")).items()
}


@record
class VariantResponse:
    floor_response: FloatArray = column("floor response per applied force", "floor_disk")
    kinetic_energy: float = column(
        "kinetic energy per disk where the dynamics stopped, in mean weight times mean radius"
    )
    x: FloatArray = column("lattice position from the loaded disk in mean radii", "floor_disk")


def compute(scene: Scene, variant: Variant, steps: int) -> VariantResponse:
    """The floor response of one variant; after ``steps`` by a friction law of its own, which need not have a rest."""
    scene = scene.updated({"protocol.method": "dynamics", **variant.both})
    rest = rest_state(Problem.from_scene(scene))
    if variant.matched:
        scene = matched(scene, variant.matched, rest)
        rest = rest_state(Problem.from_scene(scene))
    problem = Problem.from_scene(scene.updated({**variant.load, **variant.law})).with_loads(rest.position)
    if variant.law:
        dynamics = Dynamics(problem, rest, scene.protocol.integrator, resolve_time_step(problem))
        loaded = relax(dynamics, Stop(1e-30, maximum_steps=steps), load=(0.0, 1.0, scene.protocol.ramp_time))
    else:
        _, (loaded,) = loaded_states(problem, rest, [1.0])
    bottom = floor_disks([rest, loaded], np.flatnonzero(problem.packing.row == 0))
    total = float(np.hypot(problem.load[:, 0], problem.load[:, 1]).sum())
    certificate = loaded.reached.certificate
    energy = loaded.reached.kinetic_energy
    if energy is None:
        energy = certificate.kinetic_energy if certificate else np.nan
    return VariantResponse(
        floor_response=floor_response(rest, loaded, bottom, total),
        x=problem.packing.position[bottom, 0] - problem.packing.position[problem.load_disk[0], 0],
        kinetic_energy=float(energy),
    )


def matched(scene: Scene, law: str, rest: State) -> Scene:
    """The scene with a law that is as stiff as the linear one at the mean contact force of its initial equilibrium.

    With ``f = C xi^(3/2)`` the overlap ``f / k`` at the force ``f`` asks for ``C = k^(3/2) / sqrt(f)``, and
    ``contact.normal_stiffness``, the tangent stiffness at a force of one weight, is ``3/2 C^(2/3) = 3/2 k / f^(1/3)``.
    Contacts are stiffer under more force, for which the paper's time step is too long. One weight where none touch.
    """
    force = rest.pairs.normal_force[rest.pairs.touching]
    stiffness = 1.5 * scene.contact.normal_stiffness / (float(force.mean()) if force.size else 1.0) ** (1.0 / 3.0)
    changes = {"contact.law": law, "contact.normal_stiffness": stiffness, "protocol.time_step": "auto"}
    return scene.updated(changes)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """One dataset for each coefficient of friction; see the module."""
    load = {"disk": "top-centre", "force": [0.0, -parameters.force]}
    tasks = {
        (friction, name): partial(compute, scene, variant, parameters.literal_steps)
        for friction in parameters.friction
        for scene in [parameters.scene.updated({"contact.friction": friction, "loads": [load]})]
        for name, variant in VARIANTS.items()
    }
    outcomes = computed(tasks, "variants")
    attributes = {"force": parameters.force, "layers": int(parameters.scene.packing.build().row_count.size)}
    return {
        f"mu_{friction:g}": compared([outcomes[friction, name] for name in VARIANTS]).assign_attrs(attributes)
        for friction in parameters.friction
    }


def compared(outcomes: Sequence[VariantResponse]) -> xr.Dataset:
    """The outcomes of all variants, and how far each is from the reference."""
    found = table(outcomes, "variant")
    response, x = found["floor_response"].values, found["x"].variable.isel(variant=0)
    difference = np.abs(response - response[0]).max(axis=1)
    derived = variables(
        largest_difference=("variant", difference, "largest difference of the floor response"),
        response_sum=("variant", response.sum(axis=1), "sum of the floor response"),
    )
    texts = labels("variant", VARIANTS.values(), text="what is changed")
    names = axes(variant=(VARIANTS, "name of the variant"))
    return found.drop_vars("x").assign(derived | texts).assign_coords(names | {"x": x})
