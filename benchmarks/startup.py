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

#: Asks for every kernel in every form.
ALL_KERNELS = Path(__file__).with_name("all_kernels.py")

SCENES = {
    "default (friction 0.2, force 15)": "loads: [{disk: top-centre, force: [0.0, -15.0]}]\ncontact: {friction: 0.2}\n",
    "frictionless, force 4": "loads: [{disk: top-centre, force: [0.0, -4.0]}]\ncontact: {friction: 0.0}\n",
    "default, rest alone": "loads: []\ncontact: {friction: 0.2}\n",
    "two disks": "packing: {kind: slab, layers: 1, disks_per_row: 2}\nloads: []\ncontact: {friction: 0.2}\n",
}
#: What a run waits for before it does anything, as processes of their own; they show how fast the machine is, too.
BEFORE = {
    "numpy, scipy.sparse, numba and xarray imported": "import numpy, scipy.sparse.linalg, numba, xarray, netCDF4",
    "the interpreter alone": "pass",
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
        command = [sys.executable, str(ALL_KERNELS)]
        rows.append({"what": "all kernels, compiled", **run(command, NUMBA_CACHE_DIR=cache)})
        rows.append({"what": "the same, from the cache", **run(command, 2, NUMBA_CACHE_DIR=cache)})
        for name, text in SCENES.items():
            scene, result = Path(folder) / "scene.yaml", Path(folder) / "result.nc"
            scene.write_text(text)
            command = [sys.executable, "-m", "granular_response", "run", str(scene), "-o", str(result)]
            run(command)  # compiles
            rows.append({"what": f"granular-response run, {name}", **run(command, REPEATS)})
        for name, code in BEFORE.items():
            rows.append({"what": name, **run([sys.executable, "-c", code], REPEATS)})
        command = [sys.executable, "-m", "granular_response", "--version"]
        rows.append({"what": "granular-response --version", **run(command, REPEATS)})
    for row in rows:
        print(row)
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
