"""What the paper says about its numerics, measured: claims N1 to N7 (Secs. III, III.B and III.C).

``stop_energy`` is the error that a stopping energy leaves in the floor forces; ``at_rest`` the other criteria of rest,
``swing`` how disks would move on; ``time_step`` and
``integrators`` responses to compare; ``damping`` the time to rest against the damping ratio; ``disorder`` what an early
stop costs averages over disordered slabs. All but the last are runs of the dynamics on the default slab, without the
static finish unless that is what is measured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS, variable
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.numerics.parameters import Parameters
from granular_response_paper.groups.numerics.simulate import runs
from granular_response_paper.groups.numerics.simulate.runs import StoppedResponse
from granular_response_paper.records import table_along
from granular_response_paper.tasks import computed

#: When the kinetic energy is below the limit: the first time that it is, or all along a slow swing.
STOP_RULES = ("instantaneous", "envelope")


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``stop_energy``, ``at_rest``, ``swing``, ``time_step``, ``integrators``, ``damping``, ``disorder``."""
    asked, base = parameters, parameters.scene
    count = round(asked.disorder.reach / asked.disorder.spacing)
    grid = asked.disorder.spacing * np.arange(-count, count + 1, dtype=np.float64)
    tasks = _tasks(asked, grid)
    done = computed({(name, k): task for name, several in tasks.items() for k, task in enumerate(several)}, "runs")
    found = {name: [done[name, k] for k in range(len(several))] for name, several in tasks.items()}

    packing = base.packing.build()
    from_load = "position from the loaded disk in mean disk radii"
    x = variable("floor_disk", packing.position[runs.bottom(packing), 0] - 0.5 * packing.width, from_load)
    by_stop = {(f, e): one for f, several in enumerate(found["stop_energy"]) for e, one in enumerate(several)}
    datasets = {
        "stop_energy": table_along(
            by_stop,
            friction=(asked.frictions, "coefficient of friction between disks"),
            stop_kinetic_energy=(asked.stop_energies, "kinetic energy per disk at which the dynamics stops"),
        ),
        "time_step": _responses(found["time_step"], x, time_step=(asked.time_steps, "time step in sqrt(radius/g)")),
        "integrators": _responses(found["integrators"], x, integrator=(asked.integrators, "integrator")),
        "damping": table_along(
            found["damping"], damping_ratio=(asked.damping.ratios, "dashpot over its critical value, nu / (2 sqrt(k))")
        ),
        "swing": table_along(found["swing"], stop_rule=(STOP_RULES, "rule by which the run had stopped")),
        "disorder": table_along(
            found["disorder"],
            realization=(range(asked.disorder.realizations), "realization of the radii"),
            x=(grid, from_load),
        ),
    }
    datasets["at_rest"] = datasets["time_step"].drop_vars(["floor_response", "difference"]).isel(time_step=0)
    for dataset in datasets.values():
        dataset["force"] = variable((), asked.force, f"applied force {WEIGHTS}")
    return labelled(datasets, _scene(asked, asked.friction))


def _loads(asked: Parameters) -> list[dict[str, Any]]:
    return [{"disk": "top-centre", "force": [0.0, -asked.force]}]


def _scene(asked: Parameters, friction: float) -> Scene:
    return asked.scene.updated({"loads": _loads(asked), "contact.friction": friction})


def _tasks(asked: Parameters, grid: FloatArray) -> Mapping[str, list[partial[Any]]]:
    """The runs of each study, in the order of its values."""
    base, usual, damping, disorder = asked.scene, _scene(asked, asked.friction), asked.damping, asked.disorder
    protocol = {"integrator": "verlet", "stop_kinetic_energy": damping.stop_kinetic_energy}
    verlet = base.updated({"contact.friction": asked.friction, "protocol": protocol})
    bare = [usual.updated({"protocol": {"stop_rule": rule, "static_finish": False}}) for rule in STOP_RULES]
    integrated = usual.updated({"protocol.time_step": asked.integrator_time_step})
    slab = disorder.scene.updated({"loads": _loads(asked)})
    slabs = [slab.updated({"packing.realization": r}) for r in range(disorder.realizations)]
    return {
        "damping": [
            partial(runs.damp, verlet.updated({"contact.damping_ratio": ratio}), damping.time_step)
            for ratio in damping.ratios
        ],
        "stop_energy": [partial(runs.stopped, _scene(asked, mu), asked.stop_energies) for mu in asked.frictions],
        "swing": [partial(runs.swing, scene, asked.swing.steps, asked.swing.read_every) for scene in bare],
        "disorder": [partial(runs.disordered, scene, grid.tolist(), disorder.width) for scene in slabs],
        "time_step": [partial(runs.respond, usual.updated({"protocol.time_step": step})) for step in asked.time_steps],
        "integrators": [
            partial(runs.respond, integrated.updated({"protocol.integrator": name})) for name in asked.integrators
        ],
    }


def _responses(found: Sequence[StoppedResponse], x: xr.Variable, **along: tuple[Sequence[Any], str]) -> xr.Dataset:
    """With how far they are from the first."""
    first = found[0].floor_response
    compared = [
        replace(one, difference=np.abs(one.floor_response - first).max() / np.abs(first).max()) for one in found
    ]
    return table_along(compared, **along).assign_coords(x=x)
