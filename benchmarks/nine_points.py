"""Path and dynamics from rest to nine pairs of friction and force: processor time to an error.

`python benchmarks/nine_points.py OUTPUT.json`. The paper's slab, without the fall: a path with a tolerance and dynamics
with ramps of several lengths, from the same rest state.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from precision import fastest
from timing import floor, scene, write

from granular_response.solve import Problem, loaded_states, rest_state
from granular_response.state import State

FRICTIONS, FORCES = (0.05, 0.2, 1.0), (4.0, 15.0, 50.0)
#: Errors of the nine points, which are tolerances of the paths too, and ramp times of the dynamics.
ERRORS, RAMPS = (1e-2, 1e-3, 1e-4, 1e-5), (1.0, 5.0, 20.0, 100.0)
#: Seconds after which a run is not repeated; no finer path is tried than one that took as long.
LONG = 3.0
#: Rounds; from the second one on all runs of a point take turns, so that they meet the same machine.
ROUNDS = 4


class Run:
    """One way to a loaded state, and the least time that it has taken."""

    def __init__(self, rest: State, friction: float, force: float, method: str, setting: float | None):
        self.about = {"method": method, "setting": setting, "friction": friction, "force": force}
        protocol: dict[str, Any] = {"method": method}
        if method == "dynamics":
            protocol |= {"integrator": "leapfrog", "time_step": 1.4e-3, "ramp_time": setting}
            protocol |= {"stop_kinetic_energy": 1e-9, "static_finish": True}
        elif setting is not None:
            protocol["path_tolerance"] = setting
        self.problem = Problem.from_scene(scene(friction, force, **protocol)).with_loads(rest.position)
        self.rest, self.force, self.seconds = rest, force, np.inf
        self.response = np.zeros(0)

    def again(self) -> None:
        """Once more, from the rest state on."""
        start = time.process_time()
        loaded = loaded_states(self.problem, self.rest, [1.0])[1][0]
        self.seconds = min(self.seconds, time.process_time() - start)
        self.response = (floor(loaded, self.problem) - floor(self.rest, self.problem)) / self.force

    def row(self, limit: np.ndarray) -> dict[str, Any]:
        """The record of the run, with its error from the quasi-static limit."""
        found = {**self.about, "seconds": self.seconds}
        if self.about["method"] == "dynamics" or self.about["setting"] is not None:
            found["error"] = float(np.abs(self.response - limit).max())
        return found


def point(rest: State, friction: float, force: float) -> list[dict[str, Any]]:
    """Records of all runs from rest to one pair; the limit is the path in increments of the default length."""
    limit = Run(rest, friction, force, "path", None)
    limit.again()
    paths: list[Run] = []
    for tolerance in ERRORS:
        if paths and paths[-1].seconds > LONG:
            break
        paths.append(Run(rest, friction, force, "path", tolerance))
        paths[-1].again()
    dynamics = [Run(rest, friction, force, "dynamics", ramp) for ramp in RAMPS]
    for run in dynamics:
        run.again()
    for _ in range(ROUNDS - 1):
        for run in (limit, *paths, *dynamics):
            if run.seconds <= LONG:
                run.again()
    return [run.row(limit.response) for run in (limit, *paths, *dynamics)]


def nine_points() -> tuple[list[dict], list[dict]]:
    """Runs from rest to nine pairs of friction and force, and for each and every error the least times."""
    runs: list[dict] = []
    points = []
    for friction in FRICTIONS:
        unloaded = Problem.from_scene(scene(friction))
        rest = rest_state(unloaded)
        for method, setting in (("path", ERRORS[0]), ("dynamics", RAMPS[0])):
            Run(rest, friction, FORCES[0], method, setting).again()  # compiles, as the first fall did
        start = time.process_time()
        rest = rest_state(unloaded)
        fall = time.process_time() - start
        for force in FORCES:
            here = point(rest, friction, force)
            print(*here, sep="\n", flush=True)
            runs += here
            least: dict[str, Any] = {"friction": friction, "force": force, "fall_seconds": fall}
            for error in ERRORS:
                for method in ("path", "dynamics"):
                    mine = [row for row in here if row["method"] == method]
                    least[f"{method}_{error:.0e}"] = fastest(mine, error)
            points.append(least)
    return runs, points


def main(path: str) -> None:
    runs, points = nine_points()
    write(path, {"runs": runs, "points": points})


if __name__ == "__main__":
    main(sys.argv[1])
