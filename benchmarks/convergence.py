"""Dynamics against the quasi-static path: the difference of responses falls like one over the ramp time.

`python benchmarks/convergence.py OUTPUT.json`. For each friction the load ends below and above the force near which
a simple path follower stops (29.3 for a friction of 0.2, 62.3 for 1). Dynamics starts from the rest state of the
path, ramps the load linearly, relaxes, and is finished by statics.

The packing and its path are symmetric. With a friction of 1 and large loads a slow ramp amplifies what rounding adds to
the antisymmetric part, so the part of the difference that is symmetric is given beside the whole of it.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from timing import floor, scene, write

from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.equilibrium import finish
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state

CASES = {0.2: (15.0, 40.0), 1.0: (30.0, 65.0, 70.0)}
RAMPS = (20.0, 50.0, 100.0, 200.0, 400.0)
TIME_STEP = 5e-4


def symmetric(response: np.ndarray) -> np.ndarray:
    """The part of a response that is its own mirror image."""
    return 0.5 * (response + response[::-1])


def main(path: str) -> None:
    rows = []
    for friction, forces in CASES.items():
        problem = Problem.from_scene(scene(friction, 1.0))
        rest = rest_state(problem)
        problem = problem.with_loads(rest.position)
        for force, loaded in zip(forces, follow(problem, rest, forces), strict=True):
            limit = (floor(loaded, problem) - floor(rest, problem)) / force
            for ramp in RAMPS:
                start = replace(rest, velocity=np.zeros_like(rest.velocity))
                dynamics = Dynamics(problem, start, "beeman", TIME_STEP)
                settled = finish(problem, relax(dynamics, Stop(1e-14), load=(0.0, force, ramp)))
                response = (floor(settled, problem) - floor(rest, problem)) / force
                rows.append(
                    {
                        "friction": friction,
                        "force": force,
                        "ramp_time": ramp,
                        "difference": float(np.abs(response - limit).max()),
                        "symmetric_difference": float(np.abs(symmetric(response) - symmetric(limit)).max()),
                        "asymmetry": float(np.abs(response - response[::-1]).max()),
                        "path_asymmetry": float(np.abs(limit - limit[::-1]).max()),
                    }
                )
                print(rows[-1], flush=True)
    fits = []
    for friction, forces in CASES.items():
        for force in forces:
            curve = [r for r in rows if (r["friction"], r["force"]) == (friction, force)]
            ramps = np.log([r["ramp_time"] for r in curve])
            fit = {"friction": friction, "force": force}
            for key in ("difference", "symmetric_difference"):
                fit[f"exponent_of_{key}"] = float(np.polyfit(ramps, np.log([r[key] for r in curve]), 1)[0])
            fits.append(fit | {"largest_asymmetry": max(r["asymmetry"] for r in curve)})
    write(path, {"runs": rows, "fits": fits})


if __name__ == "__main__":
    main(sys.argv[1])
