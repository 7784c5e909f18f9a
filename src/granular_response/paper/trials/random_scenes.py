"""Random scenes, solved as a user would, and every result checked from its positions alone.

A scene is drawn from the whole of what a scene file may say: packing, contact law, walls, loads, method and
integrator. It has one of the outcomes of :data:`OUTCOMES`; ``wrong`` is a result that the audit contradicts or an
error that a user would not understand, and must never happen.
"""

from __future__ import annotations

import csv
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from granular_response.paper.trials.audit import Audit, ContactRule, audit
from granular_response.scene import Scene, SceneError
from granular_response.solve import SOLVE_ERRORS, Solution, solve_scene
from granular_response.solve.choice import finishes_statically
from granular_response.state import State

#: Certified: in balance and stable. Uncertified: the scene asked for no static finish, and the certificate says what
#: is left. The others are errors of one line: which, is stored beside.
OUTCOMES = ("certified", "uncertified", "not settled", "no equilibrium", "time step refused", "scene refused", "wrong")
#: Largest unbalanced force of a certified state, and largest excess over Coulomb's limit (mean disk weights).
BALANCE, COULOMB = 1e-8, 1e-8

_ERRORS = {
    "NotSettled": "not settled",
    "DynamicsError": "not settled",
    "PathError": "no equilibrium",
    "EquilibriumError": "no equilibrium",
    "Rearranged": "no equilibrium",
    "UnstableTimeStep": "time step refused",
    "SceneError": "scene refused",
}


@dataclass(frozen=True)
class Trial:
    """What became of one scene; the numbers are those of its worst state, NaN after an error."""

    outcome: str
    message: str  #: of the error, or what is wrong
    kind: str  #: packing
    method: str  #: asked for
    integrator: str
    friction: float
    disks: int
    states: int  #: how many were checked
    force_residual: float
    torque_residual: float
    coulomb_excess: float


def draw(generator: np.random.Generator, maximum_steps: int) -> tuple[dict[str, Any], np.ndarray | None]:
    """A scene as nested dicts, and the table (n, 3) of its disks if these come from a file."""
    g = generator
    packing: dict[str, Any]
    table = None
    kind = str(g.choice(["slab", "slab", "pile", "file"]))
    if kind == "file":
        table, width = _heap(g)
        packing = {"kind": "file", "path": "packing.csv", "width": width}
    else:
        packing = {"kind": kind, "layers": int(g.integers(2, 6 if kind == "slab" else 5))}
        if kind == "slab":
            packing["disks_per_row"] = int(g.integers(3, 12))
        packing["polydispersity"] = float(g.choice([0.0, 0.0, 1e-3, 0.05, 0.25, 0.5]))
        packing["lattice_constant"] = [2.0, 2.0, "touching-largest"][g.integers(3)]
        packing["seed"] = int(g.integers(1000))
    ratio = float(g.choice([0.0, 0.1, 0.5, 0.8, 1.0, 2.0]))
    contact = {
        "normal_stiffness": _log_uniform(g, 1e2, 1e4) if g.random() < 0.8 else _log_uniform(g, 1e4, 1e6),
        "stiffness_ratio": ratio,
        "friction": _friction(g),
        "damping_ratio": float(g.choice([0.5, g.uniform(0.1, 2.0), 0.0, 2.0], p=[0.7, 0.24, 0.02, 0.04])),
    }
    wall: dict[str, Any] = {"friction": _friction(g)}
    if g.random() < 0.3:
        wall["normal_stiffness"] = contact["normal_stiffness"] * _log_uniform(g, 0.2, 5.0)
    if table is None:
        disks = Scene.from_dict({"packing": packing, "loads": []}).packing.build().n
    else:
        disks = len(table)
    turns = max(contact["friction"], wall["friction"]) > 0 or g.random() < 0.1
    loads = [_load(g, disks, turns) for _ in range(int(g.choice([0, 0, 1, 1, 1, 2])))]
    protocol = {
        "method": str(g.choice(["auto", "auto", "dynamics", "path", "minimise"], p=[0.4, 0.2, 0.2, 0.15, 0.05])),
        "integrator": str(g.choice(["beeman", "verlet", "gear"])),
        "time_step": "auto" if g.random() < 0.9 else _log_uniform(g, 1e-5, 1e-2),
        "ramp_time": float(g.choice([0.0, 1.0, 5.0])),
        "stop_kinetic_energy": float(g.choice([1e-9, 1e-11, 1e-13])),
        "stop_rule": str(g.choice(["instantaneous", "instantaneous", "envelope"])),
        "static_finish": bool(g.random() < 0.9),
        "friction_law": "literal" if g.random() < 0.05 else "cut",
        "tensile_dashpot": bool(g.random() < 0.8),
        "maximum_steps": maximum_steps,
    }
    gravity = str(g.choice(["at-once", "slow", "frictionless"], p=[0.8, 0.1, 0.1]))
    preparation = {"gravity": gravity, "ramp_time": 5.0}
    scene = {"packing": packing, "contact": contact, "wall": wall, "loads": loads, "preparation": preparation}
    return scene | {"protocol": protocol}, table


