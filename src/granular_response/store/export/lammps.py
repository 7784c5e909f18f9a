"""A state as an input script for LAMMPS, with the contact laws, walls and loads of its scene.

Its style ``granular`` has both laws of this package: ``hooke`` and ``hertz`` with ``linear_history`` and absolute
dashpots (``damping velocity``). The arm of its torques ends at the middle of an overlap, ours at the rim, as that of
``gran/hooke/history``. Its integrator is our leapfrog.

No command of LAMMPS reads the springs of contacts. They are stretched by what stretches all springs: slip. In one step
without an integrator disks have velocities and stay where they are, and every contact slips by its spring.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr

from ...contact import Hertz, Law, Linear
from ...contact.rolling import FREE, Rolling
from ...errors import GranularError
from ...scene import Packing
from ...scene.names import WALL_FIXES
from ...solvers.problem import Problem
from ...solvers.timestep import resolve_time_step
from ...state import Box, FloatArray, State, wall_normals
from ..result import CONTACTS, scene_of, state_from
from .text import lammps_data

#: Time that a script runs for, after the ramp of its loads, in sqrt(R/g).
SETTLING = 100.0
#: Largest friction that ``gran/hooke/history`` takes.
MOST_XMU = 1e4
#: Time of the step that stretches springs: so long that velocities are nothing to dashpots.
WINDING_TIME = 1e12
#: Part of the largest spring by which one may be missed.
MOST_MISSED = 1e-10


class NoCounterpart(GranularError, ValueError):
    """A scene with something that LAMMPS has not. The message is one line."""


def model(law: Law, rolling: Rolling = FREE) -> str:
    """A contact law in the words of ``pair_style granular``, with its rolling resistance."""
    if isinstance(law, Hertz):
        kind, constant = "hertz", law.factor / math.sqrt(law.reduced_radius)
    elif isinstance(law, Linear):
        kind, constant = "hooke", law.normal_stiffness
    else:
        raise NoCounterpart("contact.law: must be linear or hertz for LAMMPS")
    part = law.tangential_damping / law.normal_damping if law.normal_damping else 0.0
    tangential = f"linear_history {law.tangential_stiffness!r} " if law.friction else "linear_nohistory "
    rolls = f" rolling sds {' '.join(map(repr, rolling))}" if rolling.friction > 0.0 else ""
    pulls = "" if law.least_force < 0.0 else " limit_damping"
    normal = f"{kind} {constant!r} {law.normal_damping!r}"
    return f"{normal} tangential {tangential}{part!r} {law.friction!r}{rolls} damping velocity{pulls}"


def _pair_style(problem: Problem) -> list[str]:
    """The contact law between disks.

    Linear springs with friction are those of ``gran/hooke/history``, whose torques end at the rim, as ours do: in
    equilibrium the state of one is that of the other. Its dashpots are per effective mass, 1/2 of two mean disks.
    """
    law, *rolling = (between for between, _ in problem.laws)
    if not isinstance(law, Linear) or any(one.friction > 0.0 for one in rolling) or not 0.0 < law.friction <= MOST_XMU:
        return ["pair_style granular", f"pair_coeff * * {model(law, *rolling)}"]
    numbers = (law.normal_stiffness, law.tangential_stiffness, 2.0 * law.normal_damping, 2.0 * law.tangential_damping)
    pulls = "" if law.least_force < 0.0 else " limit_damping"
    return [f"pair_style gran/hooke/history {' '.join(map(repr, numbers))} {law.friction!r} 1{pulls}", "pair_coeff * *"]


def winding(state: State, radius: FloatArray) -> FloatArray:
    """(3, n) displacements x, z and rotations of disks that stretch all springs from zero to what they are.

    Its least solution, of as many linear equations as there are closed contacts. Raises NoCounterpart where there is
    none: contacts of which the tangential forces alone can balance.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import lsmr

    n, pairs, walls = len(radius), state.pairs, state.walls
    rows, columns, values, springs, count = [], [], [], [], 0
    for c, normal in ((pairs, state.pair_normal()), (walls, wall_normals(walls.second))):
        live = np.flatnonzero(c.touching)
        (nx, nz), row = normal[live].T, count + np.arange(len(live))
        sides = ((c.first, 1.0), (c.second, -1.0))[: 2 if c is pairs else 1]
        for disk, sign in ((which[live], sign) for which, sign in sides):
            rows += [row] * 3
            columns += [disk, n + disk, 2 * n + disk]
            values += [-sign * nz, sign * nx, -radius[disk]]
        springs.append(c.spring[live])
        count += len(live)
    wanted = np.concatenate(springs)
    slip = csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(count, 3 * n))
    found = lsmr(slip, wanted, atol=0.0, btol=0.0, conlim=0.0, maxiter=100 * n)[0]
    if np.abs(slip @ found - wanted).max() > MOST_MISSED * np.abs(wanted).max():
        raise NoCounterpart("no motion of the disks stretches the tangential springs of all contacts to what they are")
    return found.reshape(3, n)


