"""The loss of symmetry of the response at large friction, and what decides its sign (Sec. V.E).

From rest, a force is ramped up and the motion followed until it dies out, as in the paper, which names no duration
of the ramp. The force at which the response loses its symmetry is bracketed for several durations of the ramp and
time steps. At one force beyond it, copies of the packing that differ in the order of the arithmetic or by
rounding-sized displacements tell what the sign depends on. And equilibria of the symmetric branch are displaced
a little under constant force, which tells a loss of stability from a growth of asymmetry during loading.

Forces are in mean disk weights, lengths in mean radii, times in sqrt(R/g).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.observe.events import EventNotBracketed, bisect_event
from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import resolve_time_step
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.sweeps.rest import rest_of
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.symmetry_breaking.parameters import Copies, Parameters, Protocol
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.tasks import computed

#: When a displaced equilibrium counts as settled, and how many steps it gets: growth from a small displacement
#: shows long before.
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


def ramps(asked: Parameters, rest: State, protocol: Protocol) -> list[BracketResult]:
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
    asked: Parameters, rest: State, protocol: Protocol, time_step: float, first: tuple[float, float] | None
) -> BracketResult:
    """For one time step; the loss is looked for between ``first`` before anywhere else."""
    path = slab.LoadPath.of(protocol.scene(asked.scene, time_step), rest)
    measures, above = slab.Measures(path), asked.asymmetry

    def asymmetric(force: float) -> bool:
        return force > 0.0 and measures.asymmetry(path.at(force)) > above

    low, high = protocol.between
    if first is not None and not asymmetric(first[0]) and asymmetric(first[1]):
        low, high = first
    try:
        found = bisect_event(asymmetric, low, high, asked.tolerance)
        low, high = found.low, found.high
    except EventNotBracketed:
        low, high = (0.0, low) if asymmetric(low) else (high, float("nan"))
    forces = tuple(sorted(path.known))
    how = f"dynamics with a ramp of {protocol.ramp_time:g} and a time step of {time_step:g}"
    text = f"{how}: the asymmetry of the floor response exceeds {above:g}"
    event = slab.Event("loss_of_symmetry", measures.friction, low, high, text)
    ends = tuple(path.known[force] for force in (low, high) if force in path.known)
    measured = slab.measured(measures, path.through(forces))
    return BracketResult(protocol.ramp_time, time_step, event, forces, measured, ends if len(ends) == 2 else ())


def copied(scene: Scene, packing: Packing, force: float) -> xr.Dataset:
    """What is measured under one force on one copy of the packing, settled under gravity anew."""
    path = slab.LoadPath.of(scene, packing=packing)
    return slab.measured(slab.Measures(path), [path.at(force)])


def held(scene: Scene, rest: State, forces: tuple[float, ...], displacement: float) -> xr.Dataset:
    """Equilibria at ``forces`` displaced by up to ``displacement``, settled under constant force and measured."""
    path = slab.LoadPath.of(scene, rest)
    states, measures = path.through(forces), slab.Measures(path)
    settled = [_displaced(path.problem, state, displacement) for state in states]
    moved = [np.abs(after.position - before.position).max() for before, after in zip(states, settled, strict=True)]
    branch = slab.measured(measures, states)
    further = variables(
        branch_asymmetry=("force", branch["asymmetry"], "asymmetry of the floor response before the displacement"),
        branch_response=("force floor_disk", branch["floor_response"], "floor response before the displacement"),
        moved=("force", moved, f"largest distance from the place before {RADII}"),
        displacement=("", displacement, f"largest random displacement {RADII}"),
    )
    found = slab.measured_along("force", [slab.measured(measures, settled)]).assign(further)
    return found.assign_coords(axes(force=(forces, APPLIED)))


def _displaced(problem: Problem, state: State, displacement: float) -> State:
    shift = _random_shift(state.position.shape, displacement, seed=0)
    start = problem.with_static_forces(replace(state, position=state.position + shift))
    dynamics = Dynamics(problem, start, problem.scene.protocol.integrator, resolve_time_step(problem))
    factor = state.load_factor
    settled = relax(dynamics, HELD_STOP, load=(factor, factor, 0.0))
    return replace(settled, reached=settled.reached.after(state.reached))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets of the loss of symmetry; which method finds the symmetric branch is ``method``.

    Returns
    -------
    ``brackets`` (event), ``runs`` (run), ``copies`` (copy), ``held`` (force), and ``states``: at rest, and the
    last symmetric and the first asymmetric state of the first protocol.
    """
    base, protocols = parameters.scene, parameters.protocols
    first = protocols[0].scene(base, protocols[0].time_steps[0])
    rest = computed({"rest": partial(rest_of, first)}, "rest state")["rest"]

    copies = _copies(parameters.copies, first.packing.build())
    force, of_held = parameters.copies.force, parameters.held
    # long ones first, so that no core waits for them in the end
    longest = sorted(enumerate(protocols), key=lambda one: -(100.0 + one[1].ramp_time) / min(one[1].time_steps))
    tasks: dict[Any, Callable[[], Any]] = {k: partial(ramps, parameters, rest, protocol) for k, protocol in longest}
    tasks["held"] = partial(held, parameters.base, rest, of_held.forces, of_held.displacement)
    tasks |= {name: partial(copied, first, copy, force) for name, copy in copies.items()}
    done = computed(tasks, "loss of symmetry")
    found: list[BracketResult] = [result for k in range(len(protocols)) for result in done[k]]
    problem = Problem.from_scene(base).with_loads(rest.position)
    datasets = {
        "brackets": slab.events_dataset([one.event for one in found]).assign(table(found, "event").variables),
        "runs": _runs_dataset(found),
        "held": done["held"],
        "copies": _copies_dataset({name: done[name] for name in copies}, force),
        "states": slab.states_picture([rest, *found[0].states], problem),
    }
    for dataset in datasets.values():
        dataset["friction_coefficient"] = variable((), base.contact.friction, "coefficient of friction between disks")
    return labelled(datasets, base)


