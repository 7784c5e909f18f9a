"""Many scenes relaxed in lock-step.

Scenes on one network of candidate contacts (the same packing with other frictions, stiffnesses, loads, or radii)
share their sweeps over the disks: ``core.lockstep`` advances ``WIDTH`` of them at once in vector registers. A scene
that has come to rest leaves its lane to the next one that waits. Every scene goes through the steps that it would
go through alone, so the results are those of :func:`solve.dynamics.relax`, to the last bit, however scenes are
grouped. A scene whose disks move so far that its candidates must be listed again goes on alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..core import lockstep as kernel
from ..core.integrators.record import LOOK_EVERY
from ..core.lanes import WIDTH, aligned_zeros
from .dynamics import CHECK_EVERY, Dynamics, Relaxation
from .problem import wall_normals
from .state import FloatArray, State

#: Fewer scenes than this are faster alone than in lanes of which the others idle.
WORTHWHILE = WIDTH - 1
#: More disks than this are faster alone, where a scene fills vectors by itself with the pairs of its runs.
MOST_IN_RUNS = 500
#: And more than this in any case: their lanes no longer fit into the cache of a core.
MOST_DISKS = 5000


class Network:
    """What scenes in lock-step share: the number of disks, the candidate contacts, and which physics there is."""

    def __init__(self, dynamics: Dynamics):
        problem, c = dynamics.problem, dynamics.candidates
        n = problem.n
        self.n, self.freedoms = n, problem.freedoms
        self.kind = kernel.KINDS[dynamics.integrator.name]
        self.physics = (problem.rule, problem.pair_friction, problem.wall_friction)
        self.rotations = True if problem.rotations else None
        by = np.argsort(c.first.astype(np.int64) * n + c.second)  # pairs in the order of their first disks
        self.slot = c.slot[by]
        self.pair_start = _starts(c.first, n)
        self.pair_first, self.pair_second = c.first[by].astype(np.int64), c.second[by].astype(np.int64)
        self.term_start, self.term = _terms(c.runs, self.slot, c.first[by], self.pair_second, n)
        self.wall_order = np.argsort(c.wall_disk, kind="stable")
        self.wall_start = _starts(c.wall_disk, n)
        self.wall_normal = wall_normals(c.wall[self.wall_order])
        self._runs, self._walls = c.runs, (c.wall_disk, c.wall)

    @property
    def pays(self) -> bool:
        """Whether scenes on it are faster together: small ones, and those whose candidates fit few runs."""
        alone = np.count_nonzero(self._runs[:, 2] == 1)
        return self.n <= (MOST_DISKS if 2 * alone > len(self.slot) else MOST_IN_RUNS)

    def fits(self, dynamics: Dynamics) -> bool:
        """Whether a scene can share sweeps with those that this network was made of."""
        problem, c = dynamics.problem, dynamics.candidates
        return (
            self.n == problem.n
            and self.kind == kernel.KINDS[dynamics.integrator.name]
            and self.physics == (problem.rule, problem.pair_friction, problem.wall_friction)
            and np.array_equal(self._runs, c.runs)
            and np.array_equal(np.sort(self.slot), np.sort(c.slot))
            and np.array_equal(self._walls[0], c.wall_disk)
            and np.array_equal(self._walls[1], c.wall)
        )


def _starts(disk, n: int) -> NDArray[np.int64]:
    """(n + 1,) where the entries of each disk begin in a list sorted by disk."""
    return np.concatenate([[0], np.cumsum(np.bincount(disk, minlength=n))]).astype(np.int64)


def _terms(runs, slot, first, second, n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of each disk in the order in which ``core.forces`` adds their forces: ``k`` as first, ``~k`` as second."""
    m = len(slot)
    run = np.searchsorted(runs[:, 3], slot, side="right") - 1
    disk = np.concatenate([first, second]).astype(np.int64)
    side = np.repeat([0, 1], m)
    by = np.lexsort((np.concatenate([slot, slot]), side, np.concatenate([run, run]), disk))
    pair = np.concatenate([np.arange(m), ~np.arange(m)])
    return _starts(disk, n), pair[by]


