"""What the paper says about its numerics, measured: claims N1 to N7 (Secs. III, III.B and III.C).

``stop_energy`` is the error that a stopping energy leaves in the floor forces; ``restart`` the kinetic energy after
a static finish; ``at_rest`` the other criteria of rest, ``swing`` how disks would move on; ``time_step`` and
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
from granular_response_paper.groups.numerics.simulate.runs import Readings, StoppedResponse
from granular_response_paper.records import table_along
from granular_response_paper.tasks import computed

#: Steps between two readings of the kinetic energy of a restarted state.
READ_EVERY = 100

#: When the kinetic energy is below the limit: the first time that it is, or all along a slow swing.
STOP_RULES = ("instantaneous", "envelope")


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``stop_energy``, ``restart``, ``at_rest``, ``swing``, ``time_step``, ``integrators``, ``damping`` and
    ``disorder``.
    """
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
        "restart": _readings(
            found["restart"], READ_EVERY, load=(asked.restart.forces, f"load of the restarted state {WEIGHTS}")
        ).drop_vars("mean_acceleration"),
        "time_step": _responses(found["time_step"], x, time_step=(asked.time_steps, "time step in sqrt(radius/g)")),
        "integrators": _responses(found["integrators"], x, integrator=(asked.integrators, "integrator")),
        "damping": table_along(
            found["damping"], damping_ratio=(asked.damping.ratios, "dashpot over its critical value, nu / (2 sqrt(k))")
        ),
        "swing": _readings(
            found["swing"], asked.swing.read_every, stop_rule=(STOP_RULES, "rule by which the run had stopped")
        ),
        "disorder": table_along(
            found["disorder"],
            realization=(range(asked.disorder.realizations), "realization of the radii"),
            x=(grid, from_load),
        ),
    }
    datasets["restart"]["kinetic_energy"].attrs["long_name"] += " after a restart of a finished state"
    for name, begin in (("restart", "restart"), ("swing", "stop")):
        datasets[name]["step"].attrs["long_name"] += f" since the {begin}"
    datasets["at_rest"] = datasets["time_step"].drop_vars(["floor_response", "difference"]).isel(time_step=0)
    for dataset in datasets.values():
        dataset["force"] = variable((), asked.force, f"applied force {WEIGHTS}")
    return labelled(datasets, _scene(asked, asked.friction))


def _scene(asked: Parameters, friction: float) -> Scene:
    return asked.scene.updated({"loads": _loads(asked.force), "contact.friction": friction})


def _loads(force: float) -> list[dict[str, Any]]:
    return [{"disk": "top-centre", "force": [0.0, -force]}]


def _tasks(asked: Parameters, grid: FloatArray) -> Mapping[str, list[partial[Any]]]:
    """The runs of each study, in the order of its values."""
    base, usual, damping, disorder = asked.scene, _scene(asked, asked.friction), asked.damping, asked.disorder
    protocol = {"integrator": "verlet", "stop_kinetic_energy": damping.stop_kinetic_energy}
    verlet = base.updated({"contact.friction": asked.friction, "protocol": protocol})
    smooth = base.updated({"contact.friction": 0.0, "loads": _loads(1.0)})
    bare = [usual.updated({"protocol": {"stop_rule": rule, "static_finish": False}}) for rule in STOP_RULES]
    integrated = usual.updated({"protocol.time_step": asked.integrator_time_step})
    slab = disorder.scene.updated({"loads": _loads(asked.force)})
    slabs = [slab.updated({"packing.realization": r}) for r in range(disorder.realizations)]
    return {
        "damping": [
            partial(runs.damp, verlet.updated({"contact.damping_ratio": ratio}), damping.time_step)
            for ratio in damping.ratios
        ],
        "stop_energy": [partial(runs.stopped, _scene(asked, mu), asked.stop_energies) for mu in asked.frictions],
        "restart": [
            partial(runs.restart, smooth, force, asked.restart.steps, READ_EVERY) for force in asked.restart.forces
        ],
        "swing": [partial(runs.swing, scene, asked.swing.steps, asked.swing.read_every) for scene in bare],
        "disorder": [partial(runs.disordered, scene, grid.tolist(), disorder.width) for scene in slabs],
        "time_step": [partial(runs.respond, usual.updated({"protocol.time_step": step})) for step in asked.time_steps],
        "integrators": [
            partial(runs.respond, integrated.updated({"protocol.integrator": name})) for name in asked.integrators
        ],
    }


def _readings(found: Sequence[Readings], every: int, **along: tuple[Sequence[Any], str]) -> xr.Dataset:
    """With the step of each."""
    step = variable("reading", every * np.arange(1, found[0].kinetic_energy.size + 1), "time steps")
    return table_along(found, **along).assign_coords(step=step)


def _responses(found: Sequence[StoppedResponse], x: xr.Variable, **along: tuple[Sequence[Any], str]) -> xr.Dataset:
    """With how far they are from the first."""
    first = found[0].floor_response
    compared = [
        replace(one, difference=np.abs(one.floor_response - first).max() / np.abs(first).max()) for one in found
    ]
    return table_along(compared, **along).assign_coords(x=x)
