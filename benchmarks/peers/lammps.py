"""The same slab in LAMMPS, where `lmp` is installed (Debian: `apt-get install lammps`).

The linear law (matched on a two-disk collision): `gran/hooke/history` takes damping per effective mass, so a pair's
`gamma` is twice and a wall's once the square root of the stiffness; `dampflag` must be 1. Units are the reduced ones.

Its newer style `granular` has the linear law too (`hooke`), and the 3/2 law (`hertz`) with `linear_history`: normal
forces of the latter are ours to rounding, for unequal disks and walls too. `damping velocity` makes the dashpots
absolute; the tangential one is given over the normal one. The arm of its torque ends at the middle of the overlap, ours
at the rim.

    python -m peers.lammps FRICTION LATTICE_CONSTANT OUT.json     what tests/data stores for the 3/2 law
"""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from peers import processes

from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.store.export.lammps import model

#: Timed runs after the settling.
REPEATS = 8
#: Files with the heights of the bottom row, at rest and loaded.
DUMPS = ("rest.dump", "loaded.dump")


@dataclass(frozen=True)
class Run:
    """What one run gave: steps and seconds of both stages, and vertical forces on the bottom row."""

    steps: int
    seconds: float
    floor_rest: np.ndarray
    floor: np.ndarray
    energy_rest: float | None  #: Kinetic energy per disk, without that of rotation; None where the code tells none.
    energy: float | None
    processor: float | None  #: Seconds of the processor for all steps, where the system tells them.


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


def data(packing: Packing, types: int = 1, density: np.ndarray | None = None) -> str:
    """The disks as `read_data` takes them, all of the first of ``types`` types; without ``density``, spheres."""
    if density is None:
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


def _granular(law: str, friction: float) -> tuple[str, str]:
    """A law of `pair_style granular` between disks, and at walls; the constants are those of the scene's laws."""
    problem = Problem.from_scene(Scene().updated({"contact.law": law, "contact.friction": friction}))
    return f"pair_style granular\npair_coeff * * {model(problem.pair_law)}", f"granular {model(problem.wall_law)}"


#: Contact laws, between disks and at walls, by name: `linear` is the linear law of the old styles.
LAWS: dict[str, Callable[[float], tuple[str, str]]] = {
    "linear": _linear,
    "granular": lambda friction: _granular("linear", friction),
    "hertz": lambda friction: _granular("hertz", friction),
}


def _script(friction: float, packing: Packing, time_step: float, body: str, law: str = "linear") -> str:
    pair, wall = LAWS[law](friction)
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


def steps_used(
    packing: Packing, friction: float, settle: int, steps: int, time_step: float, command: str, repeats: int,
    law: str = "linear",
) -> processes.Used:  # fmt: skip
    """What steps take after ``settle`` steps under gravity, which are the first stage."""
    body = processes.settled_stages(settle, steps, repeats)
    with processes.script(command, data(packing), _script(friction, packing, time_step, body, law)) as (used, _):
        return used


def step_time(packing: Packing, friction: float, settle: int, steps: int, time_step: float = 4e-4) -> float:
    """Processor seconds of a step of `lmp` after ``settle`` steps under gravity, the least of several repeats.

    Seconds by the clock where the system does not tell those of the processor.
    """
    least = steps_used(packing, friction, settle, steps, time_step, executable(), REPEATS).least()
    return least["processor"] or least["seconds"]


def loaded_stages(
    disk: int, force: float, ramp: float, rest_steps: int, load_steps: int, time_step: float, dump: str,
    still: str = "omega 0 0 0", after: str = "",
) -> str:  # fmt: skip
    """Rest, then a vertical load on one disk that grows linearly over ``ramp``.

    Heights of the bottom row are written with ``dump`` after each, and ``after`` is done; ``still`` stops rotations.
    """
    ramp_steps = round(ramp / time_step)
    return f"""
{processes.stage(rest_steps, first=True)}
{after}
write_dump bottom custom {DUMPS[0]} id y modify {dump}
velocity all set 0 0 0
set group all {still}
reset_timestep 0
group loaded id {disk + 1}
variable push equal -{force!r}*(step<{ramp_steps})*step/{ramp_steps}-{force!r}*(step>={ramp_steps})
fix push loaded addforce 0.0 v_push 0.0
{processes.stage(load_steps, first=True)}
{after}
write_dump bottom custom {DUMPS[1]} id y modify {dump}
"""


def response(
    packing: Packing, friction: float, disk: int, force: float, ramp: float, rest_steps: int, load_steps: int,
    time_step: float = 5e-4, law: str = "linear", command: str | None = None,
) -> Run:  # fmt: skip
    """Floor forces at rest and under a vertical load on one disk, ramped linearly over `ramp`."""
    body = loaded_stages(
        disk, force, ramp, rest_steps, load_steps, time_step, "sort id format float %.17g",
        after='print "energy $(ke/atoms:%.3e)"',
    )  # fmt: skip
    text = _script(friction, packing, time_step, body, law)
    with processes.script(command or executable(), data(packing), text) as (used, folder):
        log = (folder / "log").read_text()
        energy = [float(value) for value in re.findall(r"^energy ([\d.eE+-]+)", log, re.MULTILINE)]
        return loaded_run(packing, used, heights(folder), energy, law)


def loaded_run(packing: Packing, used: processes.Used, found: list[np.ndarray], energy: list[float], law: str) -> Run:
    """Floor forces from the heights of the bottom row at rest and loaded."""
    radius = packing.radius[packing.row == 0]
    overlap = [np.maximum(radius - height, 0.0) for height in found]
    floor = [4000.0**1.5 * xi**1.5 if law == "hertz" else 6000.0 * xi for xi in overlap]
    whole = used.whole()
    return Run(whole["steps"], whole["seconds"], *floor, *(energy or (None, None)), whole["processor"])


def heights(folder: Path) -> list[np.ndarray]:
    """Heights of the bottom row in the dumps at rest and loaded, by number of the disk."""
    found = []
    for name in DUMPS:
        rows = (folder / name).read_text().split("ITEM: ATOMS id y", 1)[1].split()
        found.append(np.array(rows, float).reshape(-1, 2)[:, 1])
    return found


def profile(friction: float, lattice_constant: float) -> dict:
    """What tests/data stores for the 3/2 law: floor forces of the paper's slab before and under a force of 4 on top.

    ``lattice_constant`` below 2 presses the disks of a row together.
    """
    packing = Scene().updated({"packing.lattice_constant": lattice_constant}).packing.build()
    force, steps, time_step = 4.0, 120_000, 5e-4
    disk = int(np.flatnonzero(packing.row == packing.row.max())[30])
    run = response(packing, friction, disk, force, 20.0, steps, steps, time_step, law="hertz")
    pair, wall = LAWS["hertz"](friction)
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