class Lanes:
    """``WIDTH`` scenes in motion on one network, each in a lane of its own."""

    def __init__(self, network: Network):
        self.network = network
        n, m, w = network.n, len(network.slot), len(network.wall_order)
        self.motion = aligned_zeros(n, kernel.FIELDS * network.freedoms, WIDTH)
        self.disk = aligned_zeros(n, 4, WIDTH)
        self.contact = aligned_zeros(m, 4, WIDTH)
        self.force = aligned_zeros(m, 3, WIDTH)
        self.wall = aligned_zeros(w, 2, WIDTH)
        self.laws = aligned_zeros(2, 6, WIDTH)
        self.clock = aligned_zeros(1, 8, WIDTH)
        self.load: list[tuple[NDArray[np.int64], FloatArray]] = [(np.zeros(0, np.int64), np.zeros((0, 3)))] * WIDTH
        self._gather_loads()

    def put(self, lane: int, dynamics: Dynamics) -> None:
        """Take over a scene and its motion."""
        net, problem, c = self.network, dynamics.problem, dynamics.candidates
        f = net.freedoms
        self.disk[:, 0, lane] = problem.weight
        self.disk[:, 1, lane] = problem.packing.radius
        inverse_mass = problem.inverse_mass.reshape(f, -1)
        self.disk[:, 2, lane] = inverse_mass[0]
        if f == 3:
            self.disk[:, 3, lane] = inverse_mass[2]
        self.contact[:, :2, lane] = c.separation[:, net.slot].T
        self.contact[:, 2, lane] = c.reach[net.slot]
        self.wall[:, 0, lane] = c.wall_gap[net.wall_order]
        self.laws[:, :, lane] = problem.pair_law, problem.wall_law
        self.load[lane] = problem.load_disk, problem.load
        self._gather_loads()
        self.motion[:, :f, lane] = dynamics.q.reshape(f, -1).T
        self.motion[:, 2 * f : 3 * f, lane] = dynamics.v.reshape(f, -1).T
        memory = dynamics.memory.reshape(-1, net.n)
        self.motion[:, 3 * f : 3 * f + len(memory), lane] = memory.T
        if dynamics.spring is not None:
            self.contact[:, 3, lane] = dynamics.spring[net.slot]
        if dynamics.wall_spring is not None:
            self.wall[:, 1, lane] = dynamics.wall_spring[net.wall_order]
        self.clock[0, :, lane] = dynamics.time, dynamics.time_step, *dynamics.gravity, *dynamics.load

    def report(self, lane: int, dynamics: Dynamics, steps: int) -> None:
        """Tell a lane's scene its positions and velocities after ``steps`` more steps."""
        f = self.network.freedoms
        dynamics.q[:] = self.motion[:, :f, lane].T.ravel()
        dynamics.v[:] = self.motion[:, 2 * f : 3 * f, lane].T.ravel()
        dynamics.steps += steps
        dynamics.time += steps * dynamics.time_step
        self.clock[0, 0, lane] = dynamics.time

    def give_back(self, lane: int, dynamics: Dynamics) -> None:
        """After :meth:`report`, the rest of a scene's motion: springs, and the history of its integrator."""
        net, f = self.network, self.network.freedoms
        memory = dynamics.memory
        rows = memory.size // net.n
        memory[:] = self.motion[:, 3 * f : 3 * f + rows, lane].T.reshape(memory.shape)
        if dynamics.spring is not None:
            dynamics.spring[net.slot] = self.contact[:, 3, lane]
        if dynamics.wall_spring is not None:
            dynamics.wall_spring[net.wall_order] = self.wall[:, 1, lane]

    def copy(self, lane: int, source: int) -> None:
        """Have an idle lane do what another one does."""
        for array in (self.motion, self.disk, self.contact, self.wall, self.laws, self.clock):
            array[..., lane] = array[..., source]
        self.load[lane] = self.load[source]
        self._gather_loads()

    def _gather_loads(self) -> None:
        """Loads of all lanes on the disks that are loaded in any."""
        disks = np.unique(np.concatenate([disk for disk, _ in self.load]))
        self.loads = aligned_zeros(len(disks), 3, WIDTH)
        for lane, (disk, load) in enumerate(self.load):
            np.add.at(self.loads[:, :, lane], np.searchsorted(disks, disk), load)
        self.load_start = _starts(disks, self.network.n)

    def may_leave_lists(self, limit: FloatArray) -> NDArray[np.bool_]:
        """(lanes,) whether a disk may be beyond ``limit`` (lanes,), its list's reach, at the next look."""
        found = np.zeros(WIDTH, bool)
        horizon = self.clock[0, 1] * LOOK_EVERY
        kernel.moved_beyond(self.motion.reshape(-1, WIDTH), self.network.freedoms, limit, horizon, found)
        return found

    def advance(self, steps: int, done: int = 0) -> None:
        """Advance every lane by ``steps`` time steps, ``done`` steps after the last report."""
        net = self.network
        flat = (
            array.reshape(-1, WIDTH)
            for array in (self.motion, self.disk, self.contact, self.force, self.wall, self.loads, self.laws)
        )
        kernel.advance(
            steps, done, net.kind, *net.physics, net.rotations, self.clock.reshape(-1, WIDTH), *flat,
            net.pair_start, net.pair_first, net.pair_second, net.term_start, net.term, net.wall_start, net.wall_normal,
            self.load_start,
        )  # fmt: skip


