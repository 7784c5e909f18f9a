"""How long a newcomer waits: all kernels compiled from nothing, and a run of the default scene as a whole process.

`python benchmarks/startup.py OUTPUT.json`. Compiled kernels go to a cache of their own that starts empty.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from timing import write

#: Every kernel in every form that the package asks for.
ALL_KERNELS = """
import numpy as np
from granular_response.core.integrators import INTEGRATORS
from granular_response.scene import Scene
from granular_response.solve import Dynamics, Problem, Relaxation, Stop, relax_many, solve_scene

small = {"kind": "slab", "layers": 4, "disks_per_row": 26}
load = [{"disk": "top-centre", "force": [0.0, -2.0]}]
for friction, wall in ((0.0, 0.0), (0.2, 0.0), (0.2, 0.3), (0.0, 0.3)):
    for law in ("cut", "literal"):
        changes = {"contact": {"friction": friction}, "wall": {"friction": wall}, "protocol": {"friction_law": law}}
        problem = Problem.from_scene(Scene.from_dict({"packing": small, "loads": load, **changes}))
        for name in INTEGRATORS:
            Dynamics(problem, problem.bare_state(), name, 2e-4).advance(1)
    many = [Dynamics(problem, problem.bare_state(), time_step=2e-4) for _ in range(8)]
    relax_many(Relaxation(dynamics, Stop(maximum_steps=100)) for dynamics in many)
rough = {**small, "polydispersity": 0.2}
for changes in ({"contact": {"friction": 0.0}}, {"contact": {"friction": 0.2}}, {"packing": rough}):
    solve_scene(Scene.from_dict({"packing": small, "loads": load, **changes}))
"""

SCENES = {
    "default (friction 0.2, force 15)": "loads: [{disk: top-centre, force: [0.0, -15.0]}]\ncontact: {friction: 0.2}\n",
    "frictionless, force 4": "loads: [{disk: top-centre, force: [0.0, -4.0]}]\ncontact: {friction: 0.0}\n",
}
REPEATS = 5


def run(command: list[str], repeats: int = 1, **environment: str) -> dict[str, float]:
    """Least wall-clock and processor seconds of a process."""
    found = []
    for _ in range(repeats):
        start, before = time.perf_counter(), os.times()
        subprocess.run(command, check=True, env={**os.environ, **environment}, stdout=subprocess.DEVNULL)
        after = os.times()
        used = after.children_user + after.children_system - before.children_user - before.children_system
        found.append((time.perf_counter() - start, used))
    wall, processor = zip(*found, strict=True)
    return {"seconds": min(wall), "processor_seconds": min(processor)}


def main(path: str) -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        cache = str(Path(folder) / "kernels")
        command = [sys.executable, "-c", ALL_KERNELS]
        rows.append({"what": "all kernels, compiled", **run(command, NUMBA_CACHE_DIR=cache)})
        rows.append({"what": "the same, from the cache", **run(command, 2, NUMBA_CACHE_DIR=cache)})
        for name, text in SCENES.items():
            scene, result = Path(folder) / "scene.yaml", Path(folder) / "result.nc"
            scene.write_text(text)
            command = [sys.executable, "-m", "granular_response", "run", str(scene), "-o", str(result)]
            run(command)  # compiles
            rows.append({"what": f"granular-response run, {name}", **run(command, REPEATS)})
        command = [sys.executable, "-m", "granular_response", "--version"]
        rows.append({"what": "granular-response --version", **run(command, REPEATS)})
    for row in rows:
        print(row)
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
