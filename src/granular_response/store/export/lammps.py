"""A state as an input script for LAMMPS, with the contact laws, walls and loads of its scene.

Its style ``granular`` has both laws of this package: ``hooke`` and ``hertz`` with ``linear_history`` and absolute
dashpots (``damping velocity``). The arm of its torques ends at the middle of an overlap, ours at the rim. Its
integrator is our leapfrog.
"""

from __future__ import annotations

import math
from pathlib import Path

import xarray as xr

from ...contact import Hertz, Law, Linear
from ...contact.rolling import Rolling
from ...errors import GranularError
from ...scene import Packing
from ...solvers.problem import Problem
from ...solvers.timestep import resolve_time_step
from ...state import Box
from ..result import scene_of
from .text import lammps_data

#: Time that a script runs for, after the ramp of its loads, in sqrt(R/g).
SETTLING = 100.0


class NoCounterpart(GranularError, ValueError):
    """A scene with something that LAMMPS has not. The message is one line."""


def model(law: Law, rolling: Rolling | None = None) -> str:
    """A contact law in the words of ``pair_style granular``, with its rolling resistance."""
    if isinstance(law, Hertz):
        kind, constant = "hertz", law.factor / math.sqrt(law.reduced_radius)
    elif isinstance(law, Linear):
        kind, constant = "hooke", law.normal_stiffness
    else:
        raise NoCounterpart("contact.law: must be linear or hertz for LAMMPS")
    part = law.tangential_damping / law.normal_damping if law.normal_damping else 0.0
    tangential = f"linear_history {law.tangential_stiffness!r} " if law.friction else "linear_nohistory "
    rolls = "" if rolling is None else f" rolling sds {rolling.stiffness!r} {rolling.damping!r} {rolling.friction!r}"
    pulls = "" if law.least_force < 0.0 else " limit_damping"
    normal = f"{kind} {constant!r} {law.normal_damping!r}"
    return f"{normal} tangential {tangential}{part!r} {law.friction!r}{rolls} damping velocity{pulls}"


def script(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The script, and the disks in a data file beside it."""
    scene, state, box = scene_of(dataset), dataset.isel(state=-1), Box.of(dataset.attrs)
    position, radius, row = (state[name].values for name in ("position", "radius", "row"))
    packing = Packing(position, radius, row, box.width, periodic=box.periodic, given_mass=state["mass"].values)
    problem = Problem.from_scene(scene, packing)
    step, ramp = resolve_time_step(problem), scene.protocol.ramp_time
    pair, wall = model(problem.pair_law, problem.pair_rolling), model(problem.wall_law, problem.wall_rolling)
    first, last = float(state["state_load_factor"]), scene.protocol.load_factors[-1]
    steps = max(round(ramp / step), 1)
    file = path.with_suffix(".data")
    lines = [
        "# by granular-response; units of mean radius, mean mass and g. z of the scene is y here",
        "units si", "dimension 2", f"boundary {'p' if box.periodic else 'f'} fs p", "newton off",
        "comm_modify vel yes", "atom_style sphere", f"read_data {file.name}",
        "pair_style granular", f"pair_coeff * * {pair}", "neighbor 0.3 bin",
        "neigh_modify delay 0 every 1 check yes", f"timestep {step!r}",
        "fix move all nve/sphere disc", "fix weight all gravity 1.0 vector 0 -1 0",
        f"fix floor all wall/gran granular {wall} yplane 0.0 NULL",
    ]  # fmt: skip
    if not box.periodic:
        lines.append(f"fix sides all wall/gran granular {wall} xplane 0.0 {box.width!r}")
    grows = f"({last - first!r})*((step<{steps})*step/{steps}+(step>={steps}))"
    lines.append(f"variable factor equal {first!r}" + ("" if first == last else f"+{grows}"))
    for k, (load, disk) in enumerate(zip(scene.loads, state["loaded_disk"].values.tolist(), strict=True)):
        if load.torque or load.displacement is not None:
            key = "torque" if load.torque else "displacement"
            raise NoCounterpart(f"loads[{k}].{key}: must be left out, LAMMPS has forces on single disks only")
        lines.append(f"group loaded{k} id {disk + 1}")
        lines += [f"variable {axis}{k} equal {part!r}*v_factor" for axis, part in zip("xy", load.force, strict=True)]
        lines.append(f"fix push{k} loaded{k} addforce v_x{k} v_y{k} 0.0")
    lines += ["fix plane all enforce2d", "thermo_modify norm no", "thermo 10000"]
    lines += ["thermo_style custom step ke fmax", f"run {steps + round(SETTLING / step)}"]
    return {path: ("\n".join(lines) + "\n").encode("ascii"), **lammps_data(dataset, file)}