def _log_uniform(g: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(g.uniform(np.log(low), np.log(high))))


def _friction(g: np.random.Generator) -> float:
    """None, moderate, or anything up to 100."""
    return [0.0, float(g.uniform(0.05, 1.0)), _log_uniform(g, 0.01, 100.0)][int(g.choice(3, p=[0.35, 0.45, 0.2]))]


def _load(g: np.random.Generator, disks: int, turns: bool) -> dict[str, Any]:
    """A force of any direction, mostly downwards, and sometimes a torque, on any disk, mostly the middle of the top."""
    size = _log_uniform(g, 0.01, 5.0) if g.random() < 0.8 else _log_uniform(g, 5.0, 50.0)
    angle = float(g.normal(-0.5 * np.pi, 0.5)) if g.random() < 0.9 else float(g.uniform(0.0, 2.0 * np.pi))
    disk: Any = "top-centre" if g.random() < 0.7 else int(g.integers(disks))
    torque = 0.0 if g.random() < 0.7 or not turns else float(g.normal(0.0, 0.3 * size))
    force = [0.0, 0.0] if torque and g.random() < 0.1 else [size * float(np.cos(angle)), size * float(np.sin(angle))]
    return {"disk": disk, "force": force, "torque": torque}


def _heap(g: np.random.Generator) -> tuple[np.ndarray, float]:
    """Disks thrown into a box at random so that none overlap, x, z, radius, and the width of the box."""
    n = int(g.integers(5, 35))
    spread = float(g.choice([0.0, 0.2, 0.5]))
    width = float(g.uniform(6.0, 20.0))
    placed: list[tuple[float, float, float]] = []
    while len(placed) < n:
        r = float(g.uniform(1.0 - spread, 1.0)) if spread else 1.0
        x = float(g.uniform(r, width - r))
        z = r
        while any((x - a) ** 2 + (z - b) ** 2 < (r + c) ** 2 for a, b, c in placed):
            z += 0.25
        placed.append((x, z, r))
    return np.array(placed), width


def run(maximum_steps: int, entropy: int, index: int) -> Trial:
    """Draw, solve and check scene ``index`` of the sequence that ``entropy`` seeds."""
    generator = np.random.default_rng(np.random.SeedSequence(entropy, spawn_key=(index,)))
    description, table = draw(generator, maximum_steps)
    factors = [1.0] if generator.random() < 0.7 else sorted(float(f) for f in generator.uniform(0.1, 1.5, 3))
    with tempfile.TemporaryDirectory() as folder:
        if table is not None:
            with Path(folder, "packing.csv").open("w", newline="") as stream:
                csv.writer(stream).writerows([("x", "z", "radius"), *table.tolist()])
        return attempt(description, factors, folder)


