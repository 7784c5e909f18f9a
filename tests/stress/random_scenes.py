"""Random scenes, solved as a user would, and every result checked from its positions alone.

A scene is drawn from the whole of what a scene file may say: packing, contact law, walls, loads, method and
integrator. It has one of the outcomes of :data:`OUTCOMES`; ``wrong`` is a result that the audit contradicts or an
error that a user would not understand, and must never happen. A sample is compared with its twins.
"""

from __future__ import annotations

import csv
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from audit import Audit, ContactRule, audit

from granular_response.errors import SolveError
from granular_response.observe.floor import floor_force
from granular_response.scene import Load, Scene, SceneError
from granular_response.solvers.solution import Solution, solve_scene
from granular_response.state import State
from granular_response.studies import lost

#: Certified: in balance and stable. Uncertified: the scene asked for no static finish, and the certificate says what
#: is left. The others are errors of one line: which, is stored beside.
OUTCOMES = ("certified", "uncertified", "not settled", "no equilibrium", "time step refused", "scene refused", "wrong")
#: Largest unbalanced force of a certified state, and largest excess over the limits of friction and of rolling
#: resistance (mean disk weights).
BALANCE, COULOMB = 1e-8, 1e-8
#: Largest unbalanced force of a disk in a certified state, as a part of what this disk bears.
RELATIVE = 1e-6
#: One scene in so many is compared with its twin, where both rest states agree within ``SAME_REST`` (mean disk weights)
#: on the floor: responses are then the same within ``TWINS`` of the load.
TWIN_EVERY, SAME_REST, TWINS = 4, 1e-6, 1e-4
#: Part by which x is changed to see whether a last digit turns the motion aside: the response then changes by more than
#: ``TURNED`` of the load, and there is nothing to compare.
LAST_DIGIT, TURNED = 1e-15, 1e-6
#: Stiffnesses (weights per radius) from soft to nearly rigid.
STIFFNESS = ((1.0, 1e2), (1e2, 1e4), (1e4, 1e6), (1e6, 1e9))
METHODS = ("auto", "dynamics", "path", "minimise")
#: Part of the scenes that are drawn with resistance to rolling, if their contacts rub.
ROLLS = 0.5
#: What a mirror turns over along x in a load.
_VECTORS = ("force", "displacement")
#: Least time of a fall over that of the closed form.
FALL_ROOM = 0.9

#: Draws disks, (n, 3) or (n, 4) as :func:`write_table` has them, and the width of their box.
Heap = Callable[[np.random.Generator], tuple[np.ndarray, float]]

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
    """What became of one scene."""

    outcome: str
    message: str  #: of the error, or what is wrong
    rolls: bool  #: whether contacts between disks or at walls resist rolling
    states: int  #: that were checked
    force_residual: float  #: largest unbalanced force of any state (mean disk weights), NaN after an error
    twin_difference: float  #: largest difference of floor responses to the mirrored twin, over the load; or NaN