def _copies(given: Copies, packing: Packing) -> dict[str, Packing]:
    copies = {"as it is": packing, "numbered from right to left": mirrored(packing)}
    copies |= {f"numbered at random, seed {seed}": shuffled(packing, seed) for seed in given.seeds}
    for seed in given.seeds:
        shift = _random_shift(packing.position.shape, given.displacement, seed)
        copies[f"displaced at random, seed {seed}"] = displaced(packing, shift)
        copies[f"displaced at random, seed {seed}, mirror image"] = displaced(packing, shift, mirror_image=True)
    return copies


def mirrored(packing: Packing) -> Packing:
    """The mirror image of a packing, each disk with its number: for a symmetric lattice only the numbers change."""
    position = packing.position * np.array([-1.0, 1.0]) + np.array([packing.width, 0.0])
    return replace(packing, position=position)


def shuffled(packing: Packing, seed: int) -> Packing:
    """The same disks numbered at random.

    Without the order of a lattice, whose neighbours are known by the numbers of the disks.
    """
    order = np.random.default_rng(seed).permutation(packing.n)
    arrays = {name: getattr(packing, name)[order] for name in ("position", "radius", "row")}
    return replace(packing, **arrays, left=None)


def displaced(packing: Packing, shift: FloatArray, *, mirror_image: bool = False) -> Packing:
    """The packing with its disks moved by ``shift`` (n, 2), or by the mirror image of it."""
    if mirror_image:
        image = network.mirror_disks(packing.position, 0.5 * packing.width)
        shift = shift[image] * np.array([-1.0, 1.0])
    return replace(packing, position=packing.position + shift)


def _random_shift(shape: tuple[int, ...], size: float, seed: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(-size, size, shape)


def _runs_dataset(found: Sequence[BracketResult]) -> xr.Dataset:
    """Every run, in the order of the protocols, their time steps and then of the forces."""
    dataset = slab.measured_along("run", [one.measured for one in found])
    of_run = table([one for one in found for _ in one.forces], "run")
    forces = np.concatenate([one.forces for one in found])
    return dataset.assign(of_run.variables).assign(force=variable("run", forces, APPLIED))


def _copies_dataset(copies: dict[str, xr.Dataset], force: float) -> xr.Dataset:
    """The copies, and how far each is from the first one and from its mirror image."""
    dataset = slab.measured_along("copy", list(copies.values()))
    response = dataset["floor_response"].values
    largest = response[0].max()
    text = "largest difference of the floor response to {} of the first copy, per largest response"
    one, other = (np.abs(image - response[0]).max(axis=1) / largest for image in (response, response[:, ::-1]))
    return dataset.assign(
        variables(
            name=("copy", list(copies), "how the copy differs from the packing"),
            force=("", force, APPLIED),
            difference=("copy", one, text.format("that")),
            mirror_difference=("copy", other, text.format("the mirror image")),
        )
    )
