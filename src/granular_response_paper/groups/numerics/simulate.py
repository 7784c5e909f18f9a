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
from numpy.typing import NDArray

from granular_response.observe.floor import floor_disks, floor_force, floor_response, smoothed_response
from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.solvers.timestep import resolve_time_step, stability_limit
from granular_response.state import FloatArray, State
from granular_response.store.variables import WEIGHTS, variable
from granular_response.sweeps.rest import rest_state
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.numerics.parameters import Parameters
from granular_response_paper.records import column, record, table_along
from granular_response_paper.tasks import computed

#: Steps between two readings of the kinetic energy of a restarted state.
READ_EVERY = 100

#: When the kinetic energy is below the limit: the first time that it is, or all along a slow swing.
STOP_RULES = ("instantaneous", "envelope")

ACCELERATION = "mean acceleration of disks with two contacts or more, in g"


@record
class Errors:
    """What an early stop leaves in the floor forces, against the statically finished states."""

    rest_error: float = column("largest error of a floor force at rest, per largest floor force")
    loaded_error: float = column("largest error of a floor force under load, per largest floor force")
    response_error: float = column("largest error of the floor response, per largest response")
    sum_error: float = column("error of the sum of the floor response")


def stopped(scene: Scene, stop_energies: Sequence[float]) -> list[Errors]:
    """Rest and one load by dynamics alone, stopped at each energy; the finish starts from the smallest."""

    def floor(energy: float, **finish: bool) -> tuple[FloatArray, FloatArray]:
        changes = {"stop_kinetic_energy": energy, **finish}
        problem, *states = rest_and_loaded(scene.updated({"protocol": changes}))
        rest, loaded = (floor_force(state, _bottom(problem.packing)) for state in states)
        return rest, loaded

    exact, exactly = floor(min(stop_energies))
    true = exactly - exact
    found = []
    for energy in stop_energies:
        force, under = floor(energy, static_finish=False)
        response = under - force
        found.append(
            Errors(
                np.abs(force - exact).max() / exact.max(),
                np.abs(under - exactly).max() / exactly.max(),
                np.abs(response - true).max() / np.abs(true).max(),
                abs(response.sum() - true.sum()) / np.abs(true.sum()),
            )
        )
    return found


@record
class Readings:
    """What is read of dynamics that goes on under a constant load."""

    mean_acceleration: FloatArray = column(ACCELERATION, "reading")
    kinetic_energy: FloatArray = column("kinetic energy per disk", "reading")


