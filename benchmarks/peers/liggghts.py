"""The same slab in LIGGGHTS, where `liggghts` is installed (Debian: `apt-get install liggghts`).

The contact law is that of `lammps.py`, its constants given for each pair of types; type 2 is the wall. In two
dimensions its masses and moments of inertia are those of disks, of a density per area.
"""

from __future__ import annotations

import math
import re
import subprocess

from peers import lammps, processes

from granular_response.scene import Packing

#: The linear law with tangential springs.
MODEL = "gran model hooke/stiffness tangential history"
#: What stops rotations.
STILL = "omegax 0 omegay 0 omegaz 0"


def version(command: str) -> str:
    """Its version."""
    text = subprocess.run([command, "-log", "none", "-h"], capture_output=True, text=True).stdout
    found = re.search(r"LIGGGHTS-PUBLIC ([\d.]+)", text)
    return found.group(1) if found else "unknown"


def _script(friction: float, packing: Packing, time_step: float, body: str) -> str:
    k, kt = 3000.0, 2400.0

    def constant(name: str, pair: float, wall: float) -> str:
        return f"fix {name} all property/global {name} peratomtypepair 2 {pair!r} {wall!r} {wall!r} {wall!r}"

    constants = [
        constant("kn", k, 2 * k), constant("kt", kt, 2 * kt), constant("gamman", 2 * k**0.5, (2 * k) ** 0.5),
        constant("gammat", 2 * kt**0.5, (2 * kt) ** 0.5), constant("coefficientFriction", friction, 0.0),
    ]  # fmt: skip
    bottom = f"<= {int((packing.row == 0).sum())}"
    planes = {"floor": "yplane 0.0", "left": "xplane 0.0", "right": f"xplane {packing.width!r}"}
    walls = [f"fix {name} all wall/{MODEL} primitive type 2 {plane}" for name, plane in planes.items()]
    lines = [
        "units si", "dimension 2", "boundary f f p", "newton off", "communicate single vel yes", "atom_style sphere",
        "atom_modify map array", "read_data slab.data", *constants, f"pair_style {MODEL}", "pair_coeff * *",
        "neighbor 0.3 bin", "neigh_modify delay 0 every 1 check yes", f"timestep {time_step!r}",
        f"group bottom id {bottom}",
        "fix weight all gravity 1.0 vector 0 -1 0", *walls, "fix move all nve/sphere", "fix plane all enforce2d",
        "thermo 100000", body,
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _data(packing: Packing) -> str:
    """The disks: in two dimensions their density is that of an area."""
    return lammps.data(packing, 2, packing.mass / (math.pi * packing.radius**2))


def steps_used(
    packing: Packing, friction: float, settle: int, steps: int, time_step: float, command: str, repeats: int
) -> processes.Used:
    """What steps take after ``settle`` steps under gravity, which are the first stage."""
    text = _script(friction, packing, time_step, processes.settled_stages(settle, steps, repeats))
    with processes.script(command, _data(packing), text) as (used, _):
        return used


def response(
    packing: Packing, friction: float, disk: int, force: float, ramp: float, rest_steps: int, load_steps: int,
    time_step: float, command: str,
) -> lammps.Run:  # fmt: skip
    """Floor forces at rest and under a vertical load on one disk, ramped linearly over ``ramp``."""
    body = lammps.loaded_stages(
        disk, force, ramp, rest_steps, load_steps, time_step, 'sort id format "%d %.17g"', STILL
    )
    text = _script(friction, packing, time_step, body)
    with processes.script(command, _data(packing), text) as (used, folder):
        return lammps.loaded_run(packing, used, lammps.heights(folder), [], "linear")