def relax_many(relaxations: Iterable[Relaxation]) -> list[State]:
    """Run relaxations to their ends, together where they share a network and that pays.

    Returns
    -------
    list of State : in the order given, the same as from ``Relaxation.run()`` of each.

    Raises
    ------
    DynamicsError
        When a motion blows up.
    """
    relaxations = list(relaxations)
    groups: list[tuple[Network, list[Relaxation]]] = []
    for relaxation in relaxations:
        for network, members in groups:
            if network.fits(relaxation.dynamics):
                members.append(relaxation)
                break
        else:
            groups.append((Network(relaxation.dynamics), [relaxation]))
    for network, members in groups:
        if network.pays:
            _run_together(network, members)
    return [relaxation.run() for relaxation in relaxations]  # alone, what is left


def _run_together(network: Network, relaxations: Sequence[Relaxation]) -> None:
    """Run relaxations until all have ended but those that need a list of their own, or too few to fill the lanes."""
    waiting = [relaxation for relaxation in reversed(relaxations) if not relaxation.ended]
    lanes: Lanes | None = None
    running: dict[int, Relaxation] = {}
    while len(waiting) + len(running) >= WORTHWHILE:
        lanes = Lanes(network) if lanes is None else lanes
        for lane in set(range(WIDTH)) - set(running):
            if waiting:
                running[lane] = waiting.pop()
                lanes.put(lane, running[lane].dynamics)
        idle = set(range(WIDTH)) - set(running)
        for lane in idle:
            lanes.copy(lane, min(running))
        limit = np.full(WIDTH, np.inf)
        for lane, relaxation in running.items():
            limit[lane] = relaxation.dynamics.candidates.limit
        stride = LOOK_EVERY if (limit < np.inf).any() else CHECK_EVERY
        for done in range(0, CHECK_EVERY, stride):
            if stride < CHECK_EVERY:  # the looks of a scene alone, at the same steps
                for lane in np.flatnonzero(lanes.may_leave_lists(limit)).tolist():
                    relaxation = running.pop(lane)
                    limit[lane] = np.inf
                    lanes.report(lane, relaxation.dynamics, done)
                    lanes.give_back(lane, relaxation.dynamics)
                    relaxation.dynamics.advance(CHECK_EVERY - done)
                    relaxation.look()
            lanes.advance(min(stride, CHECK_EVERY - done), done)
        for lane, relaxation in list(running.items()):
            lanes.report(lane, relaxation.dynamics, CHECK_EVERY)
            relaxation.look()
            if relaxation.ended:
                lanes.give_back(lane, running.pop(lane).dynamics)
    for lane, relaxation in running.items():
        assert lanes is not None
        lanes.give_back(lane, relaxation.dynamics)
