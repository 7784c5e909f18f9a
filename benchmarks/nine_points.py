"""Path and dynamics from rest to nine pairs of friction and force: processor time, and error of dynamics.

`python benchmarks/nine_points.py OUTPUT.json`. The paper's slab, without the fall: the load path and dynamics with
ramps of several lengths, from the same rest state.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from precision import fastest
from timing import floor, scene, write

from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states, rest_state
from granular_response.state import State

FRICTIONS, FORCES = (0.05, 0.2, 1.0), (4.0, 15.0, 50.0)
#: Errors to which the time of dynamics is given, and its ramp times.
ERRORS, RAMPS = (1e-2, 1e-3, 1e-4, 1e-5), (1.0, 5.0, 20.0, 100.0)
#: Seconds after which a run is not repeated.
LONG = 3.0
#: Rounds; from the second one on all runs of a point take turns, so that they meet the same machine.
ROUNDS = 4


class Run:
    """One way to a loaded state, the path or dynamics with a ramp, and the least time that it has taken."""

    def __init__(self, rest: State, friction: float, force: float, ramp: float | None = None):
        protocol: dict[str, Any] = {"method": "path"}
        if ramp is not None:
            protocol = {"method": "dynamics", "integrator": "leapfrog", "time_step": 1.4e-3, "ramp_time": ramp}
            protocol |= {"stop_kinetic_energy": 1e-9, "static_finish": True}
        self.about = {"method": protocol["method"], "ramp_time": ramp, "friction": friction, "force": force}
        self.problem = Problem.from_scene(scene(friction, force, **protocol)).with_loads(rest.position)
        self.rest, self.force, self.seconds = rest, force, np.inf
        self.again()

    def again(self) -> None:
        """Once more, from the rest state on."""
        start = time.process_time()
        loaded = loaded_states(self.problem, self.rest, [1.0])[1][0]
        self.seconds = min(self.seconds, time.process_time() - start)
        self.response = (floor(loaded, self.problem) - floor(self.rest, self.problem)) / self.force


def point(rest: State, friction: float, force: float) -> list[dict[str, Any]]:
    """Records of the path and of dynamics from rest to one pair, with the errors of dynamics."""
    path, *dynamics = (Run(rest, friction, force, ramp) for ramp in (None, *RAMPS))
    for _ in range(ROUNDS - 1):
        for run in (path, *dynamics):
            if run.seconds <= LONG:
                run.again()
    errors = [float(np.abs(run.response - path.response).max()) for run in dynamics]
    rows = [{**run.about, "seconds": run.seconds, "error": e} for run, e in zip(dynamics, errors, strict=True)]
    return [{**path.about, "seconds": path.seconds}, *rows]


def nine_points() -> tuple[list[dict], list[dict]]:
    """Runs from rest to nine pairs of friction and force; of each pair the times of the path, and to each error."""
    runs: list[dict] = []
    points = []
    for friction in FRICTIONS:
        unloaded = Problem.from_scene(scene(friction))
        rest = rest_state(unloaded)
        for ramp in (None, RAMPS[0]):
            Run(rest, friction, FORCES[0], ramp)  # compiles, as the first fall did
        start = time.process_time()
        rest = rest_state(unloaded)
        fall = time.process_time() - start
        for force in FORCES:
            path, *dynamics = point(rest, friction, force)
            print(path, *dynamics, sep="\n", flush=True)
            runs += [path, *dynamics]
            points.append(
                {"friction": friction, "force": force, "fall_seconds": fall, "path": path["seconds"]}
                | {f"dynamics_{error:.0e}": fastest(dynamics, error) for error in ERRORS}
            )
    return runs, points


def main(path: str) -> None:
    runs, points = nine_points()
    write(path, {"runs": runs, "points": points})


if __name__ == "__main__":
    main(sys.argv[1])
