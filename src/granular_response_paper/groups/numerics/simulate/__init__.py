"""What the paper says about its numerics, measured: claims N1 to N7 (Secs. III, III.B and III.C).

``stop_energy`` is the error that a stopping energy leaves in the floor forces; ``at_rest`` the other criteria of rest,
``swing`` how disks would move on; ``time_step`` and ``integrators`` responses to compare; ``damping`` the time to rest
against the damping ratio; ``disorder`` what an early stop costs averages over disordered slabs. All but the last are
runs of the dynamics on the default slab, without the static finish unless that is what is measured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.floor import floor_disks, floor_force, floor_response, smoothed_response
from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import resolve_time_step, stability_limit
from granular_response.state import FloatArray, State
from granular_response.store.variables import WEIGHTS, variable
from granular_response.studies import LoadPath
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.numerics.parameters import Parameters
from granular_response_paper.records import column, record, table_along
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
    x = variable("floor_disk", packing.position[bottom(packing), 0] - 0.5 * packing.width, from_load)
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


def _scene(asked: Parameters, friction: float) -> Scene:
    return asked.scene.updated({"loads.0.force": [0.0, -asked.force], "contact.friction": friction})


def _tasks(asked: Parameters, grid: FloatArray) -> Mapping[str, list[partial[Any]]]:
    """The runs of each study, in the order of its values."""
    base, usual, damping, disorder = asked.scene, _scene(asked, asked.friction), asked.damping, asked.disorder
    protocol = {"integrator": "verlet", "stop_kinetic_energy": damping.stop_kinetic_energy}
    verlet = base.updated({"contact.friction": asked.friction, "protocol": protocol})
    bare = [usual.updated({"protocol": {"stop_rule": rule, "static_finish": False}}) for rule in STOP_RULES]
    integrated = usual.updated({"protocol.time_step": asked.integrator_time_step})
    slab = disorder.scene.updated({"loads.0.force": [0.0, -asked.force]})
    slabs = [slab.updated({"packing.realization": r}) for r in range(disorder.realizations)]
    return {
        "damping": [
            partial(damp, verlet.updated({"contact.damping_ratio": ratio}), damping.time_step)
            for ratio in damping.ratios
        ],
        "stop_energy": [partial(stopped, _scene(asked, mu), asked.stop_energies) for mu in asked.frictions],
        "swing": [partial(swing, scene, asked.swing.steps, asked.swing.read_every) for scene in bare],
        "disorder": [partial(disordered, scene, grid.tolist(), disorder.width) for scene in slabs],
        "time_step": [partial(respond, usual.updated({"protocol.time_step": step})) for step in asked.time_steps],
        "integrators": [
            partial(respond, integrated.updated({"protocol.integrator": name})) for name in asked.integrators
        ],
    }


def _responses(found: Sequence[StoppedResponse], x: xr.Variable, **along: tuple[Sequence[Any], str]) -> xr.Dataset:
    """With how far they are from the first."""
    first = found[0].floor_response
    compared = [
        replace(one, difference=np.abs(one.floor_response - first).max() / np.abs(first).max()) for one in found
    ]
    return table_along(compared, **along).assign_coords(x=x)


ACCELERATION = "mean acceleration of disks with two contacts or more, in g"


def bottom(packing: Packing) -> NDArray[np.intp]:
    """The disks on the floor."""
    return np.flatnonzero(packing.row == 0)


def rest_and_loaded(scene: Scene) -> tuple[Problem, State, State]:
    """The problem with the scene's load, its state at rest and the loaded one, both by dynamics."""
    path = LoadPath.of(scene.updated({"protocol.method": "dynamics"}))
    return path.problem, path.rest, path.at(1.0)


def per_load(problem: Problem, rest: State, loaded: State, disks: NDArray[np.intp]) -> FloatArray:
    """The response of floor ``disks``."""
    return floor_response(rest, loaded, disks, float(np.abs(problem.load[:, 1]).sum()))


@record
class Errors:
    """What an early stop leaves in the floor forces, against the statically finished states."""

    rest_error: float = column("largest error of a floor force at rest, per largest floor force")
    loaded_error: float = column("largest error of a floor force under load, per largest floor force")
    response_error: float = column("largest error of the floor response, per largest response")