def draw(
    generator: np.random.Generator, maximum_steps: int, *, heap: Heap | None = None
) -> tuple[dict[str, Any], np.ndarray | None]:
    """A scene as nested dicts, and the table (n, 3) or, with masses, (n, 4) of its disks if these come from a file.

    With a ``heap``, of what it draws, and always from a file.
    """
    g = generator
    packing: dict[str, Any]
    table = None
    kind = str(g.choice(["slab", "slab", "pile", "file"]))
    if kind == "file" or heap:
        kind = "file"
        table, width = (heap or _heap)(g)
        packing = {"kind": "file", "path": "packing.csv", "width": width}
    else:
        packing = {"kind": kind, "layers": int(g.integers(1, 6 if kind == "slab" else 5))}
        if kind == "slab":
            packing["disks_per_row"] = int(g.integers(3, 12))
        packing["polydispersity"] = float(g.choice([0.0, 0.0, 1e-3, 0.05, 0.25, 0.5]))
        packing["lattice_constant"] = [2.0, 2.0, "touching-largest"][g.integers(3)]
        packing["seed"] = int(g.integers(1000))
    if kind != "pile" and g.random() < 0.2:
        packing["sides"] = "periodic"
        if kind == "slab":
            packing["disks_per_row"] = max(packing["disks_per_row"], 5)
    ratio = float(g.choice([0.0, 0.1, 0.5, 0.8, 1.0, 2.0]))
    stiffness = log_uniform(g, *STIFFNESS[int(g.choice(4, p=[0.1, 0.6, 0.2, 0.1]))])
    contact = {
        "law": "hertz" if g.random() < 0.2 else "linear",
        "normal_stiffness": stiffness,
        "stiffness_ratio": ratio,
        "friction": _friction(g),
        "damping_ratio": float(g.choice([0.5, g.uniform(0.1, 2.0), 0.0, 2.0], p=[0.7, 0.24, 0.02, 0.04])),
    }
    wall: dict[str, Any] = {"friction": _friction(g)}
    if g.random() < 0.3:
        wall["normal_stiffness"] = stiffness * log_uniform(g, 0.2, 5.0)
    if table is None:
        walled = {key: value for key, value in packing.items() if key != "sides"}
        disks = Scene.from_dict({"packing": walled, "loads": []}).packing.build().n
    else:
        disks = len(table)
    turns = max(contact["friction"], wall["friction"]) > 0 or g.random() < 0.1
    loads = [_load(g, disks, turns) for _ in range(int(g.choice([0, 0, 1, 1, 1, 2])))]
    protocol = {
        "method": str(g.choice(METHODS, p=[0.5, 0.2, 0.25, 0.05])),
        "load_factors": _programme(g),
        "integrator": str(g.choice(["beeman", "verlet", "gear"])),
        "time_step": ["auto", None, log_uniform(g, 1e-7, 1e-2)][int(g.choice(3, p=[0.8, 0.1, 0.1]))],
        "ramp_time": float(g.choice([0.0, 1.0, 5.0])),
        "stop_kinetic_energy": float(g.choice([1e-9, 1e-11, 1e-13])),
        "stop_rule": str(g.choice(["instantaneous", "instantaneous", "envelope"])),
        "static_finish": bool(g.random() < 0.9),
        "friction_law": "literal" if g.random() < 0.05 else "cut",
        "tensile_dashpot": bool(g.random() < 0.8),
        "maximum_steps": maximum_steps,
    }
    gravity = str(g.choice(["at-once", "slow", "frictionless"], p=[0.7, 0.15, 0.15]))
    preparation = {"gravity": gravity, "ramp_time": 5.0}
    if g.random() < 0.25:
        protocol["integrator"] = "leapfrog"
    if g.random() < 0.05:
        protocol["friction_law"] = "unloading"
    if heap and g.random() < 0.8:  # else light disks take steps so short that nothing settles
        protocol["time_step"] = "auto"
        contact["normal_stiffness"] = log_uniform(g, 10.0, 1e4)
        wall.pop("normal_stiffness", None)
    if g.random() < ROLLS and ratio > 0.0:
        contact |= _rolling(g, contact["friction"])
        wall |= _rolling(g, wall["friction"])
        if contact["friction"] > 0.0 and wall["friction"] > 0.0 and g.random() < 0.5:
            del wall["rolling_stiffness_ratio"]  # as between disks
    scene = {"packing": packing, "contact": contact, "wall": wall, "loads": loads, "preparation": preparation}
    return scene | {"protocol": protocol}, table


def rolls(description: dict[str, Any]) -> bool:
    """Whether contacts of a scene resist rolling."""
    return any(description.get(kind, {}).get("rolling_friction", 0.0) > 0.0 for kind in ("contact", "wall"))


def log_uniform(g: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(g.uniform(np.log(low), np.log(high))))


