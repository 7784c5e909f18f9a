"""Path and dynamics from rest to nine pairs of friction and force: processor time to an error.

`python benchmarks/nine_points.py OUTPUT.json`. The paper's slab, without the fall: a path with a tolerance and dynamics
with ramps of several lengths, from the same rest state.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from precision import REPEATS, fastest
from timing import floor, scene, write

from granular_response.solve import Problem, loaded_states, rest_state

FRICTIONS, FORCES = (0.05, 0.2, 1.0), (4.0, 15.0, 50.0)
#: Errors of the nine points, which are tolerances of the paths too, and ramp times of the dynamics.
ERRORS, RAMPS = (1e-2, 1e-3, 1e-4, 1e-5), (1.0, 5.0, 20.0, 100.0)
#: Seconds of a path after which it is not run again, and with which no finer one is tried.
LONG = 3.0


def nine_points() -> tuple[list[dict], list[dict]]:
    """Runs from rest to nine pairs of friction and force, and for each and every error the least times.

    The quasi-static limit is the path in increments of the default length.
    """
    runs: list[dict] = []
    points = []
    for friction in FRICTIONS:
        unloaded = Problem.from_scene(scene(friction))
        rest_state(unloaded)  # compiles
        start = time.process_time()
        rest = rest_state(unloaded)
        fall = time.process_time() - start
        for force in FORCES:

            def timed(rest=rest, friction=friction, force=force, **protocol: Any) -> tuple[np.ndarray, float]:
                """Normalised response and processor time from the rest state on."""
                problem = Problem.from_scene(scene(friction, force, **protocol)).with_loads(rest.position)
                seconds = np.inf
                for _ in range(REPEATS):
                    start = time.process_time()
                    loaded = loaded_states(problem, rest, [1.0])[1][0]
                    seconds = min(seconds, time.process_time() - start)
                    if seconds > LONG:
                        break
                return (floor(loaded, problem) - floor(rest, problem)) / force, seconds

            limit, seconds = timed(method="path")
            here: list[dict] = [{"method": "path", "setting": None, "seconds": seconds}]
            for tolerance in ERRORS:
                if len(here) > 1 and here[-1]["seconds"] > LONG:
                    break
                response, seconds = timed(method="path", path_tolerance=tolerance)
                error = float(np.abs(response - limit).max())
                here.append({"method": "path", "setting": tolerance, "seconds": seconds, "error": error})
            for ramp in RAMPS:
                response, seconds = timed(
                    method="dynamics", integrator="leapfrog", time_step=1.4e-3, ramp_time=ramp,
                    stop_kinetic_energy=1e-9, static_finish=True,
                )  # fmt: skip
                error = float(np.abs(response - limit).max())
                here.append({"method": "dynamics", "setting": ramp, "seconds": seconds, "error": error})
            for row in here:
                row.update(friction=friction, force=force)
                print(row, flush=True)
            runs += here
            point: dict[str, Any] = {"friction": friction, "force": force, "fall_seconds": fall}
            for error in ERRORS:
                for method in ("path", "dynamics"):
                    mine = [row for row in here if row["method"] == method]
                    point[f"{method}_{error:.0e}"] = fastest(mine, error)
            points.append(point)
    return runs, points


def main(path: str) -> None:
    runs, points = nine_points()
    write(path, {"runs": runs, "points": points})


if __name__ == "__main__":
    main(sys.argv[1])
