"""What it buys that Numba looks at the types of arguments once (`machine_code.typed`), not at every call of a kernel.

`python benchmarks/calls.py OUTPUT.json`. Both ways are timed in turns in one process, on slabs of two sizes.
"""

import sys

from timing import least, write

from granular_response.scene import Scene
from granular_response.solvers import dynamics, equations
from granular_response.solvers.solution import solve_scene

#: Layers and disks of the lowest row: a slab whose kernels work for less time than their calls take, and the paper's.
SLABS, FRICTION, FORCE = ((8, 21), (15, 61)), 0.3, 15.0
#: Runs of which the least time counts.
TURNS = 40


def main(path: str) -> None:
    ways, rows = {"once": equations.typed, "at every call": lambda compiled, of: compiled}, []
    for layers, row in SLABS:
        slab = {"kind": "slab", "layers": layers, "disks_per_row": row}
        loads = [{"disk": "top-centre", "force": [0.0, -FORCE]}]
        scene = Scene.from_dict({"packing": slab, "contact": {"friction": FRICTION}, "loads": loads})
        times: dict[str, list[float]] = {way: [] for way in ways}
        for _ in range(TURNS):
            for way, typed in ways.items():
                dynamics.typed = equations.typed = typed
                times[way].append(least(lambda scene=scene: solve_scene(scene))[1]["processor"])
        seconds = {f"processor_seconds_types_{way.replace(' ', '_')}": min(found) for way, found in times.items()}
        rows.append({"disks": scene.packing.disk_count, "friction": FRICTION, "force": FORCE, **seconds})
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
