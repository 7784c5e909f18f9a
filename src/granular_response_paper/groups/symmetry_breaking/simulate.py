"""The loss of symmetry of the response at large friction, and what decides its sign (Sec. V.E).

From rest, a force is ramped up and the motion followed until it dies out, as in the paper, which names no duration
of the ramp. The force at which the response loses its symmetry is bracketed for several durations of the ramp and
time steps. At one force beyond it, copies of the packing that differ in the order of the arithmetic or by
rounding-sized displacements tell what the sign depends on. And equilibria of the symmetric branch are displaced
a little under constant force, which tells a loss of stability from a growth of asymmetry during loading.

Forces are in mean disk weights, lengths in mean radii, times in sqrt(R/g).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.observe.events import EventNotBracketed, bisect_event
from granular_response.scene import Packing, Scene
from granular_response.solve import Dynamics, Problem, Stop, relax
from granular_response.solve.timestep import resolve_time_step
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, variable
from granular_response.sweeps.rest import rest_of
from granular_response.sweeps.tasks import map_tasks, run_tasks
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.symmetry_breaking.parameters import Copies, Parameters, Protocol

#: When a displaced equilibrium counts as settled, and how many steps it gets: growth from a small displacement
#: shows long before.
HELD_STOP = Stop(kinetic_energy=1e-15, rule="envelope", maximum_steps=200_000)


@dataclass(frozen=True)
class BracketResult:
    """The bracket for one ramp and time step, with all runs that it took."""

    ramp_time: float
    time_step: float
    event: slab.Event
    forces: tuple[float, ...]
    measured: xr.Dataset  #: at ``forces``
    states: tuple[State, ...]  #: the last symmetric and the first asymmetric one, if there are both


@dataclass(frozen=True)
class RampTask:
    """Bracket the loss of symmetry for one duration of the ramp, by one time step after another.

    A further time step is tried where the one before it lost its symmetry, and over all forces only if it does not
    lose it there.
    """

    base: Scene
    rest: State
    protocol: Protocol
    tolerance: float
    above: float  #: asymmetry that counts as lost symmetry

    def run(self) -> list[BracketResult]:
        results: list[BracketResult] = []
        for time_step in self.protocol.time_steps:
            found = results[-1].event if results else None
            first = (found.low, found.high) if found is not None and 0.0 < found.low < found.high else None
            results.append(self._bracket(time_step, first))
        return results

    def _bracket(self, time_step: float, first: tuple[float, float] | None) -> BracketResult:
        """For one time step; the loss is looked for between ``first`` before anywhere else."""
        path = slab.LoadPath.of(self.protocol.scene(self.base, time_step), self.rest)
        measures = slab.Measures(path)

        def asymmetric(force: float) -> bool:
            return force > 0.0 and measures.asymmetry(path.at(force)) > self.above

        low, high = self.protocol.between
        if first is not None and not asymmetric(first[0]) and asymmetric(first[1]):
            low, high = first
        try:
            bracket = bisect_event(asymmetric, low, high, self.tolerance)
            low, high = bracket.low, bracket.high
        except EventNotBracketed:
            low, high = (0.0, low) if asymmetric(low) else (high, float("nan"))
        forces = tuple(sorted(path.known))
        text = (
            f"dynamics with a ramp of {self.protocol.ramp_time:g} and a time step of "
            f"{time_step:g}: the asymmetry of the floor response exceeds {self.above:g}"
        )
        event = slab.Event("loss_of_symmetry", measures.friction, low, high, text)
        ends = tuple(path.known[force] for force in (low, high) if force in path.known)
        measured = slab.measured(measures, [path.known[force] for force in forces])
        states = ends if len(ends) == 2 else ()
        return BracketResult(self.protocol.ramp_time, time_step, event, forces, measured, states)


@dataclass(frozen=True)
class CopyTask:
    """One force on one copy of the packing, settled under gravity anew."""

    scene: Scene
    name: str
    packing: Packing
    force: float

    def run(self) -> xr.Dataset:
        path = slab.LoadPath.of(self.scene, packing=self.packing)
        return slab.measured(slab.Measures(path), [path.at(self.force)])


@dataclass(frozen=True)
class HeldResult:
    """Equilibria of the load path, each before and after a small displacement under constant force."""

    branch: xr.Dataset
    displaced: xr.Dataset
    displacement: FloatArray  #: (force,) largest distance of a disk from its place before


@dataclass(frozen=True)
class HeldTask:
    """Displace the equilibria at ``forces`` by up to ``displacement`` and let them settle."""

    scene: Scene
    rest: State
    forces: tuple[float, ...]
    displacement: float

    def run(self) -> HeldResult:
        path = slab.LoadPath.of(self.scene, self.rest)
        states = path.through(self.forces)
        settled = [self._displaced(path.problem, state) for state in states]
        measures = slab.Measures(path)
        moved = [
            float(np.abs(after.position - before.position).max()) for before, after in zip(states, settled, strict=True)
        ]
        return HeldResult(slab.measured(measures, states), slab.measured(measures, settled), np.array(moved))

    def _displaced(self, problem: Problem, state: State) -> State:
        shift = _random_shift(state.position.shape, self.displacement, seed=0)
        start = problem.with_static_forces(replace(state, position=state.position + shift))
        protocol = problem.scene.protocol
        dynamics = Dynamics(problem, start, protocol.integrator, resolve_time_step(problem))
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
    (rest,) = map_tasks(rest_of, [first], workers=1, what="rest state")

    ramps = [RampTask(base, rest, protocol, parameters.tolerance, parameters.asymmetry) for protocol in protocols]
    copies = _copy_tasks(parameters.copies, first)
    held = HeldTask(parameters.base, rest, parameters.held.forces, parameters.held.displacement)
    # long ones first, so that no core waits for them in the end
    longest = sorted(ramps, key=lambda t: -(100.0 + t.protocol.ramp_time) / min(t.protocol.time_steps))
    results = run_tasks([*longest, held, *copies], what="loss of symmetry")
    found: list[BracketResult] = [result for task in ramps for result in results[longest.index(task)]]

    datasets = {
        "brackets": _brackets_dataset(found),
        "runs": _runs_dataset(found),
        "held": _held_dataset(held, results[len(ramps)]),
        "copies": _copies_dataset(copies, results[len(ramps) + 1 :]),
    }
    problem = Problem.from_scene(base).with_loads(rest.position)
    datasets["states"] = slab.states_picture([rest, *found[0].states], problem)
    for dataset in datasets.values():
        dataset["friction_coefficient"] = variable((), base.contact.friction, "coefficient of friction between disks")
    return labelled(datasets, base)


def _copy_tasks(given: Copies, scene: Scene) -> list[CopyTask]:
    packing = scene.packing.build()
    copies = {"as it is": packing, "numbered from right to left": mirrored(packing)}
    for seed in given.seeds:
        copies[f"numbered at random, seed {seed}"] = shuffled(packing, seed)
    for seed in given.seeds:
        shift = _random_shift(packing.position.shape, given.displacement, seed)
        for image in (False, True):
            name = f"displaced at random, seed {seed}" + (", mirror image" if image else "")
            copies[name] = displaced(packing, shift, mirror_image=image)
    return [CopyTask(scene, name, copy, given.force) for name, copy in copies.items()]


def mirrored(packing: Packing) -> Packing:
    """The mirror image of a packing, each disk with its number: for a symmetric lattice only the numbers change."""
    position = packing.position * np.array([-1.0, 1.0]) + np.array([packing.width, 0.0])
    return replace(packing, position=position)


def shuffled(packing: Packing, seed: int) -> Packing:
    """The same disks numbered at random.

    Without the order of a lattice, whose neighbours are known by the numbers of the disks.
    """
    order = np.random.default_rng(seed).permutation(packing.n)
    return replace(
        packing,
        position=packing.position[order],
        radius=packing.radius[order],
        row=packing.row[order],
        left=None,
    )


def displaced(packing: Packing, shift: FloatArray, *, mirror_image: bool = False) -> Packing:
    """The packing with its disks moved by ``shift`` (n, 2), or by the mirror image of it."""
    if mirror_image:
        image = network.mirror_disks(packing.position, 0.5 * packing.width)
        shift = shift[image] * np.array([-1.0, 1.0])
    return replace(packing, position=packing.position + shift)


def _random_shift(shape: tuple[int, ...], size: float, seed: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(-size, size, shape)


def _brackets_dataset(found: Sequence[BracketResult]) -> xr.Dataset:
    dataset = slab.events_dataset([result.event for result in found])
    return dataset.assign(_protocol_columns("event", found))


def _protocol_columns(dimension: str, results: Sequence[BracketResult]) -> dict[str, xr.Variable]:
    ramps = np.array([result.ramp_time for result in results])
    steps = np.array([result.time_step for result in results])
    return {
        "ramp_time": variable(dimension, ramps, "duration of the load ramp in sqrt(radius/g)"),
        "time_step": variable(dimension, steps, "time step in sqrt(radius/g)"),
    }


def _runs_dataset(found: Sequence[BracketResult]) -> xr.Dataset:
    """Every run, in the order of the protocols, their time steps and then of the forces."""
    counts = [len(result.forces) for result in found]
    starts = np.concatenate([[0], np.cumsum(counts)])
    parts = [
        (slice(int(start), int(start) + count), result.measured)
        for start, count, result in zip(starts, counts, found, strict=False)
    ]
    dataset = slab.measured_dataset(("run",), parts, (int(starts[-1]),))
    of_run = [result for result, count in zip(found, counts, strict=True) for _ in range(count)]
    forces = np.concatenate([result.forces for result in found])
    return dataset.assign(
        {**_protocol_columns("run", of_run), "force": variable("run", forces, f"applied force {FORCE}")}
    )


def _copies_dataset(tasks: Sequence[CopyTask], measured: Sequence[xr.Dataset]) -> xr.Dataset:
    """The copies, and how far each is from the first one and from its mirror image."""
    dataset = slab.measured_along("copy", measured)
    response = dataset["floor_response"].values
    largest = response[0].max()
    text = "largest difference of the floor response to {} of the first copy, per largest response"
    return dataset.assign(
        name=variable("copy", [task.name for task in tasks], "how the copy differs from the packing"),
        force=variable((), tasks[0].force, f"applied force {FORCE}"),
        difference=variable("copy", np.abs(response - response[0]).max(axis=1) / largest, text.format("that")),
        mirror_difference=variable(
            "copy", np.abs(response[:, ::-1] - response[0]).max(axis=1) / largest, text.format("the mirror image")
        ),
    )


def _held_dataset(task: HeldTask, result: HeldResult) -> xr.Dataset:
    count = len(task.forces)
    dataset = slab.measured_dataset(("force",), [(slice(0, count), result.displaced)], (count,))
    before = slab.measured_dataset(("force",), [(slice(0, count), result.branch)], (count,))
    return dataset.assign(
        branch_asymmetry=variable(
            "force", before["asymmetry"].values, "asymmetry of the floor response before the displacement"
        ),
        branch_response=variable(
            ("force", "floor_disk"), before["floor_response"].values, "floor response before the displacement"
        ),
        moved=variable("force", result.displacement, f"largest distance from the place before {LENGTH}"),
        displacement=variable((), task.displacement, f"largest random displacement {LENGTH}"),
    ).assign_coords(force=variable("force", task.forces, f"applied force {FORCE}"))
