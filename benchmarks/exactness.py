"""Error of load paths: against the same path in small increments with the return map.

`python benchmarks/exactness.py OUTPUT.json`. The paper's slab at nine pairs of friction and force; small packings of
all kinds under loads of all sizes; slabs of 8 to 15 layers. Errors are largest differences of a force of the floor or a
wall, per load. The increments know no events, but those at which the path changes its contacts end one each: changes
inside an increment would leave an error in proportion to its length, and a change that the path has missed is such a
one. What their length leaves is the difference from increments of twice the length, which is stored beside.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from timing import write

from granular_response.errors import SolveError
from granular_response.scene import Scene
from granular_response.solvers.path import PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.state import State

#: Increments of the reference, in mean weights, and how many a path has at most.
INCREMENT, MOST = 1e-3, 2_000
#: Error per load up to which a path counts as exact.
EXACT = 1e-8
SMALL, SLABS = 200, 40


def slab() -> Iterator[tuple[str, dict[str, Any]]]:
    """The paper's slab under nine pairs of friction and force."""
    for friction in (0.05, 0.2, 1.0):
        for force in (4.0, 15.0, 50.0):
            yield "slab", {"contact": {"friction": friction}, "loads": [{"disk": "top-centre", "force": [0.0, -force]}]}


def small() -> Iterator[tuple[str, dict[str, Any]]]:
    """Packings of at most 60 disks with loads of all sizes."""
    for k in range(SMALL):
        random = np.random.default_rng(np.random.SeedSequence([37, k]))
        rows = int(random.integers(2, 6))
        size = float(10.0 ** random.uniform(-2.0, 1.3))
        angle = float(random.uniform(-0.6, 0.6))
        yield f"small {k}", scene(random, rows, int(random.integers(5, 60 // rows)), size, angle)


def slabs() -> Iterator[tuple[str, dict[str, Any]]]:
    """Slabs of 8 to 15 layers: order and disorder, walls and periodic sides, both laws."""
    for k in range(SLABS):
        random = np.random.default_rng(np.random.SeedSequence([38, k]))
        layers = int(random.integers(8, 16))
        yield f"slab {k}", scene(random, layers, 4 * layers + 1, float(random.choice([2.0, 5.0, 12.0])), 0.0)


def scene(random: np.random.Generator, layers: int, across: int, size: float, angle: float) -> dict[str, Any]:
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
    return {
        "packing": packing,
        "contact": {"friction": friction, "law": law},
        "wall": {"friction": wall},
        "loads": [{"disk": "top-centre", "force": [size * np.sin(angle), -size * np.cos(angle)]}],
        "protocol": {"integrator": "leapfrog", "time_step": "auto"},
    }


def row(name: str, description: dict[str, Any]) -> dict[str, Any]:
    """How far the path is off, how long it took, and what happened on the way."""
    given = Scene.from_dict(description)
    packing = given.packing.model_dump()
    found: dict[str, Any] = {
        "name": name,
        "friction": given.contact.friction,
        "law": given.contact.law,
        "polydispersity": packing.get("polydispersity", 0.0),
        "sides": packing.get("sides", "walls"),
    }
    try:
        problem = Problem.from_scene(given)
        rest = rest_state(problem)
        problem = problem.with_loads(rest.position)
        found |= {"disks": problem.n, "load": problem.load_size}
        path, seconds, record = followed(problem, rest, 0.0)
        found |= {"seconds": seconds, "events": len(record.events), "lost": lost(record)}
        if found["lost"]:  # where the path is then is told by what happened, not by an error
            return found
        changes = sorted({event.load_factor for event in record.events})
        length = max(INCREMENT, problem.load_size / MOST)
        once, seconds, record = followed(problem, rest, length, changes)
        found |= {"reference_seconds": seconds, "reference_lost": lost(record), "increment": length}
        found["error"] = difference(path, once) / problem.load_size
        if not found["reference_lost"]:
            twice = followed(problem, rest, 2.0 * length, changes)[0]
            found["reference_error"] = difference(once, twice) / problem.load_size
    except SolveError as error:
        found["failed"] = str(error)
    return found


def followed(
    problem: Problem, rest: State, together: float, by_way_of: Sequence[float] = ()
) -> tuple[State, float, PathRecord]:
    """The loaded state, the processor time, and what happened; increments end at the load factors ``by_way_of``."""
    record, start = PathRecord(), time.process_time()
    state = follow(problem, rest, [*by_way_of, 1.0], together=together, record=record)[-1]
    return state, time.process_time() - start, record


def lost(record: PathRecord) -> list[dict[str, Any]]:
    """Equilibria that were lost on the way."""
    names = ("load_factor", "kind", "until", "displacement")
    return [{name: getattr(event, name) for name in names} for event in record.events if event.lost]


def difference(one: State, other: State) -> float:
    """Largest difference of a force of the floor or a wall (mean weights)."""
    at = [
        {(int(i), int(w)): f for i, w, f in zip(s.walls.first, s.walls.second, s.wall_force(), strict=True)}
        for s in (one, other)
    ]
    zero = np.zeros(2)
    return max(float(np.abs(at[0].get(key, zero) - at[1].get(key, zero)).max()) for key in at[0] | at[1])


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts by outcome."""
    kept = [r for r in rows if "reference_error" in r]
    return {
        "scenes": len(rows),
        "failed": sum("failed" in r for r in rows),
        "lost_by_the_path": sum(bool(r.get("lost")) for r in rows),
        "lost_by_the_increments_alone": sum(bool(r.get("reference_lost")) and not r.get("lost") for r in rows),
        "compared": len(kept),
        "exact": sum(r["error"] <= EXACT + r["reference_error"] for r in kept),
        "largest_error": max((r["error"] for r in kept), default=None),
        "median_error": float(np.median([r["error"] for r in kept])) if kept else None,
    }


def main() -> None:
    groups = {"small": small, "slabs": slabs, "slab": slab}
    rows: dict[str, list[dict[str, Any]]] = {}
    for name, scenes in groups.items():
        rows[name] = []
        for label, description in scenes():
            rows[name].append(row(label, description))
            print(rows[name][-1], flush=True)
        write(sys.argv[1], {**{f"{name}_summary": summary(found) for name, found in rows.items()}, "rows": rows})


if __name__ == "__main__":
    main()
