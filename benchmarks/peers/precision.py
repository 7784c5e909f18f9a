"""Run time against error of the floor response: statics and LAMMPS.

`python -m peers.precision OUTPUT.json`. Two scenes of the paper's slab: friction 0.2 with a load of 15 disk
weights, and no friction with 4. The error is the largest difference of the normalised response from the quasi-static
limit: with friction the load path, without it the minimum of the energy. `reference_change` is what another way to the
limit differs by. Every time includes the fall under gravity, since a response needs it; compilation is not included.

With friction the rest state depends on the fall, and so on rounding and time step a little: LAMMPS falls into another
one, and keeps a difference however slowly it is loaded. So its error is given from its own limit too, extrapolated
linearly in the inverse ramp time from its two slowest runs.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from peers import lammps
from timing import floor, least, scene, write

from granular_response.scene import Scene
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states, rest_state

SCENES = {"friction": (0.2, 15.0), "frictionless": (0.0, 4.0)}
#: Increments of the other way with friction, in disk weights, each by the return map.
INCREMENT = 0.002
#: Kinetic energies per disk at which the fall under gravity ends.
ENERGIES = (1e-7, 1e-9, 1e-11)
#: Runs of every method, of which the least time counts.
REPEATS = 2


def solve(name: str, together: float | None = None, **protocol: Any) -> np.ndarray:
    """Normalised response of the whole solution. ``together`` asks for a path in such increments of the load."""
    friction, force = SCENES[name]
    problem = Problem.from_scene(scene(friction, force, **protocol))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    if together is None:
        loaded = loaded_states(problem, rest, [1.0])[1][0]
    else:
        loaded = follow(problem, rest, [1.0], together=together)[0]
    return (floor(loaded, problem) - floor(rest, problem)) / force


def quasi_static(name: str) -> tuple[np.ndarray, float]:
    """The quasi-static limit, and how much another way to it differs: small increments, or a path to the minimum."""
    reference = solve(name, method="auto")
    other = solve(name, INCREMENT if SCENES[name][0] else None, method="path")
    return reference, float(np.abs(reference - other).max())


def measure(name: str) -> tuple[list[dict], dict]:
    """All runs of one scene, and what its reference is worth."""
    friction, force = SCENES[name]
    reference, worth = quasi_static(name)
    rows: list[dict] = []

    def add(method: str, response: np.ndarray, seconds: float, **settings) -> None:
        error = float(np.abs(response - reference).max())
        rows.append({"scene": name, "method": method, **settings, "seconds": seconds, "error": error})
        print(rows[-1], flush=True)

    for rest in ({}, *({"stop_kinetic_energy": energy} for energy in ENERGIES if friction)):
        response, used = least(lambda: solve(name, method="auto", **rest), REPEATS)  # noqa: B023 called at once
        add("path" if friction else "minimise", response, used["seconds"], **rest)
    if lammps.executable():
        packing = Scene().packing.build()
        disk = int(np.flatnonzero(packing.row == 14)[30])
        if friction:  # steps to 1e-13 at rest; ramp, and as many steps again to settle
            plans = [(20.0, 50_400, 60_000), (100.0, 117_600, 260_000), (200.0, 117_600, 460_000)]
        else:
            plans = [(20.0, 50_000, 60_000), (20.0, 150_000, 150_000), (20.0, 400_000, 400_000)]
        own = []
        for ramp, rest_steps, steps in plans:
            runs = [lammps.response(packing, friction, disk, force, ramp, rest_steps, steps) for _ in range(REPEATS)]
            run = min(runs, key=lambda run: run.seconds)
            own.append((run.floor - run.floor_rest) / force)
            add("lammps", own[-1], run.seconds, time_step=5e-4, ramp_time=ramp, steps=rest_steps + steps)
        if friction:
            (_, _, _), (t1, _, _), (t2, _, _) = plans
            limit = own[2] + (own[2] - own[1]) * t1 / (t2 - t1)
            for row, response in zip(rows[-3:], own, strict=True):
                row["error_from_own_limit"] = float(np.abs(response - limit).max())
    return rows, {"scene": name, "friction": friction, "force": force, "reference_change": worth}


#: Errors at which times are compared, and by which errors LAMMPS is judged.
TARGETS = {"friction": 1e-5, "frictionless": 1e-6}


def fastest(rows: list[dict], target: float, key: str = "error") -> float | None:
    """Least time of the runs whose error is at most ``target``."""
    return min((row["seconds"] for row in rows if row.get(key, np.inf) <= target), default=None)


def compare(rows: list[dict], name: str) -> dict:
    """Least times to the target error: statics, LAMMPS (along its own line of time against error)."""
    target = TARGETS[name]
    mine = [row for row in rows if row["scene"] == name]
    key = "error_from_own_limit" if name == "friction" else "error"
    found = {
        "scene": name,
        "target_error": target,
        "statics_seconds": fastest([row for row in mine if row["method"] != "lammps"], target),
        "lammps_seconds": fastest([row for row in mine if row["method"] == "lammps"], target, key),
        "lammps_error_by": key,
    }
    both = found["statics_seconds"] and found["lammps_seconds"]
    found["times_faster_than_lammps"] = found["lammps_seconds"] / found["statics_seconds"] if both else None
    return found


def main(path: str) -> None:
    for name in SCENES:
        solve(name, method="auto")  # compiles
    rows, references = [], []
    for name in SCENES:
        found, reference = measure(name)
        rows += found
        references.append(reference)
    write(
        path,
        {
            "lammps": lammps.version(),
            "references": references,
            "runs": rows,
            "comparison": [compare(rows, name) for name in SCENES],
        },
    )


if __name__ == "__main__":
    main(sys.argv[1])
