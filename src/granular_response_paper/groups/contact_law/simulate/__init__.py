"""The linear law against the power 3/2 (Sec. III.B): does a linear fit describe the response?

The laws are matched at the slab's typical overlap: there, at that of the mean normal force between touching disks at
rest under the linear law, both give the same force. ``responses`` holds the floor responses of both.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.scene import Scene
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.contact_law.parameters import Parameters
from granular_response_paper.records import axes, column, places, record, table
from granular_response_paper.slab_response import LoadPath, Measures
from granular_response_paper.tasks import computed

LAWS = ("linear", "hertz")


@record
class Outcome:
    """One law at one friction."""

    floor_response: FloatArray = column("floor response per applied force", "force", "floor_disk")
    opened_contacts: NDArray[np.intp] = column("contacts of disks that the load opened, central third", "force")
    force_residual: FloatArray = column(f"largest unbalanced force on a disk {WEIGHTS}", "force")
    typical_force: float = column(f"mean normal force between disks at rest by the linear law {WEIGHTS}")
    normal_stiffness: float = column(
        "contact.normal_stiffness: of the 3/2 law at a normal force of one mean disk weight"
    )
    x: FloatArray = column(f"rest position from the loaded disk, linear law {RADII}", "floor_disk")


def matched_stiffness(stiffness: float, force: float) -> float:
    """``contact.normal_stiffness`` of the 3/2 law with the overlap ``force / stiffness`` at ``force``.

    With ``f = C xi^(3/2)`` that asks for ``C = stiffness^(3/2) / sqrt(force)``, and the tangent stiffness at a force of
    one weight is ``3/2 C^(2/3)``.
    """
    return 1.5 * stiffness / force ** (1.0 / 3.0)


def compute(scene: Scene, law: str, forces: tuple[float, ...]) -> Outcome:
    """``scene`` is linear, with one load of unit force; raises what the solvers raise."""
    path = LoadPath.of(scene)
    force = typical_force(path.rest)
    stiffness = scene.contact.normal_stiffness
    if law == "hertz":
        stiffness = matched_stiffness(stiffness, force)
        # contacts are stiffer under more force: the paper's time step is just too long for them
        changes = {"contact.law": "hertz", "contact.normal_stiffness": stiffness, "protocol.time_step": "auto"}
        path = LoadPath.of(scene.updated(changes))
    measures, states = Measures(path), path.through(forces)
    found = [(measures.response(state), measures.opened(state), state.certificate.force_residual) for state in states]
    response, opened, residual = (np.array(each) for each in zip(*found, strict=True))
    return Outcome(response, opened, residual, force, stiffness, measures.x)


def typical_force(rest: State) -> float:
    """Mean normal force between touching disks; a disk weight where none touch."""
    force = rest.pairs.normal_force[rest.pairs.touching]
    return float(force.mean()) if force.size else 1.0


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``responses``."""
    p = parameters
    scenes = [p.base.updated({"contact.friction": mu}) for mu in p.friction]
    tasks = {place: partial(compute, scene, law, p.forces) for place, (scene, law) in places(scenes, LAWS)}
    # the longest first
    data = table(computed(tasks, "slabs", work=lambda place: place[::-1]), "friction", "law")
    typical, x = (data[name].variable.isel(law=0) for name in ("typical_force", "x"))
    linear, hertz = np.moveaxis(data["floor_response"].values, 1, 0)
    apart = np.abs(hertz - linear).max(axis=-1) / np.abs(linear).max(axis=-1)
    largest = "largest difference of the responses by the two laws, per largest response by the linear one"
    coordinates = axes(
        friction=(p.friction, "coefficient of friction between disks"),
        law=(LAWS, "contact law"),
        force=(p.forces, f"applied force {WEIGHTS}"),
    )
    data = data.drop_vars("x").assign(typical_force=typical, difference=variable(("friction", "force"), apart, largest))
    return labelled({"responses": data.assign_coords(coordinates | {"x": x.isel(friction=0)})}, p.base)