def script(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The script, the disks in a data file beside it, and with friction the motion that stretches their springs."""
    scene, state, box = scene_of(dataset), dataset.isel(state=-1), Box.of(dataset.attrs)
    position, radius = state["position"].values, state["radius"].values
    packing = Packing(
        position, radius, np.full(len(radius), -1, np.int32), box.width, periodic=box.periodic,
        given_mass=state["mass"].values,
    )  # fmt: skip
    problem = Problem.from_scene(scene, packing)
    wall = model(*(at_wall for _, at_wall in problem.laws))
    first, last = float(state["state_load_factor"]), scene.protocol.load_factors[-1]
    moving = "loaded_disk" not in state  # of a motion, in which loads have begun to grow
    step = float(dataset.attrs["time_step"]) if moving else resolve_time_step(problem)
    ramp = scene.protocol.ramp_time * (last - first if moving else 1.0)
    steps = max(round(ramp / step), 1)
    file, slips = path.with_suffix(".data"), path.with_suffix(".slip")
    made = lammps_data(dataset, file)
    lines = [
        "# by granular-response; units of mean radius, mean mass and g. z of the scene is y here",
        "units si", "dimension 2", f"boundary {'p' if box.periodic else 'f'} fs p", "newton off",
        "comm_modify vel yes", "atom_style sphere", "atom_modify map yes", f"read_data {file.name}",
        *_pair_style(problem), "neighbor 0.3 bin", "neigh_modify delay 0 every 1 check yes",
        f"fix floor all wall/gran granular {wall} yplane 0.0 NULL contacts",
    ]  # fmt: skip
    if not box.periodic:
        lines.append(f"fix sides all wall/gran granular {wall} xplane 0.0 {box.width!r} contacts")
    if wound_springs(state):
        moved = (winding(state_from(dataset, -1), radius) / WINDING_TIME).tolist()
        made[slips] = "".join(
            f"{len(radius)}\n" + "".join(f"{k} {value!r}\n" for k, value in enumerate(one, start=1)) for one in moved
        ).encode("ascii")
        lines += [
            "# tangential springs: one long step without an integrator, in which contacts slip and disks stay in place",
            f"timestep {WINDING_TIME!r}",
            *(f"variable {name} atomfile {slips.name}" for name in ("slipx", "slipy", "turn")),
            "next slipy", "next turn", "next turn",
            "velocity all set v_slipx v_slipy 0.0", "set group all omega 0.0 0.0 v_turn", "run 1",
            "velocity all set 0.0 0.0 0.0", "set group all omega 0.0 0.0 0.0", "reset_timestep 0",
        ]  # fmt: skip
    lines += [f"timestep {step!r}", "fix move all nve/sphere disc"]
    if not scene.motion.weightless:
        lines.append("fix weight all gravity 1.0 vector 0 -1 0")
    grows = f"({last - first!r})*((step<{steps})*step/{steps}+(step>={steps}))"
    lines.append(f"variable factor equal {first!r}" + ("" if first == last else f"+{grows}"))
    if moving and scene.loads:  # on disks that are chosen where the motion begins
        start = Problem.from_scene(scene)
        state = state.assign(loaded_disk=("load_point", start.with_loads(start.packing.position).load_disk))
    for k, load in enumerate(scene.loads):
        if load.torque or load.displacement is not None:
            key = "torque" if load.torque else "displacement"
            raise NoCounterpart(f"loads[{k}].{key}: must be left out, LAMMPS has forces on single disks only")
        lines.append(f"group loaded{k} id {int(state['loaded_disk'][k]) + 1}")
        lines += [f"variable {axis}{k} equal {part!r}*v_factor" for axis, part in zip("xy", load.force, strict=True)]
        lines.append(f"fix push{k} loaded{k} addforce v_x{k} v_y{k} 0.0")
    walls = " ".join(f"f_{fix}[2] f_{fix}[3]" for fix in WALL_FIXES[: 1 if box.periodic else 2])
    lines += [
        "fix plane all enforce2d", "thermo 10000", "thermo_style custom step ke fmax", "thermo_modify norm no",
        "compute pair all property/local patom1 patom2 cutoff radius",
        "compute bears all pair/local force p1 p2 p3 cutoff radius",
        f"variable end equal {steps + round(SETTLING / step)}",
        f"dump bears all local ${{end}} {path.stem}.contacts.dump c_pair[1] c_pair[2] "
        + " ".join(f"c_bears[{k}]" for k in (1, 2, 3, 4)),
        "dump_modify bears format float %.17g",
        "run ${end}",
        f"write_dump all custom {path.stem}.dump id type x y z radius mass vx vy omegaz {walls} "
        "modify sort id format float %.17g",
    ]  # fmt: skip
    return {path: ("\n".join(lines) + "\n").encode("ascii"), **made}


def wound_springs(state: xr.Dataset) -> bool:
    """Whether a script brings the tangential springs of a state with it; those of rolling have no such way."""
    names = [f"{prefix}_{kind}" for prefix in CONTACTS for kind in ("spring", "rolling_spring")]
    tangential, rolling = (any(np.any(state[name]) for name in names[k::2] if name in state) for k in (0, 1))
    return tangential and not rolling