def stopped(scene: Scene, stop_energies: Sequence[float]) -> list[Errors]:
    """Rest and one load by dynamics alone, stopped at each energy; the finish starts from the smallest."""

    def floor(energy: float, **finish: bool) -> list[FloatArray]:
        changes = {"stop_kinetic_energy": energy, **finish}
        problem, *states = rest_and_loaded(scene.updated({"protocol": changes}))
        rest, loaded = (floor_force(state, bottom(problem.packing)) for state in states)
        return [rest, loaded, loaded - rest]

    true = floor(min(stop_energies))
    found = []
    for energy in stop_energies:
        forces = floor(energy, static_finish=False)
        found.append(Errors(*(np.abs(one - of).max() / np.abs(of).max() for one, of in zip(forces, true, strict=True))))
    return found


@record
class Readings:
    """What is read of a run that goes on after its stop."""

    mean_acceleration: FloatArray = column(ACCELERATION, "reading")


def swing(scene: Scene, steps: int, read_every: int) -> Readings:
    problem, _, loaded = rest_and_loaded(scene)
    dynamics = Dynamics(problem, loaded, scene.protocol.integrator, resolve_time_step(problem))
    dynamics.set_ramps(load=(1.0, 1.0, 0.0))
    found = []
    for _ in range(steps // read_every):
        dynamics.advance(read_every)
        found.append(dynamics.mean_acceleration())
    return Readings(np.array(found))


@record
class StoppedResponse:
    """The response to one load by the paper's protocol, and what its stop criteria read."""

    floor_response: FloatArray = column("vertical floor force that the load adds, per applied force", "floor_disk")
    difference: float = column(
        "largest difference of the floor response from that of the first entry, per largest response"
    )
    network_fixed_steps: float = column("time steps for which the contact network had not changed, at least")
    sliding_contacts: float = column("contacts at the Coulomb limit")
    mean_acceleration: float = column(ACCELERATION)
    loose_disks: float = column("disks with fewer than two contacts")
    kinetic_energy: float = column("kinetic energy per disk at the stop")


def respond(scene: Scene) -> StoppedResponse:
    """Without its difference from another one."""
    problem, rest, loaded = rest_and_loaded(scene)
    response = per_load(problem, rest, loaded, bottom(problem.packing))
    names = ("network_fixed_steps", "sliding_contacts", "mean_acceleration", "loose_disks", "kinetic_energy")
    return StoppedResponse(response, np.nan, *(float(getattr(loaded.reached, name)) for name in names))


@record
class DisorderedResponse:
    """The smoothed response of one disordered slab."""

    stopped: FloatArray = column("smoothed floor response per applied force, of runs that stop early, in 1/radius", "x")
    finished: FloatArray = column("smoothed floor response per applied force, in equilibrium, in 1/radius", "x")


def disordered(scene: Scene, x: Sequence[float], width: float) -> DisorderedResponse:
    """Without and with a static finish.

    Runs that stop at 1e-13 before the finish give the same response but for a thousandth of it, in 1.7 times the time.
    """

    def response(scene: Scene) -> FloatArray:
        problem, rest, loaded = rest_and_loaded(scene)
        disks = floor_disks([rest, loaded], bottom(problem.packing))
        place = rest.position[disks, 0] - rest.position[problem.load_disk[0], 0]
        return smoothed_response(x, place, per_load(problem, rest, loaded, disks), width)

    return DisorderedResponse(response(scene.updated({"protocol.static_finish": False})), response(scene))


@record
class Damped:
    """Relaxation under gravity with one damping ratio."""

    relaxation_time: float = column("time until the kinetic energy's envelope is at rest, in sqrt(radius/g)")
    settled: np.int8 = column("1 if it came to rest")
    beeman_limit: float = column("largest stable time step of Beeman's method in sqrt(radius/g)")


def damp(scene: Scene, time_step: float) -> Damped:
    problem = Problem.from_scene(scene)
    protocol = scene.protocol
    dynamics = Dynamics(problem, problem.bare_state(), protocol.integrator, time_step)
    state = relax(dynamics, Stop(protocol.stop_kinetic_energy, "envelope", protocol.maximum_steps))
    return Damped(dynamics.time, np.int8(bool(state.reached.settled)), stability_limit(problem, "beeman"))
