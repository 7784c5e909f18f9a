"""What a bounce off a wall with friction leaves of a disk's energy: ours, and other codes.

Disks of radius 1 and mass 1 far apart from each other fly at a floor without gravity, with speed 1 at several angles
from the normal and no spin. Springs and dashpots are those of a wall in the paper's slab, or next to no dashpots: with
none at all, `fix wall/gran hooke/history` of LAMMPS of 2025 divides zero by zero. A disk that slides all the time takes
the impulse `friction` times that along the normal, which is a closed form: `sliding`.

That style gives a sliding disk too little friction there, in LAMMPS of 2021 it did not; lammps/lammps#5007 (2026),
which corrects it, tells of bounces that gain energy. `granular` has neither.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from peers import lammps, liggghts, processes, yade_dem

from granular_response.scene import Packing, Scene
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem

FRICTION = 0.5
#: From the normal, degrees.
ANGLES = np.array([5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 60.0, 65.0, 70.0, 73.0, 76.0, 79.0, 82.0, 85.0, 88.0])
#: Between two disks, and to the walls at the sides.
APART = 10.0
#: They touch after a quarter of it; a bounce takes pi / sqrt(6000) = 0.04, somewhat longer with dashpots.
TIME, TOUCH = 0.12, 0.02
TIME_STEP = 1e-5
INERTIA = 0.5
#: Dashpots over critical ones: next to none, and the paper's.
DAMPING = (1e-3, 0.5)


@dataclass(frozen=True)
class After:
    """Velocities (n, 2) and spins (n,) after the bounce."""

    velocity: np.ndarray
    spin: np.ndarray


def incoming() -> np.ndarray:
    """Velocities (n, 2) before."""
    angle = np.radians(ANGLES)
    return np.stack([np.sin(angle), -np.cos(angle)], axis=1)


def packing() -> Packing:
    """The disks, in flight."""
    n = len(ANGLES)
    x = APART * (1.0 + np.arange(n))
    height = 1.0 - TOUCH * incoming()[:, 1]
    return Packing(np.stack([x, height], axis=1), np.ones(n), np.full(n, -1, np.int32), APART * (n + 1))


def scene(damping: float) -> Scene:
    """Wall and disks of the paper, with friction at the wall."""
    return Scene().updated(
        {"wall.friction": FRICTION, "contact.damping_ratio": damping, "wall.damping_ratio": damping, "loads": []}
    )


def our_bounce(damping: float) -> After:
    """By the dynamics that a scene runs by default."""
    problem = Problem.from_scene(scene(damping), packing())
    state = replace(problem.bare_state(), velocity=incoming())
    dynamics = Dynamics(problem, state, "beeman", TIME_STEP)
    dynamics.set_ramps(gravity=(0.0, 0.0, 0.0))
    dynamics.advance(round(TIME / TIME_STEP))
    n = problem.n
    return After(dynamics.v[: 2 * n].reshape(2, n).T.copy(), dynamics.v[2 * n :].copy())


def _wall(law: str, damping: float) -> str:
    """The floor in the words of a style."""
    wall = Problem.from_scene(scene(damping), packing()).wall_law
    if law == "granular":
        return f"granular {lammps.model(wall)}"
    return (
        f"hooke/history {wall.normal_stiffness!r} {wall.tangential_stiffness!r} {wall.normal_damping!r} "
        f"{wall.tangential_damping!r} {wall.friction!r} 1"
    )


def _disks(types: int, density: np.ndarray | None = None) -> str:
    """The disks with their velocities as `read_data` takes them."""
    rows = [f"{i} {u:.17g} {v:.17g} 0 0 0 0" for i, (u, v) in enumerate(incoming(), 1)]
    return lammps.data(packing(), types, density) + "\n".join(["", "Velocities", "", *rows, ""])


def _script(head: list[str], floor: list[str], move: str, dump: str) -> str:
    lines = [
        "units si", "dimension 2", "boundary f f p", "newton off", *head, "neighbor 0.3 bin",
        "neigh_modify delay 0 every 1 check yes", f"timestep {TIME_STEP!r}", *floor, f"fix move all {move}",
        "fix plane all enforce2d", "thermo 100000", f"run {round(TIME / TIME_STEP)}", f"write_dump all custom {dump}",
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _after(folder: Path) -> After:
    """Velocities and spins from the dump."""
    rows = np.array((folder / "after.dump").read_text().split("omegaz", 1)[1].split(), float).reshape(-1, 4)
    return After(rows[:, 1:3], rows[:, 3])


def lammps_bounce(damping: float, *, command: str, law: str) -> After:
    """By LAMMPS with `hooke/history` (``law`` is `linear`) or `granular` between disks and at the wall."""
    pair, _ = lammps.LAWS[law](FRICTION)
    head = ["comm_modify vel yes", "atom_style sphere", "read_data slab.data", pair]
    floor = [f"fix floor all wall/gran {_wall(law, damping)} yplane 0.0 NULL"]
    dump = "after.dump id vx vy omegaz modify sort id format float %.17g"
    with processes.script(command, _disks(1), _script(head, floor, "nve/sphere disc", dump)) as (_, folder):
        return _after(folder)


def liggghts_bounce(damping: float, *, command: str) -> After:
    """By LIGGGHTS; its disks have an area's density."""
    wall = Problem.from_scene(scene(damping), packing()).wall_law
    constants = {
        "kn": wall.normal_stiffness, "kt": wall.tangential_stiffness, "gamman": wall.normal_damping,
        "gammat": wall.tangential_damping, "coefficientFriction": wall.friction,
    }  # fmt: skip
    head = ["communicate single vel yes", "atom_style sphere", "atom_modify map array", "read_data slab.data"]
    head += [
        f"fix {name} all property/global {name} peratomtypepair 2" + 4 * f" {x!r}" for name, x in constants.items()
    ]
    head += [f"pair_style {liggghts.MODEL}", "pair_coeff * *"]
    floor = [f"fix floor all wall/{liggghts.MODEL} primitive type 2 yplane 0.0"]
    dump = 'after.dump id vx vy omegaz modify sort id format "%d %.17g %.17g %.17g"'
    disks = _disks(2, np.full(len(ANGLES), 1.0 / math.pi))
    with processes.script(command, disks, _script(head, floor, "nve/sphere", dump)) as (_, folder):
        return _after(folder)


