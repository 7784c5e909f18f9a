"""Small packings with rolling resistance in LAMMPS: what tests/data stores for them.

Its style `granular` has the model `rolling sds` with the constants of ours: stiffness, damping (absolute) and
coefficient. Its time step is our leapfrog's, so a packing that falls at random falls alike.

    python -m peers.lammps_rolling OUT_FOLDER [LMP]
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from peers import lammps, processes

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem

#: Time step, steps under gravity and under the load, and the time in which it grows.
TIME_STEP, STEPS, RAMP = 5e-4, (160_000, 160_000), 20.0


def pile(layers: int) -> dict[str, Any]:
    """A pile with sides at 60 degrees, of rows of touching disks, each one shorter, on a floor without side support."""
    rows = [(k, i) for k in range(layers) for i in range(layers - k)]
    x = [10.0 + 2.0 * i + k for k, i in rows]
    z = [1.0 + 3.0**0.5 * k for k, _ in rows]
    return {"kind": "arrays", "x": x, "z": z, "radius": [1.0] * len(x), "width": 2.0 * layers + 18.0}


def scene(packing: dict[str, Any], friction: float, rolling: float, wall: float, force: float, disk: Any) -> Scene:
    """A packing with rolling resistance under a force downwards."""
    return Scene.from_dict(
        {
            "packing": packing,
            "contact": {"friction": friction, "rolling_friction": rolling, "rolling_stiffness_ratio": 0.5},
            "wall": {"friction": wall, "rolling_friction": rolling if wall else 0.0},
            "loads": [{"disk": disk, "force": [0.0, -force]}],
            "protocol": {"integrator": "leapfrog", "time_step": TIME_STEP, "ramp_time": RAMP},
        }
    )


SLAB = {"kind": "slab", "layers": 8, "disks_per_row": 15}
RANDOM = SLAB | {"polydispersity": 0.1, "lattice_constant": "touching-largest", "seed": 2}
CASES = {
    "slab_0.05": scene(SLAB, 0.2, 0.05, 0.0, 4.0, "top-centre"),
    "slab_1": scene(SLAB, 0.2, 1.0, 0.0, 4.0, "top-centre"),
    "polydisperse": scene(RANDOM, 0.5, 0.2, 0.3, 2.0, "top-centre"),
    "pile": scene(pile(6), 0.6, 0.3, 0.6, 2.0, 20),
}


def profile(name: str, command: str) -> dict[str, Any]:
    """Heights of the disks on the floor, at rest under gravity and loaded; forces on the floor follow from them."""
    asked = CASES[name]
    problem = Problem.from_scene(asked)
    packing = problem.packing
    problem = problem.with_loads(packing.position)
    words = [
        lammps.model(*(between for between, _ in problem.laws)),
        lammps.model(*(at_wall for _, at_wall in problem.laws)),
    ]
    lammps.LAWS["rolling"] = lambda _: (f"pair_style granular\npair_coeff * * {words[0]}", f"granular {words[1]}")
    body = lammps.loaded_stages(
        int(problem.load_disk[0]), -asked.loads[0].force[1], RAMP, *STEPS, TIME_STEP, "sort id format float %.17g",
        after='print "energy $(ke/atoms:%.3e)"',
    ).replace("write_dump bottom custom", "write_dump all custom")  # fmt: skip
    script = lammps._script(0.0, packing, TIME_STEP, body, "rolling")

    with processes.script(command, lammps.data(packing), script) as (_, folder):
        log = (folder / "log").read_text()
        rest, loaded = (heights.tolist() for heights in lammps.heights(folder))
    energy = [float(line.split()[1]) for line in log.splitlines() if line.startswith("energy ")]
    return {
        "code": f"LAMMPS {lammps.version(command)}",
        "pair": words[0],
        "wall": words[1],
        "time_step": TIME_STEP,
        "steps": STEPS,
        "kinetic_energy_per_disk": energy,
        "scene": asked.to_dict(),
        "height_gravity": rest,
        "height_loaded": loaded,
    }


if __name__ == "__main__":
    folder, *command = sys.argv[1:]
    for name in CASES:
        text = json.dumps(profile(name, *(command or [lammps.executable() or "lmp"])))
        (Path(folder) / f"lammps_rolling_{name}.json").write_text(text + "\n")