def _programme(g: np.random.Generator) -> list[float]:
    """Load factors: mostly one, else growing, or any: falling, zero and repeated ones, and sometimes a reversal."""
    kind = int(g.choice(3, p=[0.6, 0.2, 0.2]))
    if kind == 0:
        return [1.0]
    if kind == 1:
        return sorted(float(f) for f in g.uniform(0.1, 1.5, 3))
    return [float(f) for f in g.choice([0.0, 0.25, 0.5, 1.0, 1.0, 1.5, -0.25], int(g.integers(2, 6)))]


def _friction(g: np.random.Generator) -> float:
    """None, moderate, or anything up to 100."""
    return [0.0, float(g.uniform(0.05, 1.0)), log_uniform(g, 0.01, 100.0)][int(g.choice(3, p=[0.35, 0.45, 0.2]))]


def _rolling(g: np.random.Generator, friction: float) -> dict[str, float]:
    """Resistance to rolling of contacts that rub, of one kind in five none: hardly any to all that can be."""
    limit = log_uniform(g, 1e-3, 10.0) if g.random() < 0.8 and friction > 0.0 else 0.0
    return {"rolling_friction": limit, "rolling_stiffness_ratio": log_uniform(g, 0.01, 2.0)}


def _load(g: np.random.Generator, disks: int, turns: bool) -> dict[str, Any]:
    """A force of any direction, mostly downwards, and sometimes a torque, on any disk, mostly the middle of the top."""
    size = log_uniform(g, 0.01, 5.0) if g.random() < 0.8 else log_uniform(g, 5.0, 50.0)
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
    return thrown(g, n, width, lambda: float(g.uniform(1.0 - spread, 1.0)) if spread else 1.0), width


def thrown(g: np.random.Generator, n: int, width: float, radius: Callable[[], float]) -> np.ndarray:
    """(n, 3) disks, each as high as it must be to overlap none before it."""
    placed: list[tuple[float, float, float]] = []
    while len(placed) < n:
        r = radius()
        x = float(g.uniform(r, width - r))
        z = r
        while any((x - a) ** 2 + (z - b) ** 2 < (r + c) ** 2 for a, b, c in placed):
            z += 0.25
        placed.append((x, z, r))
    return np.array(placed)


def run(maximum_steps: int, entropy: int, index: int, *, heap: Heap | None = None) -> Trial:
    """Draw, solve and check scene ``index`` of the sequence that ``entropy`` seeds; ``heap`` as in :func:`draw`."""
    generator = np.random.default_rng(np.random.SeedSequence(entropy, spawn_key=(index,)))
    description, table = draw(generator, maximum_steps, heap=heap)
    with tempfile.TemporaryDirectory() as folder:
        if table is not None:
            write_table(Path(folder, "packing.csv"), table)
        return attempt(description, folder, twin=index % TWIN_EVERY == 0)


def write_table(path: Path, table: np.ndarray) -> None:
    """Disks (n, 3) or (n, 4) as a table that a scene reads: x, z, radius, mass."""
    with path.open("w", newline="") as stream:
        csv.writer(stream).writerows([("x", "z", "radius", "mass")[: table.shape[1]], *table.tolist()])


def attempt(description: dict[str, Any], folder: str, *, twin: bool = False) -> Trial:
    """Solve a scene and check what comes out; ``twin``: compare it with its twin too."""
    checks: list[Audit] = []
    outcome, message, difference = "certified", "", float("nan")
    try:
        scene = Scene.from_dict(description, folder=folder)
        solution = solve_scene(scene)
        if twin:
            difference = twin_difference(description, solution, folder)
    except (SceneError, SolveError) as error:
        outcome, message = _ERRORS[type(error).__name__], str(error)
        if not message or "\n" in message:
            outcome, message = "wrong", f"the error is not one line: {message!r}"
    except Exception as error:  # whatever else comes out is a bug
        outcome, message = "wrong", f"{type(error).__name__}: {error}"
    else:
        states = [solution.rest, *solution.loaded]
        checks = [check(solution, state) for state in states]
        asked = [0.0, *scene.protocol.load_factors]
        for state, found, factor in zip(states, checks, asked, strict=False):
            wrong = contradiction(state, found, rounding_of(solution)) or anachronism(solution, state, found, factor)
            if wrong:
                outcome, message = "wrong", wrong
                break
            certificate = state.certificate
            if not certificate.stable or found.force_residual > BALANCE + rounding_of(solution):
                outcome = "uncertified"
        if outcome == "uncertified" and solution.problem.plan.static:
            outcome, message = "wrong", "a state that is not certified"
        if difference > TWINS:
            outcome, message = "wrong", f"the response of the twin differs by {difference:.3g} of the load"
    residual = max((found.force_residual for found in checks), default=float("nan"))
    return Trial(outcome, message, rolls(description), len(checks), residual, difference)


