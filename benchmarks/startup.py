"""How long a newcomer waits: all kernels compiled from nothing, and a run of the default scene as a whole process.

`python benchmarks/startup.py OUTPUT.json`. Compiled kernels go to a cache of their own that starts empty. Beside that
what it buys that Numba looks at the types of arguments once, not at every call (`machine_code.typed`).
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from timing import least, process, write

from granular_response.scene import Scene
from granular_response.solvers import dynamics, equations
from granular_response.solvers.solution import solve_scene

#: Asks for every kernel in every form.
ALL_KERNELS = Path(__file__).with_name("all_kernels.py")

SCENE = "loads: [{disk: top-centre, force: [0.0, -15.0]}]\ncontact: {friction: 0.2}\n"
REPEATS = 5
#: A slab of 164 disks whose kernels work for little longer than their calls take.
SMALL = {"packing": {"kind": "slab", "layers": 8, "disks_per_row": 21}, "contact": {"friction": 0.3}}
#: Runs of which the least time counts, in turns with and without.
TURNS = 40


def run(command: list[str], repeats: int = 1, **environment: str) -> dict[str, float]:
    """Least wall-clock and processor seconds of a process."""
    found = [process(command, **environment) for _ in range(repeats)]
    wall, processor = (min(one[key] for one in found) for key in ("seconds", "cpu_seconds"))
    return {"seconds": wall, "processor_seconds": processor}


def looked_at() -> list[dict[str, float | str]]:
    """Least times of one solution, with types looked at once and at every call."""
    scene = Scene.from_dict({**SMALL, "loads": [{"disk": "top-centre", "force": [0.0, -15.0]}]})
    ways = {"once": equations.typed, "at every call": lambda compiled, of: compiled}
    times: dict[str, list[dict[str, float]]] = {way: [] for way in ways}
    for _ in range(TURNS):
        for way, typed in ways.items():
            dynamics.typed = equations.typed = typed
            times[way].append(least(lambda: solve_scene(scene))[1])
    found = []
    for way, runs in times.items():
        seconds, processor = (min(run[key] for run in runs) for key in ("seconds", "processor"))
        what = f"solution of {scene.packing.disk_count} disks, types looked at {way}"
        found.append({"what": what, "seconds": seconds, "processor_seconds": processor})
    return found


def main(path: str) -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        cache = str(Path(folder) / "kernels")
        command = [sys.executable, str(ALL_KERNELS)]
        rows.append({"what": "all kernels, compiled", **run(command, NUMBA_CACHE_DIR=cache)})
        rows.append({"what": "the same, from the cache", **run(command, 2, NUMBA_CACHE_DIR=cache)})
        scene, result = Path(folder) / "scene.yaml", Path(folder) / "result.nc"
        scene.write_text(SCENE)
        command = [sys.executable, "-m", "granular_response", "run", str(scene), "-o", str(result)]
        run(command)  # compiles
        rows.append({"what": "granular-response run, default (friction 0.2, force 15)", **run(command, REPEATS)})
        command = [sys.executable, "-m", "granular_response", "--version"]
        rows.append({"what": "granular-response --version", **run(command, REPEATS)})
    rows += looked_at()
    for row in rows:
        print(row)
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
