"""Error of trajectories against the time step, for each integrator.

`python benchmarks/trajectory.py OUTPUT.json`. Two problems: a disk that swings on the floor without leaving it
(smooth, with a closed form), and a slab with friction that falls into its contacts, where every contact that opens,
closes, starts or stops to slide is a kink that no integrator knows of.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from timing import write

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem

SWING_STEPS = (8e-4, 4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
SWING_TIME, AMPLITUDE, DAMPING = 0.1, 1e-5, 0.2
FALL_STEPS = (4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
FALL_TIME, FALL_REFERENCE = 1.0, 3.125e-6


def swing(integrator: str, step: float) -> float:
    """Error in amplitudes after 1.2 swings of a disk on the floor; the start is known to every derivative."""
    packing = Packing(np.array([[500.0, 1.0 - 1.0 / 6000.0]]), np.ones(1), np.full(1, -1, np.int32), 1000.0)
    scene = Scene.from_dict({"contact": {"friction": 0.0}, "wall": {"damping_ratio": DAMPING}, "loads": []})
    problem = Problem.from_scene(scene, packing)
    frequency = np.sqrt(6000.0)
    rate = complex(-DAMPING * frequency, frequency * np.sqrt(1.0 - DAMPING**2))
    speed = AMPLITUDE * frequency

    def derivative(order: int, time: float) -> float:
        return float((speed / rate.imag * rate**order * np.exp(rate * time)).imag)

    dynamics = Dynamics(problem, replace(problem.bare_state(), velocity=np.array([[0.0, speed]])), integrator, step)
    if integrator == "gear":
        dynamics.history[1, 1], dynamics.history[2, 1] = derivative(3, 0.0), derivative(4, 0.0)
    dynamics.advance(round(SWING_TIME / step))
    return abs(float(dynamics.q[1]) - derivative(0, SWING_TIME)) / AMPLITUDE


def slab() -> Problem:
    """A small slab with friction."""
    scene = Scene.from_dict(
        {
            "packing": {"kind": "slab", "layers": 6, "disks_per_row": 15},
            "contact": {"friction": 0.2},
            "wall": {"friction": 0.2},
            "loads": [],
        }
    )
    return Problem.from_scene(scene)


def fall(integrator: str, step: float) -> np.ndarray:
    """Positions of the slab some time after gravity was switched on."""
    problem = slab()
    dynamics = Dynamics(problem, problem.bare_state(), integrator, step)
    dynamics.advance(round(FALL_TIME / step))
    return dynamics.position


def main(path: str) -> None:
    rows, orders = [], []
    reference = fall("verlet", FALL_REFERENCE)
    size = np.abs(reference - slab().packing.position).max()  # how far disks have come
    for name, integrator in INTEGRATORS.items():
        for problem, steps in (("swing", SWING_STEPS), ("fall", FALL_STEPS)):
            errors = []
            for step in steps:
                if problem == "swing":
                    error = swing(name, step)
                else:
                    error = float(np.abs(fall(name, step) - reference).max() / size)
                    error = error if np.isfinite(error) and error < 1.0 else None
                errors.append(error)
                rows.append({"problem": problem, "integrator": name, "time_step": step, "error": error})
            known = [(s, e) for s, e in zip(steps, errors, strict=True) if e is not None and e < 0.01]
            last = known[1:5] if problem == "swing" else known
            slope = np.polyfit(*np.log(np.array(last)).T, 1)[0]
            orders.append(
                {"problem": problem, "integrator": name, "measured_order": float(slope), "order": integrator.order}
            )
            print(orders[-1], flush=True)
    write(path, {"runs": rows, "orders": orders})


if __name__ == "__main__":
    main(sys.argv[1])
