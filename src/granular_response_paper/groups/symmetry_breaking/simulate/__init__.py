"""The loss of symmetry of the response at large friction, and what decides its sign (Sec. V.E).

From rest, a force is ramped up and the motion followed until it dies out, as in the paper, which names no duration
of the ramp. The force at which the response loses its symmetry is bracketed for several durations of the ramp and
time steps. At one force beyond it, copies of the packing that differ in the order of the arithmetic or by
rounding-sized displacements tell what the sign depends on. And equilibria of the symmetric branch are displaced
a little under constant force, which tells a loss of stability from a growth of asymmetry during loading.

Forces are in mean disk weights, lengths in mean radii, times in sqrt(R/g).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response import studies
from granular_response.observe import network
from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.timestep import resolve_time_step
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.sweeps.rest import rest_of
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.symmetry_breaking.parameters import Copies, LoadRamp, Parameters
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.tasks import computed

#: When a displaced equilibrium counts as settled. Growth from a small displacement shows long before so many steps.
HELD_STOP = Stop(kinetic_energy=1e-15, rule="envelope", maximum_steps=200_000)
APPLIED = f"applied force {WEIGHTS}"


@record
class BracketResult:
    """The bracket for one ramp and time step, with all runs that it took."""

    ramp_time: float = column("duration of the load ramp in sqrt(radius/g)")
    time_step: float = column("time step in sqrt(radius/g)")
    event: slab.Event
    forces: tuple[float, ...]
    measured: xr.Dataset  #: at ``forces``
    states: tuple[State, ...]  #: the last symmetric and the first asymmetric one, if there are both


def ramps(asked: Parameters, rest: State, protocol: LoadRamp) -> list[BracketResult]:
    """Bracket the loss of symmetry for one duration of the ramp, by one time step after another.

    A further time step is tried where the one before it lost its symmetry, and over all forces only if it does not
    lose it there.
    """
    results: list[BracketResult] = []
    first = None
    for time_step in protocol.time_steps:
        results.append(bracket(asked, rest, protocol, time_step, first))
        found = results[-1].event
        first = (found.low, found.high) if 0.0 < found.low < found.high else None
    return results


def bracket(
    asked: Parameters, rest: State, protocol: LoadRamp, time_step: float, first: tuple[float, float] | None
) -> BracketResult:
    """For one time step; the loss is looked for between ``first`` before anywhere else."""
    path = studies.LoadPath.of(protocol.scene(asked.scene, time_step), rest)
    event = narrowed(asked, path, protocol, time_step, first)
    forces = tuple(sorted(path.known))
    ends = tuple(path.known[force] for force in (event.low, event.high) if force in path.known)
    found = slab.measured(studies.Measures(path), path.through(forces))
    return BracketResult(protocol.ramp_time, time_step, event, forces, found, ends if len(ends) == 2 else ())


def narrowed(
    asked: Parameters, path: studies.LoadPath, protocol: LoadRamp, time_step: float, first: tuple[float, float] | None
) -> slab.Event:
    """Where the states of a path lose their symmetry; see :func:`bracket`."""
    measures, above = studies.Measures(path), asked.asymmetry

    def asymmetric(force: float) -> bool:
        return force > 0.0 and measures.asymmetry(path.at(force)) > above

    low, high = protocol.between
    if first is not None and not asymmetric(first[0]) and asymmetric(first[1]):
        low, high = first
    ends = slab.between(asymmetric, low, high, asked.tolerance)
    how = f"dynamics with a ramp of {protocol.ramp_time:g} and a time step of {time_step:g}"
    text = f"{how}: the asymmetry of the floor response exceeds {above:g}"
    return slab.Event("loss_of_symmetry", measures.friction, *ends, text)


def equal_rows(asked: Parameters) -> slab.Event:
    """For the first protocol and a slab with as many disks in every row."""
    first, given = asked.protocols[0], asked.equal_rows
    scene = first.scene(asked.scene, first.time_steps[0])
    path = studies.LoadPath.of(scene, packing=slab.equal_rows(given.layers, given.disks))
    protocol = first.model_copy(update={"between": given.between})
    return narrowed(asked, path, protocol, first.time_steps[0], None)


def held(asked: Parameters, rest: State) -> xr.Dataset:
    """Equilibria that are displaced a little, settled under constant force and measured."""
    path, given = studies.LoadPath.of(asked.base, rest), asked.held
    problem, states, measures = path.problem, path.through(given.forces), studies.Measures(path)
    settled = []
    for state in states:
        shift = random_shift(state.position.shape, given.displacement, seed=0)
        start = problem.with_static_forces(replace(state, position=state.position + shift))
        dynamics = Dynamics(problem, start, problem.scene.protocol.integrator, resolve_time_step(problem))
        after = relax(dynamics, HELD_STOP, load=(state.load_factor, state.load_factor, 0.0))
        settled.append(replace(after, reached=after.reached.after(state.reached)))
    found = slab.measured_along("force", [slab.measured(measures, settled)])
    found["displacement"] = variable((), given.displacement, f"largest random displacement {RADII}")
    return found.assign_coords(axes(force=(given.forces, APPLIED)))


def copies_of(given: Copies, packing: Packing) -> dict[str, Packing]:
    """By how they differ from the packing."""
    place, name = packing.position, f"displaced at random, seed {given.seed}"
    shift = random_shift(place.shape, given.displacement, given.seed)
    image = shift[network.mirror_disks(place, 0.5 * packing.width)] * [-1.0, 1.0]
    found = {
        "as it is": place,
        "numbered from right to left": place * [-1.0, 1.0] + [packing.width, 0.0],
        name: place + shift,
        f"{name}, mirror image": place + image,
    }
    return {name: replace(packing, position=position) for name, position in found.items()}


def random_shift(shape: tuple[int, ...], size: float, seed: int) -> FloatArray:
    """Displacements by up to ``size`` along each axis."""
    return np.random.default_rng(seed).uniform(-size, size, shape)


def copied(scene: Scene, packing: Packing, force: float) -> xr.Dataset:
    """What is measured under one force on one copy of the packing, settled under gravity anew."""
    path = studies.LoadPath.of(scene, packing=packing)
    return slab.measured(studies.Measures(path), [path.at(force)])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``brackets`` and ``equal_rows`` (event), ``runs`` (run), ``copies`` (copy), ``held`` (force), and
    ``states``: at rest, and the last symmetric and the first asymmetric one of the first protocol.
    """
    base, protocols = parameters.scene, parameters.protocols
    first = protocols[0].scene(base, protocols[0].time_steps[0])
    rest = computed({"rest": partial(rest_of, first)}, "rest state")["rest"]

    packings, force = copies_of(parameters.copies, first.packing.build()), parameters.copies.force
    # long ones first, so that no core waits for them in the end
    longest = sorted(enumerate(protocols), key=lambda one: -(100.0 + one[1].ramp_time) / min(one[1].time_steps))
    tasks: dict[Any, Callable[[], Any]] = {k: partial(ramps, parameters, rest, protocol) for k, protocol in longest}
    tasks["held"] = partial(held, parameters, rest)
    tasks["equal rows"] = partial(equal_rows, parameters)
    tasks |= {name: partial(copied, first, copy, force) for name, copy in packings.items()}
    done = computed(tasks, "loss of symmetry")
    found: list[BracketResult] = [result for k in range(len(protocols)) for result in done[k]]
    runs = slab.measured_along("run", [one.measured for one in found])
    of_run = table([one for one in found for _ in one.forces], "run")
    forces = np.concatenate([one.forces for one in found])
    datasets = {
        "brackets": table([one.event for one in found], "event").assign(table(found, "event").variables),
        "equal_rows": table([done["equal rows"]], "event"),
        "runs": runs.assign(of_run.variables).assign(force=variable("run", forces, APPLIED)),
        "held": done["held"],
        "copies": slab.measured_along("copy", [done[name] for name in packings]).assign(
            variables(
                name=("copy", list(packings), "how the copy differs from the packing"), force=("", force, APPLIED)
            )
        ),
        "states": slab.states_picture([rest, *found[0].states], studies.LoadPath.of(base, rest).problem),
    }
    friction = variable((), base.contact.friction, "coefficient of friction between disks")
    datasets["states"] = datasets["states"].assign(friction_coefficient=friction)
    return labelled(datasets, base)