def yade_bounce(damping: float, *, command: str) -> After:
    """By YADE; the wall's constants are all of the material of the disks."""
    wall = Problem.from_scene(scene(damping), packing()).wall_law
    material = {
        "kn": wall.normal_stiffness, "ks": wall.tangential_stiffness, "cn": wall.normal_damping,
        "cs": wall.tangential_damping, "frictionAngle": math.atan(wall.friction),
    }  # fmt: skip
    nothing = {**dict.fromkeys(material, 0.0), "frictionAngle": material["frictionAngle"]}
    answer = yade_dem.run(
        command,
        {
            **yade_dem.geometry(packing(), TIME_STEP), "disk": material, "wall": nothing, "weight": 0.0,
            "velocity": incoming().tolist(), "stages": [round(TIME / TIME_STEP)], "load": None,
        },
    )  # fmt: skip
    return After(np.array(answer["velocity"]), np.array(answer["spin"]))


def sliding(after: After) -> np.ndarray:
    """Energies (n,) of disks that slide all the time and leave with the speeds along the normal that these have."""
    before = incoming()
    impulse = FRICTION * (after.velocity[:, 1] - before[:, 1])
    along = before[:, 0] - impulse
    return along**2 + after.velocity[:, 1] ** 2 + impulse**2 / INERTIA


def energy(after: After) -> np.ndarray:
    """Energies (n,) over those before."""
    return (after.velocity**2).sum(axis=1) + INERTIA * after.spin**2