def check(solution: Solution, state: State) -> Audit:
    """The audit of one state of a solution, with laws and loads taken from the scene itself."""
    scene, packing = solution.scene, solution.problem.packing
    wall = scene.resolved_wall
    load = np.zeros((packing.n, 3))
    for disk, one in zip(solution.problem.load_disk, scene.loads, strict=False):
        load[disk] += state.load_factor * np.array([*one.force, one.torque])
    np.add.at(load[:, :2], solution.problem.load_disk, solution.reaction(state))

    def rule(law, reference: float) -> ContactRule:
        friction = law.friction if law.stiffness_ratio > 0 else 0.0
        power = 1.5 if law.law == "hertz" else 1.0
        tangential = law.stiffness_ratio * law.normal_stiffness
        rolling = (law.rolling_stiffness, law.rolling_friction)
        return ContactRule(law.normal_stiffness, tangential, friction, power, reference, *rolling)

    # reduced radii of two mean disks, and of one at a wall
    pair, wall_rule = rule(scene.contact, 0.5), rule(wall, 1.0)
    return audit(
        state, packing.radius, packing.mass, packing.width, pair, wall_rule, load,
        periodic=packing.periodic, rounding=rounding_of(solution),
    )  # fmt: skip


def rounding_of(solution: Solution) -> float:
    """Force that a last digit of a position is worth: solvers know displacements, an audit only their sums."""
    scene, states = solution.scene, (solution.rest, *solution.loaded)
    stiffest = max(scene.contact.normal_stiffness, scene.resolved_wall.normal_stiffness)
    if scene.contact.law == "hertz":  # stiffer under more than a weight, and between large disks
        largest = max(float(c.normal_force.max(initial=1.0)) for s in states for c in (s.pairs, s.walls))
        stiffest *= 2.0 * max(1.0, largest) ** (1.0 / 3.0)
    far = max(float(np.abs(s.position).max()) for s in states)
    return 16.0 * np.finfo(float).eps * stiffest * max(far, float(solution.problem.packing.position.max()))


def anachronism(solution: Solution, state: State, found: Audit, factor: float) -> str:
    """What a state claims to be that its history rules out; empty if nothing.

    ``factor`` : load factor that was asked for. A state at rest has it, and no disk of it is in flight. Nothing but
    gravity pulls the centre of mass down, so its fall to the rest state takes ``sqrt(2 h / g)`` at least; friction
    of the side walls and dashpots that pull are left some room.
    """
    reached = state.reached
    if reached.settled is not False and state.load_factor != factor:
        return f"load factor {state.load_factor:.17g} in place of {factor:.17g}, said to be at rest"
    if found.in_flight and (reached.settled or state.certificate.stable):
        return f"{found.in_flight} disks in flight, said to be at rest"
    if state is solution.rest and reached.settled and reached.steps is not None and reached.time_step is not None:
        packing = solution.problem.packing
        fall = float(packing.mass @ (packing.position - state.position)[:, 1]) / packing.n
        passed = reached.steps * reached.time_step
        # statics may press contacts together that dynamics left nearly at rest
        fall -= max((float(c.overlap.max(initial=0.0)) for c in (state.pairs, state.walls)), default=0.0)
        if passed < FALL_ROOM * np.sqrt(2.0 * max(fall, 0.0)) and not reached.more_relaxations:
            return f"said to have fallen by {fall:.3g} within a time of {passed:.3g}"
    return ""


