"""Runs of the dynamics, and what is read of each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from granular_response.observe.floor import floor_disks, floor_force, floor_response, smoothed_response
from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import resolve_time_step, stability_limit
from granular_response.state import FloatArray, State
from granular_response.studies import LoadPath
from granular_response_paper.records import column, record

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
