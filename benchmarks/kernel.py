"""Disk-steps per second on one core, ours and those of LAMMPS, in the same run.

`python benchmarks/kernel.py OUTPUT.json` times slabs that have had time to fall into their contacts (a cold stack
carries nothing and misleads), and says where the time of a step goes. Times are of the processor. LAMMPS is recorded as
absent where `lmp` is not found.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numba as nb
from peers import lammps
from timing import interleaved, write

from granular_response.kernels import forces
from granular_response.kernels.integrators import stepping
from granular_response.kernels.integrators.stepping import LOOK_EVERY, moved_beyond
from granular_response.machine.lanes import aligned, aligned_zeros
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem

#: layers, disks per row, settling steps, timed steps
SLABS = [(8, 31, 20_000, 2000), (15, 61, 20_000, 800), (30, 121, 5_000, 200), (60, 242, 1500, 50), (100, 1000, 400, 8)]
FRICTIONS = (0.0, 0.2)
REPEATS = 25
TIME_STEP = 4e-4


def slab(layers: int, per_row: int, friction: float) -> Problem:
    """A slab on its own weight."""
    packing = {"kind": "slab", "layers": layers, "disks_per_row": per_row}
    return Problem.from_scene(Scene.from_dict({"packing": packing, "contact": {"friction": friction}, "loads": []}))


def measure(layers: int, per_row: int, friction: float, settle: int, steps: int) -> dict:
    """Microseconds per step, ours and those of LAMMPS."""
    problem = slab(layers, per_row, friction)
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP)
    dynamics.advance(settle)
    repeats = max(5, REPEATS if problem.n < 10_000 else REPEATS // 4)
    theirs = None
    if lammps.executable():
        theirs = lammps.step_time(problem.packing, friction, settle, steps, TIME_STEP)
    (ours,) = interleaved([lambda: dynamics.advance(steps)], repeats, time.process_time)
    ours /= steps
    return {
        "disks": problem.n,
        "friction": friction,
        "microseconds": 1e6 * ours,
        "lammps_microseconds": None if theirs is None else 1e6 * theirs,
        "disk_steps_per_second": problem.n / ours,
        "over_lammps": None if theirs is None else theirs / ours,
    }


@nb.njit(error_model="numpy", _nrt=False)
def _repeat_pairs(times, q, v, rim, f, n, spring, shape, pairs, rule):
    for _ in range(times):
        forces.add_pair_forces(q, v, rim, f, n, spring, shape, pairs, None, rule, 0.0)


@nb.njit(error_model="numpy", _nrt=False)
def _repeat_walls(times, q, v, rim, f, n, spring, shape, walls, rule):
    for _ in range(times):
        forces.add_wall_forces(q, v, rim, f, n, spring, shape, walls, rule, 0.0)


@nb.njit(error_model="numpy", _nrt=False)
def _repeat_integration(times, scheme, q, v, memory, inverse_mass):
    a, b, c, force, seen = memory
    for _ in range(times):
        stepping.end_and_begin(scheme, q, v, a, b, c, force, inverse_mass, seen, 0.0)


@nb.njit(error_model="numpy")
def _repeat_look(times, q, v, n, limit):
    found = 0
    for _ in range(times):
        found += moved_beyond(q, v, n, limit, 1e-3)
    return found


def parts(
    layers: int, per_row: int, friction: float, settle: int, times: int
) -> tuple[dict[str, Callable[[], object]], Dynamics]:
    """The parts of a step of a settled slab, each some times by itself."""
    problem = slab(layers, per_row, friction)
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP)
    dynamics.advance(settle)
    # as in kernels.forces; the weights, radii and loads are not timed by themselves
    model = dynamics.model
    n, rule, rim, walls = model.n, model.rule, model.rim, model.walls
    spring = None if model.pairs.spring is None else aligned(model.pairs.spring)
    pairs = model.pairs._replace(spring=spring)
    q, v, f = aligned(dynamics.q), aligned(dynamics.v), aligned_zeros(dynamics.q.size)
    memory = stepping.Memory(*(row if row is None else aligned(row) for row in dynamics.rows))
    found = {
        "pair forces": lambda: _repeat_pairs(times, q, v, rim, f, n, spring, pairs.shape, pairs, rule),
        "wall forces": lambda: _repeat_walls(times, q, v, rim, f, n, walls.spring, walls.shape, walls, rule),
        "integration": lambda: _repeat_integration(times, dynamics.integrator.scheme, q, v, memory, model.inverse_mass),
        "watching displacements": lambda: _repeat_look(times, q, v, n, 0.5),
    }
    return found, dynamics


def profile(layers: int, per_row: int, friction: float, settle: int) -> list[dict]:
    """Where a step goes: each part timed by itself on the settled slab."""
    times = 200
    found, dynamics = parts(layers, per_row, friction, settle, times)
    for part in found.values():
        part()
    seconds = interleaved([*found.values(), lambda: dynamics.advance(times)], REPEATS, time.process_time)
    micro = [1e6 * s / times for s in seconds]
    micro[3] /= LOOK_EVERY
    whole = micro.pop()
    rows = [{"part": name, "microseconds": m, "share": m / whole} for name, m in zip(found, micro, strict=True)]
    left = max(whole - sum(micro), 0.0)
    rows.append({"part": "weights, rim speeds", "microseconds": left, "share": left / whole})
    rows.append({"part": "whole step", "microseconds": whole, "share": 1.0})
    rows.append({"part": "listing neighbours anew (times made)", "microseconds": None, "share": dynamics.rebuilds})
    return [{"friction": friction, **row} for row in rows]


def main(path: str) -> None:
    rows = []
    for friction in FRICTIONS:
        for slab in SLABS:
            rows.append(measure(*slab[:2], friction, *slab[2:]))
            print(rows[-1], flush=True)
    profiles = [row for friction in reversed(FRICTIONS) for row in profile(15, 61, friction, 20_000)]
    write(path, {"lammps": lammps.version(), "runs": rows, "profile": profiles})


if __name__ == "__main__":
    main(sys.argv[1])
