"""Accuracy of load paths against paths cut into small increments; with it the time of the paper's slab at nine points.

`python benchmarks/exactness.py OUTPUT.json`. Three kinds of scenes: the paper's slab at nine pairs of friction and
force, 200 packings of at most 60 disks under loads of all sizes, 40 slabs of 8 to 15 layers. Scenes that OUTPUT.json
has are kept. An error is the largest difference of a component of a force of the floor or a wall, per load.

The reference solves each increment with the return map (:func:`.solve_increment`), which knows no events. What changes
inside an increment leaves an error there, by how far the increment goes beyond it: plain increments are less exact than
the path, as ``plain`` and ``plain_twice`` (increments of twice the length) show. So the increments of ``error`` end
also where the path has an event; a change that the path has missed lies within an increment all the same, and is seen.
Where an increment finds no equilibrium the path from event to event leads over it (``by_events`` counts them).
"""

from __future__ import annotations

import itertools
import os
import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from timing import floor, least, stored, write
from timing import scene as paper

from granular_response.errors import SolveError
from granular_response.machine.threads import cores
from granular_response.scene import Scene
from granular_response.solvers.equilibrium import external_force
from granular_response.solvers.increment import Work, solve_increment
from granular_response.solvers.path import PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states, rest_state
from granular_response.solvers.system import StaticSystem
from granular_response.state import State

#: Least length of an increment (mean weights), and how many a reference has at most: in all scenes, and in those of the
#: paper's slab whose increments cost a millisecond; with less friction they cost ten.
INCREMENT, MOST, MOST_OF_SLAB = 1e-3, 250, 1_000
#: Part of the load by which ends of increments are apart at least.
APART = 1e-10
#: Displacement (mean radii) after which candidates of the reference are listed again.
LISTED_AGAIN = 0.1
#: Points after which a path is given up: the paper's slab has up to 1,700.
MOST_POINTS = 4_000
#: Error per load up to which a path counts as exact.
EXACT = 1e-8
#: The shortest ramp takes the least time: where the path is sooner than it, it is sooner at any error.
DYNAMICS: dict[str, Any] = {
    "method": "dynamics", "integrator": "leapfrog", "time_step": 1.4e-3, "ramp_time": 1.0,
    "stop_kinetic_energy": 1e-9, "static_finish": True,
}  # fmt: skip
#: Scenes of a kind.
COUNTS = {"nine points": 9, "small": 200, "slabs": 40}
#: Runs of which the least time counts, and seconds after which none is repeated.
REPEATS, LONG = 3, 1.0
#: What happens to an equilibrium, the gravest last.
LOSSES = ("stepped over", "jump", "bifurcation")


def nine_points() -> Iterator[Scene]:
    """The paper's slab under nine pairs of friction and force."""
    for friction in (0.2, 1.0, 0.05):
        for force in (4.0, 15.0, 50.0):
            yield paper(friction, force, method="path")


