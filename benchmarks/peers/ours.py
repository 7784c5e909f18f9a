"""Our own steps as a process of their own, so that its time and memory are those that other codes are asked for.

`python -m peers.ours START.npy LAYERS PER_ROW FRICTION STEPS REPEATS TIME_STEP` prints them as JSON. Kernels come
from the cache where they have been compiled before.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # it runs in a folder of its own

import numpy as np
from peers import kernel, processes

from granular_response.scene import Packing
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem


def settled(layers: int, per_row: int, friction: float, steps: int, time_step: float) -> Packing:
    """The slab where it is after some steps under gravity: the start that all codes are given, without motion."""
    problem = kernel.slab(layers, per_row, friction)
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", time_step)
    dynamics.advance(steps)
    return replace(problem.packing, position=dynamics.position)


def measure(problem: Problem, steps: int, repeats: int, time_step: float) -> processes.Used:
    """What steps take; the first stage is not for timing."""
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", time_step)
    stages = []
    for _ in range(1 + repeats):
        wall_clock, processor = time.perf_counter(), time.process_time()
        dynamics.advance(steps)
        stages.append(processes.Stage(steps, time.perf_counter() - wall_clock, time.process_time() - processor))
    return processes.Used(stages, processes.own_peak())


def steps_used(start: Path, *numbers: float) -> processes.Used:
    """The same in a new process, from positions in a file."""
    command = [sys.executable, str(Path(__file__).resolve()), str(start), *map(str, numbers)]
    done = processes.launch(command, start.parent)
    if done.returncode:
        raise RuntimeError(f"our own steps failed: {done.stderr[-500:]}")
    found = json.loads(done.stdout)
    return processes.Used([processes.Stage(**stage) for stage in found["stages"]], found["peak_mebibytes"])


def main(start: str, layers: str, per_row: str, friction: str, steps: str, repeats: str, time_step: str) -> None:
    problem = kernel.slab(int(layers), int(per_row), float(friction))
    problem = Problem.from_scene(problem.scene, replace(problem.packing, position=np.load(start)))
    print(json.dumps(asdict(measure(problem, int(steps), int(repeats), float(time_step)))))


if __name__ == "__main__":
    main(*sys.argv[1:])
