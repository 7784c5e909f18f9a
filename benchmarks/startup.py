"""How long a newcomer waits: all kernels compiled from nothing, and a run of the default scene as a whole process.

`python benchmarks/startup.py OUTPUT.json`. Compiled kernels go to a cache of their own that starts empty.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from timing import process, write

#: Asks for every kernel in every form.
ALL_KERNELS = Path(__file__).with_name("all_kernels.py")

SCENE = "loads: [{disk: top-centre, force: [0.0, -15.0]}]\ncontact: {friction: 0.2}\n"
REPEATS = 5


def run(command: list[str], repeats: int = 1, **environment: str) -> dict[str, float]:
    """Least wall-clock and processor seconds of a process."""
    found = [process(command, **environment) for _ in range(repeats)]
    wall, processor = (min(one[key] for one in found) for key in ("seconds", "cpu_seconds"))
    return {"seconds": wall, "processor_seconds": processor}


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
    for row in rows:
        print(row)
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