def attempt(description: dict[str, Any], factors: list[float], folder: str) -> Trial:
    """Solve a scene and check what comes out."""
    states: list[State] = []
    checks: list[Audit] = []
    outcome, message = "certified", ""
    disks = 0
    try:
        scene = Scene.from_dict(description, folder=folder)
        solution = solve_scene(scene, load_factors=factors)
    except (SceneError, *SOLVE_ERRORS) as error:
        outcome, message = _ERRORS[type(error).__name__], str(error)
        if not message or "\n" in message:
            outcome, message = "wrong", f"the error is not one line: {message!r}"
    except Exception as error:  # whatever else comes out is a bug
        outcome, message = "wrong", f"{type(error).__name__}: {error}"
    else:
        disks = solution.problem.n
        states = [solution.rest, *solution.loaded]
        checks = [check(solution, state) for state in states]
        for state, found in zip(states, checks, strict=True):
            wrong = contradiction(state, found, rounding_of(solution))
            if wrong:
                outcome, message = "wrong", wrong
                break
            certificate = state.certificate
            if not certificate.stable or found.force_residual > BALANCE + rounding_of(solution):
                outcome = "uncertified"
        if outcome == "uncertified" and finishes_statically(solution.problem):
            outcome, message = "wrong", "a state that is not certified"

    def worst(name: str) -> float:
        return max((float(getattr(found, name)) for found in checks), default=float("nan"))

    return Trial(
        outcome, message, description["packing"]["kind"], description["protocol"]["method"],
        description["protocol"]["integrator"], description["contact"]["friction"], disks, len(states),
        worst("force_residual"), worst("torque_residual"), worst("coulomb_excess"),
    )  # fmt: skip


def check(solution: Solution, state: State) -> Audit:
    """The audit of one state of a solution, with laws and loads taken from the scene itself."""
    scene, packing = solution.scene, solution.problem.packing
    wall = scene.resolved_wall
    load = np.zeros((packing.n, 3))
    for disk, one in zip(solution.problem.load_disk, scene.loads, strict=False):
        load[disk] += state.load_factor * np.array([*one.force, one.torque])

    def rule(law) -> ContactRule:
        friction = law.friction if law.stiffness_ratio > 0 else 0.0
        return ContactRule(law.normal_stiffness, law.stiffness_ratio * law.normal_stiffness, friction)

    return audit(state, packing.radius, packing.mass, packing.width, rule(scene.contact), rule(wall), load)


def rounding_of(solution: Solution) -> float:
    """Force that a last digit of a position is worth: solvers know displacements, an audit only their sums."""
    stiffest = max(solution.problem.pair_law.normal_stiffness, solution.problem.wall_law.normal_stiffness)
    return 16.0 * np.finfo(float).eps * stiffest * float(solution.problem.packing.position.max())


def contradiction(state: State, found: Audit, rounding: float) -> str:
    """What the audit finds that the state's certificate does not say; empty if nothing."""
    certificate = state.reached.certificate
    if certificate is None:
        return "a state without a certificate"
    for name in ("force_residual", "torque_residual", "coulomb_excess"):
        said, true = getattr(certificate, name), getattr(found, name)
        if abs(said - true) > rounding + 1e-6 * abs(true):
            return f"{name} is {true:.3g}, the certificate says {said:.3g}"
    if found.force_mismatch > rounding:
        return f"a recorded contact force is off by {found.force_mismatch:.3g}"
    for name in ("unlisted", "stale_springs", "escaped"):
        if getattr(found, name):
            return f"{getattr(found, name)} {name.replace('_', ' ')}"
    if certificate.stable and max(found.force_residual, found.torque_residual) > BALANCE + rounding:
        return f"certified as stable with an unbalanced force of {found.force_residual:.3g}"
    if certificate.stable and found.coulomb_excess > COULOMB + rounding:
        return f"certified with a friction force {found.coulomb_excess:.3g} beyond Coulomb's limit"
    return ""