def go_on(problem: Problem, state: State, load: float, steps: int, every: int) -> Readings:
    """From ``state``, at ``every`` so many steps."""
    dynamics = Dynamics(problem, state, problem.scene.protocol.integrator, resolve_time_step(problem))
    dynamics.set_ramps(load=(load, load, 0.0))
    found = []
    for _ in range(steps // every):
        dynamics.advance(every)
        found.append((dynamics.mean_acceleration(), dynamics.kinetic_energy()))
    return Readings(*np.array(found).T)


def restart(scene: Scene, force: float, steps: int) -> Readings:
    """A statically finished frictionless state under ``force``, put back into the dynamics from rest."""
    problem = Problem.from_scene(scene)
    state = rest_state(problem)
    problem = problem.with_loads(state.position)
    if force:
        state = loaded_states(problem, state, [force])[1][0]
    still = replace(
        state, velocity=np.zeros_like(state.velocity), angular_velocity=np.zeros_like(state.angular_velocity)
    )
    return go_on(problem, still, force, steps, READ_EVERY)


def swing(scene: Scene, steps: int, read_every: int) -> Readings:
    """What a run does that goes on after its stop."""
    problem, _, loaded = rest_and_loaded(scene)
    return go_on(problem, loaded, 1.0, steps, read_every)


@record
class Response:
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


def respond(scene: Scene) -> Response:
    """Without its difference from another one."""
    problem, rest, loaded = rest_and_loaded(scene)
    response = floor_response(rest, loaded, _bottom(problem.packing), _total(problem))
    names = ("network_fixed_steps", "sliding_contacts", "mean_acceleration", "loose_disks", "kinetic_energy")
    return Response(response, np.nan, *(float(getattr(loaded.reached, name)) for name in names))


@record
class Disordered:
    """The smoothed response of one disordered slab."""

    stopped: FloatArray = column("smoothed floor response per applied force, of runs that stop early, in 1/radius", "x")
    finished: FloatArray = column("smoothed floor response per applied force, in equilibrium, in 1/radius", "x")


def disordered(scene: Scene, stop_energy: float, x: Sequence[float], width: float) -> Disordered:
    """Stopped early, and in equilibrium."""

    def response(scene: Scene) -> FloatArray:
        problem, rest, loaded = rest_and_loaded(scene)
        disks = floor_disks([rest, loaded], _bottom(problem.packing))
        place = rest.position[disks, 0] - rest.position[problem.load_disk[0], 0]
        return smoothed_response(x, place, floor_response(rest, loaded, disks, _total(problem)), width)

    early = {"protocol.stop_kinetic_energy": stop_energy, "protocol.static_finish": False}
    return Disordered(response(scene.updated(early)), response(scene))


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


def rest_and_loaded(scene: Scene) -> tuple[Problem, State, State]:
    """The problem with the scene's load, its state at rest and the loaded one, both by dynamics."""
    problem = Problem.from_scene(scene.updated({"protocol.method": "dynamics"}))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    (loaded,) = loaded_states(problem, rest, [1.0])[1]
    return problem, rest, loaded


def _bottom(packing: Packing) -> NDArray[np.intp]:
    return np.flatnonzero(packing.row == 0)


def _total(problem: Problem) -> float:
    return float(np.abs(problem.load[:, 1]).sum())


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``stop_energy``, ``restart``, ``at_rest``, ``swing``, ``time_step``, ``integrators``, ``damping`` and
    ``disorder``.
    """
    asked, base = parameters, parameters.scene
    grid = _grid(asked)
    tasks = _tasks(asked, grid)
    done = computed({(name, k): task for name, several in tasks.items() for k, task in enumerate(several)}, "runs")
    found = {name: [done[name, k] for k in range(len(several))] for name, several in tasks.items()}

    packing = base.packing.build()
    from_load = "position from the loaded disk in mean disk radii"
    x = variable("floor_disk", packing.position[_bottom(packing), 0] - 0.5 * packing.width, from_load)
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
    return labelled(datasets, _with_friction(asked))


def _grid(asked: Parameters) -> FloatArray:
    """Distances from the loaded disk at which disordered slabs are compared (radii)."""
    count = round(asked.disorder.reach / asked.disorder.spacing)
    return asked.disorder.spacing * np.arange(-count, count + 1, dtype=np.float64)


def _with_friction(asked: Parameters) -> Scene:
    return asked.scene.updated({**_load(asked.force), "contact.friction": asked.friction})


def _load(force: float) -> dict[str, Any]:
    return {"loads": [{"disk": "top-centre", "force": [0.0, -force]}]}


def _tasks(asked: Parameters, grid: FloatArray) -> Mapping[str, list[partial[Any]]]:
    """The runs of each study, in the order of its values."""
    base, friction, of_swing, disorder = asked.scene, _with_friction(asked), asked.swing, asked.disorder
    verlet = {
        "contact.friction": asked.friction,
        "protocol.integrator": "verlet",
        "protocol.stop_kinetic_energy": asked.damping.stop_kinetic_energy,
    }
    frictionless = base.updated({"contact.friction": 0.0, **_load(1.0)})
    bare = [friction.updated({"protocol.stop_rule": rule, "protocol.static_finish": False}) for rule in STOP_RULES]
    with_integrator = {"protocol.time_step": asked.integrator_time_step}
    slabs = [
        disorder.scene.updated({**_load(asked.force), "packing.realization": r}) for r in range(disorder.realizations)
    ]
    return {
        "damping": [
            partial(damp, base.updated({**verlet, "contact.damping_ratio": ratio}), asked.damping.time_step)
            for ratio in asked.damping.ratios
        ],
        "stop_energy": [
            partial(stopped, base.updated({**_load(asked.force), "contact.friction": mu}), asked.stop_energies)
            for mu in asked.frictions
        ],
        "restart": [partial(restart, frictionless, force, asked.restart.steps) for force in asked.restart.forces],
        "swing": [partial(swing, scene, of_swing.steps, of_swing.read_every) for scene in bare],
        "disorder": [
            partial(disordered, scene, disorder.stop_kinetic_energy, grid.tolist(), disorder.width) for scene in slabs
        ],
        "time_step": [partial(respond, friction.updated({"protocol.time_step": step})) for step in asked.time_steps],
        "integrators": [
            partial(respond, friction.updated({**with_integrator, "protocol.integrator": name}))
            for name in asked.integrators
        ],
    }


def _readings(found: Sequence[Readings], every: int, **along: tuple[Sequence[Any], str]) -> xr.Dataset:
    """With the step of each."""
    step = variable("reading", every * np.arange(1, found[0].kinetic_energy.size + 1), "time steps")
    return table_along(found, **along).assign_coords(step=step)


def _responses(found: Sequence[Response], x: xr.Variable, **along: tuple[Sequence[Any], str]) -> xr.Dataset:
    """With how far they are from the first."""
    first = found[0].floor_response
    compared = [
        replace(one, difference=np.abs(one.floor_response - first).max() / np.abs(first).max()) for one in found
    ]
    return table_along(compared, **along).assign_coords(x=x)
