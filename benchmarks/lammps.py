"""The same slab in LAMMPS, where `lmp` is installed (Debian: `apt-get install lammps`).

The contact law is that of `core.law` (matched on a two-disk collision): `gran/hooke/history` takes damping per
effective mass, so a pair's `gamma` is twice and a wall's once the square root of the stiffness; `dampflag` must
be 1. Units are the reduced ones.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from granular_response.scene import Packing

#: Timed runs after the settling.
REPEATS = 8


@dataclass(frozen=True)
class Run:
    """What one LAMMPS run gave: steps and seconds of the last stage, and vertical forces on the bottom row."""

    steps: int
    seconds: float
    floor_rest: np.ndarray
    floor: np.ndarray


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


def _script(friction: float, packing: Packing, time_step: float, body: str) -> str:
    k, kt = 3000.0, 2400.0
    if friction:
        style = f"gran/hooke/history {k} {kt} {2 * k**0.5!r} {2 * kt**0.5!r} {friction} 1"
    else:
        style = f"gran/hooke {k} 0.0 {2 * k**0.5!r} 0.0 0.0 0"
    wall = f"{2 * k} {2 * kt} {(2 * k) ** 0.5!r} {(2 * kt) ** 0.5!r} 0 1"
    kind = "hooke/history" if friction else "hooke"
    bottom = int((packing.row == 0).sum())
    return f"""
units si
dimension 2
boundary f f p
newton off
comm_modify vel yes
atom_style sphere
read_data slab.data
pair_style {style}
pair_coeff * *
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
timestep {time_step!r}
group bottom id 1:{bottom}
fix move all nve/sphere disc
fix weight all gravity 1.0 vector 0 -1 0
fix floor all wall/gran {kind} {wall} yplane 0.0 NULL
fix sides all wall/gran {kind} {wall} xplane 0.0 {packing.width!r}
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
    time_step: float = 5e-4,
) -> Run:  # fmt: skip
    """Floor forces at rest and under a vertical load on one disk, ramped linearly over `ramp`."""
    ramp_steps = round(ramp / time_step)
    body = f"""
run {rest_steps}
write_dump bottom custom rest.dump id y modify sort id format float %.17g
velocity all set 0 0 0
set group all omega 0 0 0
reset_timestep 0
group loaded id {disk + 1}
variable push equal -{force!r}*(step<{ramp_steps})*step/{ramp_steps}-{force!r}*(step>={ramp_steps})
fix push loaded addforce 0.0 v_push 0.0
run {load_steps}
write_dump bottom custom loaded.dump id y modify sort id format float %.17g
"""
    loops, folder = run(executable(), data(packing), _script(friction, packing, time_step, body))
    radius = packing.radius[packing.row == 0]
    floor = [6000.0 * np.maximum(radius - _heights(folder / name), 0.0) for name in ("rest.dump", "loaded.dump")]
    shutil.rmtree(folder)
    return Run(sum(s for s, _ in loops), sum(t for _, t in loops), floor[0], floor[1])


def _heights(path: Path) -> np.ndarray:
    rows = path.read_text().split("ITEM: ATOMS id y", 1)[1].split()
    return np.array(rows, float).reshape(-1, 2)[:, 1]
