"""The same slab in LAMMPS, where `lmp` is installed (Debian: `apt-get install lammps`).

The linear law (matched on a two-disk collision): `gran/hooke/history` takes damping per effective mass, so a pair's
`gamma` is twice and a wall's once the square root of the stiffness; `dampflag` must be 1. Units are the reduced ones.

The 3/2 law is `granular` with `hertz` and `linear_history`: its normal forces are ours to rounding, for unequal disks
and walls too. `damping velocity` makes the dashpots absolute; the tangential one is given over the normal one. The arm
of its torque ends at the middle of the overlap, ours at the rim.

    python benchmarks/lammps.py FRICTION LATTICE_CONSTANT OUT.json     what tests/data stores for the 3/2 law
"""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from granular_response.contact import Law
from granular_response.scene import Packing, Scene
from granular_response.solve import Problem

#: Timed runs after the settling.
REPEATS = 8


@dataclass(frozen=True)
class Run:
    """What one LAMMPS run gave: steps and seconds of the last stage, and vertical forces on the bottom row."""

    steps: int
    seconds: float
    floor_rest: np.ndarray
    floor: np.ndarray
    energy_rest: float  #: Kinetic energy per disk, without that of rotation.
    energy: float


def executable() -> str | None:
    """Path of `lmp`, or None where it is not installed."""
    return shutil.which("lmp")


def version(command: str | None = None) -> str | None:
    """The version line of `lmp`, or of the one at ``command``; None where there is none."""
    command = command or executable()
    if command is None:
        return None
    text = subprocess.run([command, "-h"], capture_output=True, text=True).stdout
    found = re.search(r"(LAMMPS|Large-scale)[^\n]*- *(\d+ \w+ \d+[^\n]*)", text)
    return found.group(2).strip() if found else "unknown"


def data(packing: Packing, types: int = 1) -> str:
    """The disks as `read_data` takes them, all of the first of ``types`` types."""
    density = packing.mass / (4.0 / 3.0 * math.pi * packing.radius**3)
    top = float(packing.position[:, 1].max()) + 10.0
    lines = [
        "slab", "", f"{packing.n} atoms", f"{types} atom types",
        f"0 {packing.width!r} xlo xhi", f"-1 {top!r} ylo yhi", "-0.5 0.5 zlo zhi", "", "Atoms", "",
    ]  # fmt: skip
    for i, ((x, z), radius) in enumerate(zip(packing.position, packing.radius, strict=True), 1):
        lines.append(f"{i} 1 {2 * radius:.17g} {density[i - 1]:.17g} {x:.17g} {z:.17g} 0")
    return "\n".join(lines) + "\n"


def _linear(friction: float) -> tuple[str, str]:
    """The linear law between disks, and at walls."""
    k, kt = 3000.0, 2400.0
    if friction:
        style = f"pair_style gran/hooke/history {k} {kt} {2 * k**0.5!r} {2 * kt**0.5!r} {friction} 1"
    else:
        style = f"pair_style gran/hooke {k} 0.0 {2 * k**0.5!r} 0.0 0.0 0"
    kind = "hooke/history" if friction else "hooke"
    return f"{style}\npair_coeff * *", f"{kind} {2 * k} {2 * kt} {(2 * k) ** 0.5!r} {(2 * kt) ** 0.5!r} 0 1"


def _hertz(friction: float) -> tuple[str, str]:
    """The 3/2 law between disks, and at walls; the constants are those of the scene's laws."""
    problem = Problem.from_scene(Scene().updated({"contact.law": "hertz", "contact.friction": friction}))

    def model(law: Law) -> str:
        constant = law.factor / math.sqrt(law.reduced_radius)
        part = law.tangential_damping / law.normal_damping
        kind = "linear_history" if law.friction else "linear_nohistory"
        stiffness = f"{law.tangential_stiffness!r} " if law.friction else ""
        tangential = f"{kind} {stiffness}{part!r} {law.friction!r}"
        return f"hertz {constant!r} {law.normal_damping!r} tangential {tangential} damping velocity"

    pair, wall = model(problem.pair_law), model(problem.wall_law)
    return f"pair_style granular\npair_coeff * * {pair}", f"granular {wall}"


def _script(friction: float, packing: Packing, time_step: float, body: str, law: str = "linear") -> str:
    pair, wall = _hertz(friction) if law == "hertz" else _linear(friction)
    bottom = int((packing.row == 0).sum())
    return f"""
units si
dimension 2
boundary f f p
newton off
comm_modify vel yes
atom_style sphere
read_data slab.data
{pair}
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
timestep {time_step!r}
group bottom id 1:{bottom}
fix move all nve/sphere disc
fix weight all gravity 1.0 vector 0 -1 0
fix floor all wall/gran {wall} yplane 0.0 NULL
fix sides all wall/gran {wall} xplane 0.0 {packing.width!r}
fix plane all enforce2d
thermo_modify norm no
thermo 100000
compute heights bottom property/atom y
{body}
"""