def small() -> Iterator[Scene]:
    """Packings of at most 60 disks with loads of all sizes."""
    for k in range(COUNTS["small"]):
        random = np.random.default_rng(np.random.SeedSequence([37, k]))
        rows = int(random.integers(2, 6))
        size = float(10.0 ** random.uniform(-2.0, 1.3))
        angle = float(random.uniform(-0.6, 0.6))
        yield scene(random, rows, int(random.integers(5, 60 // rows)), size, angle)


def slabs() -> Iterator[Scene]:
    """Slabs of 8 to 15 layers: order and disorder, walls and periodic sides, both laws."""
    for k in range(COUNTS["slabs"]):
        random = np.random.default_rng(np.random.SeedSequence([38, k]))
        layers = int(random.integers(8, 16))
        yield scene(random, layers, 4 * layers + 1, float(random.choice([2.0, 5.0, 12.0])), 0.0)


def scene(random: np.random.Generator, layers: int, across: int, size: float, angle: float) -> Scene:
    """A scene with a load of ``size`` mean weights at an ``angle`` from the vertical."""
    disorder = float(random.choice([0.0, 0.01, 0.1, 0.25]))
    packing: dict[str, Any] = {"kind": "slab", "layers": layers, "disks_per_row": across}
    if disorder:
        packing |= {"polydispersity": disorder, "lattice_constant": "touching-largest"}
        packing |= {"seed": int(random.integers(1000))}
    if random.random() < 0.4:
        packing["sides"] = "periodic"
    law = str(random.choice(["linear", "hertz"]))
    friction = float(random.choice([0.05, 0.2, 0.5, 1.0]))
    wall = float(random.choice([0.0, friction]))
    if "sides" in packing and wall == 0.0:
        angle = 0.0  # nothing holds the packing along x
    return Scene.from_dict(
        {
            "packing": packing,
            "contact": {"friction": friction, "law": law},
            "wall": {"friction": wall},
            "loads": [{"disk": "top-centre", "force": [size * np.sin(angle), -size * np.cos(angle)]}],
            "protocol": {"integrator": "leapfrog", "time_step": "auto"},
        }
    )


SCENES = {"nine points": nine_points, "small": small, "slabs": slabs}


def measure(kind: str, k: int, given: Scene) -> dict[str, Any]:
    """How far the path is off, and what happened on the way."""
    packing, contact = given.packing.model_dump(), given.contact
    found: dict[str, Any] = {"kind": kind, "scene": k, "friction": contact.friction, "law": contact.law}
    found |= {"polydispersity": packing.get("polydispersity", 0.0), "sides": packing.get("sides", "walls")}
    try:
        problem = Problem.from_scene(given)
        rest = rest_state(problem)
        problem = problem.with_loads(rest.position)
        load = problem.load_size
        found |= {"disks": problem.n, "load": load}
        (path, record), used = least(lambda: loaded(problem, rest), REPEATS if kind == "nine points" else 1, LONG)
        found |= {"seconds": used["processor"], "events": len(record.events), "lost": lost(record)}
        most = MOST_OF_SLAB if kind == "nine points" and contact.friction > 0.1 else MOST
        count = min(most, int(np.ceil(load / INCREMENT)))
        found["increment"] = load / count
        equal = np.linspace(0.0, 1.0, count + 1)[1:]
        ends = np.union1d(equal, [event.load_factor for event in record.events if event.load_factor > 0.0])
        state, others, found["by_events"] = increments(problem, rest, ends[np.diff(ends, append=2.0) > APART])
        found |= {"lost_by_increments": lost(others), "error": difference(path, state) / load}
        if not lost(record) and not lost(others):
            for name, ends in (("plain", equal), ("plain_twice", np.union1d(equal[1::2], 1.0))):
                found[name] = difference(path, increments(problem, rest, ends)[0]) / load
        if kind == "nine points":
            found |= moved(rest, path, contact.friction, load)
    except SolveError as error:
        found["failed"] = str(error)
    return found


def loaded(problem: Problem, rest: State) -> tuple[State, PathRecord]:
    """The loaded state by the path, and what happened."""
    record, points = PathRecord(), itertools.count()

    def progress(_: float) -> None:
        if next(points) >= MOST_POINTS:
            raise SolveError(f"more than {MOST_POINTS} points")

    return follow(problem, rest, [1.0], together=0.0, record=record, progress=progress)[0], record


def increments(problem: Problem, rest: State, ends: np.ndarray) -> tuple[State, PathRecord, int]:
    """The loaded state by increments that end at load factors ``ends``; how many had to go from event to event.

    The record has what happened to equilibria in those.
    """
    record, by_events = PathRecord(), 0
    system = StaticSystem(problem, rest)
    last, before, rate = system.at(rest), rest.load_factor, 0.0
    for factor in ends:
        known = last.configuration
        guess = known.q + (factor - before) * rate
        trial = solve_increment(system, known, external_force(problem, factor), guess, Work())
        if trial is None or system.meets_unlisted(trial.configuration.q):
            by_events += 1
            state = follow(problem, system.state(last, before), [factor], together=0.0, record=record)[0]
        else:
            rate = (trial.configuration.q - known.q) / (factor - before)
            last, before = trial, factor
            if np.abs(trial.configuration.q[: 2 * problem.n]).max() <= LISTED_AGAIN:
                continue
            state = problem.relisted(system.state(trial, factor))
        system = StaticSystem(problem, state)
        last, before, rate = system.at(state), factor, 0.0
    return system.state(last, before), record, by_events


def moved(rest: State, path: State, friction: float, force: float) -> dict[str, float]:
    """Processor time of dynamics from rest to a point of the paper's slab, and the error of its floor response."""
    problem = Problem.from_scene(paper(friction, force, **DYNAMICS)).with_loads(rest.position)
    state, used = least(lambda: loaded_states(problem, rest, [1.0])[1][0], REPEATS, LONG)
    off = np.abs(floor(state, problem) - floor(path, problem)).max()
    return {"dynamics_seconds": used["processor"], "dynamics_error": float(off) / force}


def lost(record: PathRecord) -> dict[str, int]:
    """How often an equilibrium was lost, by what happened."""
    return dict(Counter(event.kind for event in record.events if event.lost))


def difference(one: State, other: State) -> float:
    """Largest difference of a force of the floor or a wall (mean weights)."""
    at = [
        {(int(i), int(w)): f for i, w, f in zip(s.walls.first, s.walls.second, s.wall_force(), strict=True)}
        for s in (one, other)
    ]
    zero = np.zeros(2)
    return max(float(np.abs(at[0].get(key, zero) - at[1].get(key, zero)).max()) for key in at[0] | at[1])


def outcome(run: dict[str, Any]) -> str:
    """What happened: to the path, else to the increments."""
    if "failed" in run:
        known = ("no equilibrium", "the packing did not come to rest under gravity")
        reason = next((one for one in known if run["failed"].startswith(one)), run["failed"])
        return f"increments: {reason}" if "lost" in run else reason
    for who, key in (("", "lost"), ("increments: ", "lost_by_increments")):
        if run[key]:
            return who + max(run[key], key=LOSSES.index)
    return "none lost"


def groups(runs: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Scenes of each kind by what happened, with their largest errors."""
    found: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for run in runs:
        found.setdefault((run["kind"], outcome(run)), []).append(run)
    rows = []
    for (kind, happened), those in sorted(found.items(), key=lambda item: (list(SCENES).index(item[0][0]), item[0][1])):
        row: dict[str, Any] = {"kind": kind, "equilibria": happened, "scenes": len(those)}
        if "failed" not in those[0]:
            row |= {"events": sum(run["events"] for run in those)}
            row |= {"exact": sum(run["error"] <= EXACT for run in those)}
            for name in ("error", "plain", "plain_twice"):
                row[name] = max((run[name] for run in those if name in run), default=None)
        rows.append(row)
    return rows


def whole(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """What is stored; ``busy`` : whether the times were taken beside other computations."""
    busy = os.getloadavg()[0] > 1.5 * cores()
    return {"planned": COUNTS, "busy": busy, "groups": groups(runs), "runs": runs}


def main(path: str) -> None:
    runs = stored(path)
    known = {(run["kind"], run["scene"]) for run in runs}
    scenes = [(kind, k, given) for kind, of in SCENES.items() for k, given in enumerate(of())]
    # a like part of each kind, so that what has been measured so far is of all
    for kind, k, given in sorted(scenes, key=lambda one: one[1] / COUNTS[one[0]]):
        if (kind, k) not in known:
            runs.append(measure(kind, k, given))
            print(runs[-1], flush=True)
            write(path, whole(runs))


if __name__ == "__main__":
    main(sys.argv[1])
