"""The same slab in YADE, where `yade` is installed (Debian: `apt-get install yade`).

The contact law is that of `lammps.py`: YADE's viscoelastic one, whose constants of a pair are those of its two
materials in series; a constant of zero does not take part, so the wall's springs are those of a disk's material. Its
spheres have the moments of inertia of our disks. `yade_slab.py` is what YADE runs.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from peers import lammps, processes

from granular_response.scene import Packing


def version(command: str) -> str:
    """Its version."""
    text = subprocess.run([command, "--version"], capture_output=True, text=True)
    found = re.search(r"Yade version: (\S+)", text.stdout + text.stderr)
    return found.group(1) if found else "unknown"


def _scene(packing: Packing, friction: float, time_step: float) -> dict:
    """What `yade_slab.py` builds."""
    kn, kt = (3000.0, 2400.0 if friction else 0.0)
    # a wall's dashpot, sqrt(2 k), from the disk's 2 sqrt(k) and one of the wall's own in series
    own = 1.0 / (math.sqrt(0.5) - 0.5)
    return {
        "disk": {
            "kn": 2 * kn,
            "ks": 2 * kt,
            "cn": 2 * kn**0.5,
            "cs": 2 * kt**0.5,
            "frictionAngle": math.atan(friction),
        },
        "wall": {"kn": 0.0, "ks": 0.0, "cn": own * kn**0.5, "cs": own * kt**0.5, "frictionAngle": 0.0},
        "x": packing.position.tolist(),
        "radius": packing.radius.tolist(),
        "mass": packing.mass.tolist(),
        "width": packing.width,
        "time_step": time_step,
    }


def run(command: str, scene: dict) -> dict:
    """What YADE answers."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.json").write_text(json.dumps(scene))
        inner = Path(__file__).with_name("yade_slab.py")
        done = processes.launch([command, "-n", "-x", "-j1", str(inner)], folder)
        answer = Path(folder, "answer.json")
        if not answer.exists():
            raise RuntimeError(f"{command} failed: {(done.stderr or done.stdout)[-500:]}")
        return json.loads(answer.read_text())


def _used(answer: dict) -> processes.Used:
    return processes.Used([processes.Stage(*stage) for stage in answer["stages"]], answer["peak_mebibytes"])


def steps_used(
    packing: Packing, friction: float, settle: int, steps: int, time_step: float, command: str, repeats: int
) -> processes.Used:
    """What steps take after ``settle`` steps under gravity, which are the first stage."""
    stages = [settle, *[steps] * repeats]
    return _used(run(command, {**_scene(packing, friction, time_step), "stages": stages, "load": None}))


def response(
    packing: Packing, friction: float, disk: int, force: float, ramp: float, rest_steps: int, load_steps: int,
    time_step: float, command: str,
) -> lammps.Run:  # fmt: skip
    """Floor forces at rest and under a vertical load on one disk, ramped linearly over ``ramp``."""
    load = {"disk": disk, "force": force, "ramp": ramp}
    scene = {**_scene(packing, friction, time_step), "stages": [rest_steps, load_steps], "load": load}
    answer = run(command, scene)
    bottom = int((packing.row == 0).sum())
    heights = [np.array(answer["heights"][k][:bottom]) for k in (0, 1)]
    return lammps.loaded_run(packing, _used(answer), heights, [], "linear")
