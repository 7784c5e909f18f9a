"""Solved scenes that several validation modules look at; each is solved once in a process."""

from functools import cache

import numpy as np

from granular_response.observe.floor import floor_force
from granular_response.scene import Scene
from granular_response.solvers.solution import Solution, solve_scene

FLOOR_DISKS = np.arange(61)


@cache
def slab(
    friction: float, force: float, method: str = "auto", law: str = "linear", lattice_constant: float = 2.0
) -> Solution:
    """The paper's slab (15 rows of 61 and 60) under a force on the middle of its top row."""
    return solve_scene(
        Scene.from_dict(
            {
                "packing": {"kind": "slab", "lattice_constant": lattice_constant},
                "contact": {"friction": friction, "law": law},
                "loads": [{"disk": "top-centre", "force": [0.0, -force]}],
                "protocol": {"method": method},
            }
        )
    )


def response(solution: Solution) -> np.ndarray:
    """(61,) what the load adds to the floor forces, per unit of load."""
    change = floor_force(solution.loaded[-1], FLOOR_DISKS) - floor_force(solution.rest, FLOOR_DISKS)
    return change / solution.total_force
