"""Where the time of a solution goes, by a profile: shares of parts of the code.

`python benchmarks/shares.py OUTPUT.json`. Of a path its rest state is no part. One thread; a profiler slows what calls
much a little, kernels and LAPACK not at all.
"""

from __future__ import annotations

import cProfile
import pstats
import sys
from collections.abc import Callable
from functools import partial

import scale
from timing import scene, write

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states, rest_state

#: What a function's file has in its name, by part of the code, the first that fits; kernels count as those files.
PARTS = (
    ("factorisations", ("linalg/", "scipy/linalg")),
    ("forces and tangents", ("kernels/statics", "kernels/events", "solvers/rates")),
    ("dynamics", ("kernels/", "solvers/dynamics")),
    ("matrices and arrays", ("scipy/sparse", "numpy", "~", "solvers/system")),
)
REST = "the rest"


def loaded(described: Scene) -> Callable[[], object]:
    """The states under a scene's loads, from its rest state, which is found here."""
    problem = Problem.from_scene(described)
    rest = rest_state(problem)
    return partial(loaded_states, problem.with_loads(rest.position), rest, [1.0])


def settled(described: Scene) -> Callable[[], object]:
    """The rest state of a scene."""
    return partial(rest_state, Problem.from_scene(described))


#: Cases by what they are, each a function that prepares what is profiled.
CASES: dict[str, Callable[[], Callable[[], object]]] = {
    "path to 15 mg, friction 0.2": lambda: loaded(scene(0.2, 15.0, method="path")),
    "path to 15 mg, friction 0.05": lambda: loaded(scene(0.05, 15.0, method="path")),
    "path to 50 mg, friction 0.2": lambda: loaded(scene(0.2, 50.0, method="path")),
    "fall of the default slab": lambda: settled(scene(0.2)),
    "57,660 disks at rest without friction": lambda: settled(scale.scene(120, 481, "minimise", 0.0, 5.0)),
    "path of 57,660 disks to 15 mg": lambda: loaded(scale.scene(120, 481, "path", 0.2, 15.0)),
}


def part_of(file: str) -> str:
    """The part of the code that a file belongs to."""
    return next((part for part, names in PARTS if any(name in file for name in names)), REST)


def measure(what: str, prepare: Callable[[], Callable[[], object]]) -> dict:
    """Seconds of one case, and the shares of its parts."""
    solve = prepare()
    solve()  # compiles
    profile = cProfile.Profile()
    profile.runcall(solve)
    found = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    seconds = dict.fromkeys([*(part for part, _ in PARTS), REST], 0.0)
    for (file, _, _), (_, _, own, _, _) in found.items():
        seconds[part_of(file)] += own
    whole = sum(seconds.values())
    return {"what": what, "seconds": whole, **{part: own / whole for part, own in seconds.items()}}


def main(path: str) -> None:
    rows = []
    for what, prepare in CASES.items():
        rows.append(measure(what, prepare))
        print(rows[-1], flush=True)
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
