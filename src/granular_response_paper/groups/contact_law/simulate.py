"""The linear law against the power 3/2 (Sec. III.B): does a linear fit describe the response?

The laws are matched at the slab's typical overlap: there, at that of the mean normal force between touching disks at
rest under the linear law, both give the same force. ``responses`` holds the floor responses of both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, variable
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.contact_law.parameters import Parameters
from granular_response_paper.slab_response import LoadPath, Measures

LAWS = ("linear", "hertz")


@dataclass(frozen=True)
class Task:
    """One law at one friction."""

    scene: Scene  #: linear, with one load of unit force
    law: str  #: of LAWS
    forces: tuple[float, ...]


@dataclass(frozen=True)
class Outcome:
    x: FloatArray  #: (floor_disk,)
    response: FloatArray  #: (force, floor_disk)
    residual: FloatArray  #: (force,) largest unbalanced force
    opened: FloatArray  #: (force,) contacts that the load opened in the central third
    typical_force: float  #: by the linear law
    stiffness: float  #: contact.normal_stiffness


def matched_stiffness(stiffness: float, force: float) -> float:
    """``contact.normal_stiffness`` of the 3/2 law with the overlap ``force / stiffness`` at ``force``.

    With ``f = C xi^(3/2)`` that asks for ``C = stiffness^(3/2) / sqrt(force)``, and the tangent stiffness at a force of
    one weight is ``3/2 C^(2/3)``.
    """
    return 1.5 * stiffness / force ** (1.0 / 3.0)


def compute(task: Task) -> Outcome:
    """Raises what the solvers raise."""
    path = LoadPath.of(task.scene)
    force = typical_force(path.rest)
    stiffness = task.scene.contact.normal_stiffness
    if task.law == "hertz":
        stiffness = matched_stiffness(stiffness, force)
        # contacts are stiffer under more force: the paper's time step is just too long for them
        law = {"contact.law": "hertz", "contact.normal_stiffness": stiffness, "protocol.time_step": "auto"}
        path = LoadPath.of(task.scene.updated(law))
    measures = Measures(path)
    states = path.through(task.forces)
    return Outcome(
        measures.x,
        np.array([measures.response(state) for state in states]),
        np.array([state.certificate.force_residual for state in states]),
        np.array([measures.opened(state) for state in states]),
        force,
        stiffness,
    )


def typical_force(rest: State) -> float:
    """Mean normal force between touching disks; a disk weight where none touch."""
    force = rest.pairs.normal_force[rest.pairs.touching]
    return float(force.mean()) if force.size else 1.0


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``responses``."""
    scenes = [parameters.base.updated({"contact.friction": mu}) for mu in parameters.friction]
    # the longest first
    tasks = [Task(scene, law, parameters.forces) for law in reversed(LAWS) for scene in reversed(scenes)]
    solved = map_tasks(compute, tasks)[::-1]
    linear = solved[: len(scenes)]
    outcomes = list(zip(linear, solved[len(scenes) :], strict=True))
    response = np.stack([[o.response for o in laws] for laws in outcomes])
    largest = np.abs(response[:, 0]).max(axis=-1)
    along = ("friction", "law", "force")
    data = xr.Dataset(
        {
            "floor_response": variable((*along, "floor_disk"), response, "floor response per applied force"),
            "difference": variable(
                ("friction", "force"),
                np.abs(response[:, 1] - response[:, 0]).max(axis=-1) / largest,
                "largest difference of the responses by the two laws, per largest response by the linear one",
            ),
            "opened_contacts": variable(
                along,
                np.stack([[o.opened for o in laws] for laws in outcomes]),
                "contacts of disks that the load opened, central third",
            ),
            "force_residual": variable(
                along,
                np.stack([[o.residual for o in laws] for laws in outcomes]),
                f"largest unbalanced force on a disk {FORCE}",
            ),
            "typical_force": variable(
                "friction",
                [o.typical_force for o in linear],
                f"mean normal force between disks at rest by the linear law {FORCE}",
            ),
            "normal_stiffness": variable(
                ("friction", "law"),
                [[o.stiffness for o in laws] for laws in outcomes],
                "contact.normal_stiffness: of the 3/2 law at a normal force of one mean disk weight",
            ),
        },
        coords={
            "friction": variable("friction", parameters.friction, "coefficient of friction between disks"),
            "law": variable("law", list(LAWS), "contact law"),
            "force": variable("force", parameters.forces, f"applied force {FORCE}"),
            "x": variable("floor_disk", linear[0].x, f"rest position from the loaded disk, linear law {LENGTH}"),
        },
    )
    return labelled({"responses": data}, parameters.base)