def run(command: str, disks: str, script: str) -> tuple[list[tuple[int, float]], Path]:
    """Steps and seconds of each `run` of a script, and the folder with what it wrote."""
    folder = Path(tempfile.mkdtemp())
    (folder / "slab.data").write_text(disks)
    (folder / "in.slab").write_text(script)
    done = subprocess.run(
        [command, "-in", "in.slab", "-screen", "none", "-log", "log"], cwd=folder, capture_output=True, text=True
    )
    log = (folder / "log").read_text() if (folder / "log").exists() else ""
    if done.returncode:
        errors = [line for line in log.splitlines() if "ERROR" in line]
        shutil.rmtree(folder)
        raise RuntimeError(f"{command} failed: {' '.join(errors) or done.stderr}")
    loops = re.findall(r"Loop time of ([\d.eE+-]+) on \d+ procs for (\d+) steps", log)
    return [(int(steps), float(seconds)) for seconds, steps in loops], folder


def step_time(
    packing: Packing, friction: float, settle: int, steps: int, time_step: float = 4e-4, command: str | None = None,
    repeats: int = REPEATS,
) -> float:  # fmt: skip
    """Seconds per step after `settle` steps under gravity: the least of ``repeats``."""
    body = "\n".join([f"run {settle}", *[f"run {steps}"] * repeats])
    loops, folder = run(command or executable(), data(packing), _script(friction, packing, time_step, body))
    shutil.rmtree(folder)
    return min(seconds / steps for steps, seconds in loops[1:])


def response(
    packing: Packing, friction: float, disk: int, force: float, ramp: float, rest_steps: int, load_steps: int,
    time_step: float = 5e-4, law: str = "linear",
) -> Run:  # fmt: skip
    """Floor forces at rest and under a vertical load on one disk, ramped linearly over `ramp`."""
    ramp_steps = round(ramp / time_step)
    body = f"""
run {rest_steps}
print "energy $(ke/atoms:%.3e)"
write_dump bottom custom rest.dump id y modify sort id format float %.17g
velocity all set 0 0 0
set group all omega 0 0 0
reset_timestep 0
group loaded id {disk + 1}
variable push equal -{force!r}*(step<{ramp_steps})*step/{ramp_steps}-{force!r}*(step>={ramp_steps})
fix push loaded addforce 0.0 v_push 0.0
run {load_steps}
print "energy $(ke/atoms:%.3e)"
write_dump bottom custom loaded.dump id y modify sort id format float %.17g
"""
    loops, folder = run(executable(), data(packing), _script(friction, packing, time_step, body, law))
    radius = packing.radius[packing.row == 0]
    overlap = [np.maximum(radius - _heights(folder / name), 0.0) for name in ("rest.dump", "loaded.dump")]
    floor = [4000.0**1.5 * xi**1.5 if law == "hertz" else 6000.0 * xi for xi in overlap]
    log = (folder / "log").read_text()
    energy = re.findall(r"^energy ([\d.eE+-]+)", log, re.MULTILINE)
    shutil.rmtree(folder)
    return Run(
        sum(s for s, _ in loops), sum(t for _, t in loops), floor[0], floor[1], float(energy[0]), float(energy[1])
    )


def _heights(path: Path) -> np.ndarray:
    rows = path.read_text().split("ITEM: ATOMS id y", 1)[1].split()
    return np.array(rows, float).reshape(-1, 2)[:, 1]


def profile(friction: float, lattice_constant: float) -> dict:
    """What tests/data stores for the 3/2 law: floor forces of the paper's slab before and under a force of 4 on top.

    ``lattice_constant`` below 2 presses the disks of a row together.
    """
    packing = Scene().updated({"packing.lattice_constant": lattice_constant}).packing.build()
    force, steps, time_step = 4.0, 120_000, 5e-4
    disk = int(np.flatnonzero(packing.row == packing.row.max())[30])
    run = response(packing, friction, disk, force, 20.0, steps, steps, time_step, law="hertz")
    pair, wall = _hertz(friction)
    return {
        "code": f"LAMMPS {version()}",
        "pair": pair,
        "wall": f"fix wall/gran {wall}",
        "friction": friction,
        "lattice_constant": lattice_constant,
        "force": force,
        "ramp_time": 20.0,
        "time_step": time_step,
        "steps": [steps, steps],
        "kinetic_energy_per_disk": [run.energy_rest, run.energy],
        "floor_force_gravity": run.floor_rest.tolist(),
        "floor_force_loaded": run.floor.tolist(),
        "response": ((run.floor - run.floor_rest) / force).tolist(),
    }


if __name__ == "__main__":
    friction, lattice_constant, output = sys.argv[1:]
    Path(output).write_text(json.dumps(profile(float(friction), float(lattice_constant)), indent=1) + "\n")
