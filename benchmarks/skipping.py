"""What leaving out unneeded work buys: the same scene with each such part forced on, in turns in one run.

`python benchmarks/skipping.py OUTPUT.json`. Times of 908 disks, and whether forcing changed the result.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from timing import interleaved, scene, write

from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.equilibrium import certify, finish
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.state import wall_normals

TIME_STEP = 4e-4
STEPS, REPEATS = 400, 25


def settled(friction: float, steps: int = 20_000) -> tuple[Problem, Dynamics]:
    problem = Problem.from_scene(scene(friction))
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", TIME_STEP)
    dynamics.advance(steps)
    return problem, dynamics


def all_walls(dynamics: Dynamics) -> None:
    """Test every disk against all three walls at every step."""
    c, problem = dynamics.candidates, dynamics.problem
    n = problem.n
    disk, wall = np.tile(np.arange(n), 3), np.repeat(np.arange(3, dtype=np.int8), n)
    gap = problem.packing.box.wall_gap(c.reference[disk], problem.packing.radius[disk], wall)
    dynamics.candidates = replace(c, wall_disk=disk, wall=wall, wall_gap=gap)
    dynamics.wall_normal = wall_normals(wall)
    walls = dynamics.model.walls._replace(disk=disk, normal=dynamics.wall_normal, gap=gap)
    dynamics.model = dynamics.model._replace(walls=walls)


def search_often(dynamics: Dynamics, steps: int, every: int = 100) -> None:
    """Search all neighbours anew every so many steps, as a code must that knows nothing of the lattice."""
    for _ in range(steps // every):
        dynamics.problem.list_candidates(dynamics.position, search=True)
        dynamics.advance(every)


def pair(name: str, friction: float, plain: Callable, forced: Callable, same: Callable[[], bool]) -> dict:
    seconds = interleaved([plain, forced], REPEATS)
    row = {
        "part": name,
        "friction": friction,
        "without_microseconds": 1e6 * seconds[0] / STEPS,
        "with_microseconds": 1e6 * seconds[1] / STEPS,
        "cost": seconds[1] / seconds[0],
        "same_result": bool(same()),
    }
    print(row, flush=True)
    return row


def main(path: str) -> None:
    rows = []

    # rotations and tangential springs where nothing rubs: a friction too small to be felt switches them on
    _, plain = settled(0.0)
    problem = Problem.from_scene(scene(0.0))
    tiny = replace(problem, pair_law=Problem.from_scene(scene(0.2)).pair_law._replace(friction=1e-300))
    forced = Dynamics(tiny, tiny.bare_state(), "beeman", TIME_STEP)
    forced.advance(20_000)
    rows.append(
        pair(
            "rotations and tangential springs without friction", 0.0,
            lambda: plain.advance(STEPS), lambda: forced.advance(STEPS),
            lambda: np.array_equal(plain.position, forced.position),
        )
    )  # fmt: skip

    for friction in (0.0, 0.2):
        _, plain = settled(friction)
        _, searching = settled(friction)
        rows.append(
            pair(
                "neighbour search every 100 steps in a network that stays", friction,
                lambda plain=plain: plain.advance(STEPS),
                lambda searching=searching: search_often(searching, STEPS),
                lambda plain=plain, searching=searching: np.array_equal(plain.position, searching.position),
            )
        )  # fmt: skip
        _, plain = settled(friction)
        _, walls = settled(friction)
        all_walls(walls)
        rows.append(
            pair(
                "wall tests for every disk", friction,
                lambda plain=plain: plain.advance(STEPS), lambda walls=walls: walls.advance(STEPS),
                lambda plain=plain, walls=walls: np.array_equal(plain.position, walls.position),
            )
        )  # fmt: skip

    # relaxing a state once more that is known to be at rest
    problem = Problem.from_scene(scene(0.2))
    rest = rest_state(problem)

    def again() -> None:
        dynamics = Dynamics(problem, rest, "beeman", TIME_STEP)
        relax(dynamics, Stop(1e-13), load=(0.0, 0.0, problem.scene.protocol.ramp_time))
        finish(problem, dynamics.state())

    seconds = interleaved([lambda: certify(problem, rest), again], 3)
    whole = interleaved([lambda: rest_state(problem)], 2)[0]
    second = {
        "friction": 0.2,
        "certificate_seconds": seconds[0],
        "relaxed_again_seconds": seconds[1],
        "rest_state_seconds": whole,
        "cost": (whole + seconds[1]) / (whole + seconds[0]),
    }
    print(second)
    write(path, {"runs": rows, "second_relaxation": [second]})


if __name__ == "__main__":
    main(sys.argv[1])