def twin_difference(description: dict[str, Any], solution: Solution, folder: str) -> float:
    """Largest difference of floor responses between a scene and its twin, over the load; NaN if not comparable.

    Both are tables of the scene's disks; the twin's are mirrored, in another order and another unit of length. Where
    the motion ends elsewhere for a last digit, at rest or after a lost equilibrium, there is nothing to compare.
    """
    packing, scene = solution.problem.packing, solution.scene
    if not solution.loaded:
        return float("nan")
    order = np.random.default_rng(packing.n).permutation(packing.n)
    place = np.argsort(order)
    unit, masses = 3.75, [] if packing.given_mass is None else [packing.given_mass]
    mirror = [packing.width - packing.position[:, 0], packing.position[:, 1]]
    table = np.column_stack([packing.position, packing.radius, *masses])
    mirrored = np.column_stack([*(unit * column for column in (*mirror, packing.radius)), *masses])
    nudged = table * np.array([1.0 + LAST_DIGIT, *np.ones(table.shape[1] - 1)])
    found: list[list[np.ndarray]] = []
    for disks, width, where, sign in (
        (table, packing.width, np.arange(packing.n), 1.0),
        (mirrored[order], unit * packing.width, place, -1.0),
        (nudged, packing.width, np.arange(packing.n), 1.0),
    ):
        write_table(Path(folder, "twin.csv"), disks)
        sides = "periodic" if packing.periodic else "walls"
        loads = [
            {"disk": int(where[disk]), **_mirrored(load, sign)}
            for disk, load in zip(solution.problem.load_disk, scene.loads, strict=True)
        ]
        file = {"kind": "file", "path": "twin.csv", "width": float(width), "sides": sides}
        try:
            one = solve_scene(Scene.from_dict(description | {"packing": file, "loads": loads}, folder=folder))
        except (SceneError, SolveError):
            return float("nan")
        states = (one.rest, *one.loaded)
        if lost(states) or not all(state.certificate.stable for state in states):
            return float("nan")
        found.append([floor_force(state, where) for state in states])
    first, twin, near = found
    if np.abs(first[0] - twin[0]).max() > SAME_REST:
        return float("nan")
    response, turned = (
        max(np.abs((a - first[0]) - (b - other[0])).max() for a, b in zip(first[1:], other[1:], strict=True))
        for other in (twin, near)
    )
    largest = max(abs(factor) for factor in scene.protocol.load_factors)
    size = max(solution.applied_force(state) for state in solution.loaded)
    size += largest * sum(abs(load.torque) for load in scene.loads)
    if not size or turned > TURNED * size:
        return float("nan")
    return float(response) / size


def _mirrored(load: Load, sign: float) -> dict[str, Any]:
    """A load in a packing as it is (``sign`` 1) or mirrored (-1), its disk left out."""
    both = {name: value and (value[0] and sign * value[0], value[1]) for name, value in load if name in _VECTORS}
    return {**both, "torque": sign * load.torque}


def contradiction(state: State, found: Audit, rounding: float) -> str:
    """What the audit finds that the state's certificate does not say; empty if nothing."""
    certificate = state.reached.certificate
    if certificate is None:
        return "a state without a certificate"
    for name in ("force_residual", "torque_residual", "coulomb_excess", "rolling_excess"):
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
    if certificate.stable and found.relative_residual > RELATIVE:
        return f"certified as stable with a disk out of balance by {found.relative_residual:.3g} of what it bears"
    for name, what in (("coulomb_excess", "friction force"), ("rolling_excess", "force along the rolling")):
        if certificate.stable and getattr(found, name) > COULOMB + rounding:
            return f"certified with a {what} {getattr(found, name):.3g} beyond its limit"
    return ""
