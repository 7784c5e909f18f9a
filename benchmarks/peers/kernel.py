"""Disk-steps per second on one core, ours and those of LAMMPS, in the same run.

`python -m peers.kernel OUTPUT.json` times slabs that have had time to fall into their contacts (a cold stack carries
nothing and misleads). Times are of the processor. LAMMPS is recorded as absent where `lmp` is not found.
"""

from __future__ import annotations

import sys

from peers import lammps
from timing import least, write

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
    repeats = REPEATS if problem.n < 10_000 else REPEATS // 4
    theirs = None
    if lammps.executable():
        theirs = lammps.step_time(problem.packing, friction, settle, steps, TIME_STEP)
    ours = least(lambda: dynamics.advance(steps), repeats)[1]["processor"] / steps
    return {
        "disks": problem.n,
        "friction": friction,
        "microseconds": 1e6 * ours,
        "lammps_microseconds": None if theirs is None else 1e6 * theirs,
        "disk_steps_per_second": problem.n / ours,
        "over_lammps": None if theirs is None else theirs / ours,
    }


def main(path: str) -> None:
    rows = []
    for friction in FRICTIONS:
        for slab in SLABS:
            rows.append(measure(*slab[:2], friction, *slab[2:]))
            print(rows[-1], flush=True)
    write(path, {"lammps": lammps.version(), "runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
