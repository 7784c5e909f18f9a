"""Depth and width of the teardrop of opened contacts against the force, in slabs of up to 240 layers (extends Fig. 5).

`python benchmarks/depth.py OUTPUT.json [MOST_LAYERS]`. Slabs without friction, four times as wide as deep,
each under the same forces. Stiffness grows with layers times disks per row from 1e5 at the paper's size, so that
gravity compresses no slab enough to press its horizontal contacts together (see `docs/reproduction-notes.md`): what is
left is the effect of the depth itself. It is a benchmark because the deepest slab takes some minutes.
"""

from __future__ import annotations

import sys
import time

from timing import power, write

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.studies import LoadPath, Measures

#: layers and disks in the bottom row: both odd or both even, so that the load is in the middle
SLABS = [(15, 61), (30, 122), (60, 242), (120, 482), (240, 962)]
FORCES = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 15.0, 20.0, 30.0, 45.0, 60.0]
STIFFNESS_PER_DISK = 1e5 / (15 * 61)
#: Depths between which the growth is fitted: above a few rows, where the lattice shows, in deep slabs.
FITTED_DEPTH, FITTED_LAYERS = 5.0, 60


def measure(layers: int, per_row: int) -> list[dict]:
    """The region of opened contacts of one slab under each force, up to the first at which it reaches the floor."""
    start = time.process_time()
    stiffness = STIFFNESS_PER_DISK * layers * per_row
    scene = Scene.from_dict(
        {
            "packing": {"kind": "slab", "layers": layers, "disks_per_row": per_row},
            "contact": {"normal_stiffness": stiffness, "friction": 0.0},
            "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
        }
    )
    path = LoadPath.of(scene, rest_state(Problem.from_scene(scene)))
    measures = Measures(path)
    rows = []
    for force in FORCES:
        state = path.at(force)
        region, certificate = measures.region(state), state.certificate
        rows.append(
            {
                "layers": layers,
                "disks": path.problem.n,
                "normal_stiffness": stiffness,
                "force": force,
                "depth": region.depth,
                "width": region.width,
                "reaches_floor": int(region.reaches_floor),
                "force_residual": certificate.force_residual,
                "negative_modes": certificate.negative_modes,
                "cpu_seconds_so_far": time.process_time() - start,
            }
        )
        print(rows[-1], flush=True)
        if region.reaches_floor:
            break
    return rows


def growth(rows: list[dict]) -> list[dict]:
    """Exponents of depth and width in the force, of each deep slab."""
    found = []
    for layers in dict.fromkeys(row["layers"] for row in rows if row["layers"] >= FITTED_LAYERS):
        used = [r for r in rows if r["layers"] == layers and r["depth"] > FITTED_DEPTH and not r["reaches_floor"]]
        if len(used) > 2:
            force = [row["force"] for row in used]
            entry = {"layers": layers, "from_force": force[0], "to_force": force[-1]}
            for key in ("depth", "width"):
                entry[f"exponent_of_{key}"] = power(force, [row[key] for row in used])
            found.append(entry)
    return found


def main(path: str, most_layers: int = 10**9) -> None:
    rows = [row for layers, per_row in SLABS if layers <= most_layers for row in measure(layers, per_row)]
    write(path, {"growth": growth(rows), "runs": rows})


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:3]))
