"""The same numbers from other processes: with compilation off, and to the last bit with it on."""

import json
from functools import cache

import pytest
from commands import python

#: Five disks: dynamics with two integrators, static finish, load path, minimisation.
SCRIPT = """
import json
import numpy as np
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem
from granular_response.solvers.equilibrium import finish
from granular_response.solvers.energy import minimise
from granular_response.solvers.solution import solve_scene

base = {"packing": {"kind": "slab", "layers": 2, "disks_per_row": 3}, "wall": {"friction": 0.3},
        "loads": [{"disk": 3, "force": [0.2, -1.0], "torque": 0.1}]}
result = []
for integrator in ("beeman", "gear"):
    problem = Problem.from_scene(Scene.from_dict(base))
    dynamics = Dynamics(problem, problem.bare_state(), integrator, 4e-4)
    dynamics.advance(STEPS)
    result += [dynamics.q, dynamics.v, dynamics.model.pairs.spring, dynamics.model.walls.spring]
frictionless = {**base, "contact": {"friction": 0.0}, "wall": {"friction": 0.0}, "loads": []}
smooth = Problem.from_scene(Scene.from_dict(frictionless))
result.append(minimise(smooth, smooth.bare_state()).position.ravel())
if FULL:
    solution = solve_scene(Scene.from_dict({**base, "packing": {**base["packing"], "disks_per_row": 12, "layers": 4}}))
    state = solution.loaded[0]
    result += [state.position.ravel(), state.angle, state.pairs.normal_force, state.pairs.spring]
print(json.dumps([float(v).hex() for v in np.concatenate(result)]))
"""


@cache
def numbers(steps: int, *, full: bool, attempt: int = 0, **environment: str) -> list[float]:
    """What the script prints in a process of its own."""
    script = SCRIPT.replace("STEPS", str(steps)).replace("FULL", str(full))
    return [float.fromhex(text) for text in json.loads(python("-c", script, **environment))]


def test_compilation_changes_nothing():
    interpreted = numbers(200, full=False, NUMBA_DISABLE_JIT="1")
    compiled = numbers(200, full=False)
    assert len(interpreted) > 60 and max(map(abs, interpreted)) > 1e-3
    assert interpreted == pytest.approx(compiled, rel=1e-11, abs=1e-14)


def test_two_processes_agree_to_the_last_bit():
    assert numbers(2000, full=True) == numbers(2000, full=True, attempt=1)
