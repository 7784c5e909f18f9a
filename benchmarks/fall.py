"""The default fall under gravity against the paper's time step to its end, and what whole solutions cost.

`python benchmarks/fall.py OUTPUT.json [--only WORDS]`. The reference has the paper's step all the way and ends at a
kinetic energy of 1e-15 mg R per disk. Differences of the two equilibria are the largest of a force on the floor and of
a tangential force, in mg, and the number of contacts that are closed in one of them only. Each scene runs in a process
of its own, whose peak memory is that of the default fall. The rows of `whole` are of `gr.solve` from scene to result,
on one thread. Kernels are compiled before. Rows that are not asked for are kept.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from typing import Any

from timing import power, processor, stored, write

import granular_response as gr
from granular_response.scene import Scene
from granular_response.scene.protocol import PAPERS_TIME_STEP
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.state import FLOOR, Contacts, FloatArray, State

PAPERS = {"protocol.time_step": PAPERS_TIME_STEP, "protocol.stop_kinetic_energy": 1e-15}
ROLLING = {"contact.rolling_friction": 0.1, "contact.rolling_stiffness_ratio": 0.5}
MOST = 20_000  #: disks, beyond which no reference is made: it takes hours


def slab(layers: int, disks_per_row: int, friction: float = 0.2, **changes: Any) -> dict[str, Any]:
    """Keys of a scene with a slab."""
    packing = {"packing.layers": layers, "packing.disks_per_row": disks_per_row}
    return {**packing, "contact.friction": friction, **{key.replace("__", "."): one for key, one in changes.items()}}


SCENES: dict[str, dict[str, Any]] = {
    "slab, 15 layers": slab(15, 61),
    "slab, 30 layers": slab(30, 121),
    "slab, 60 layers": slab(60, 241),
    "slab, 160 layers": slab(160, 641),
    "friction 0.5, 30 layers": slab(30, 121, 0.5),
    "friction 1, 30 layers": slab(30, 121, 1.0),
    "rough walls, 30 layers": slab(30, 121, wall__friction=0.2),
    "3/2 law, 30 layers": slab(30, 121, contact__law="hertz"),
    "rolling resistance, 30 layers": slab(30, 121, **ROLLING),
    "periodic, 30 layers": slab(30, 120, packing__sides="periodic"),
    "deep, 30 layers of 61": slab(30, 61),
    "deep, 60 layers of 61": slab(60, 61),
    "wide, 10 layers of 121": slab(10, 121),
    "pile, 20 layers": {"packing": {"kind": "pile", "layers": 20}, "contact.friction": 0.5},
    "disorder 0.1, 15 layers": slab(15, 61, packing__polydispersity=0.1),
}

#: Whole solutions of the default scene, and the keys that each changes.
LIGHT = {"loads.0.force": [0.0, -1.0]}
CHANGES: dict[str, dict[str, Any]] = {
    "default": {},
    "load of 1 mg": LIGHT,
    "load of 1 mg, prepared without friction": {**LIGHT, "preparation.gravity": "frictionless"},
    "load of 1 mg, without friction": {**LIGHT, "contact.friction": 0.0},
}
WHOLE = {
    f"{words}, {layers} layers": (words, {"packing.layers": layers, "packing.disks_per_row": disks_per_row, **changes})
    for words, changes in CHANGES.items()
    for layers, disks_per_row in ((15, 61), (30, 121), (60, 241))
}


def fallen(described: Scene) -> tuple[State, Problem, float]:
    """The initial equilibrium, and the processor time that it took."""
    problem = Problem.from_scene(described)
    start = time.process_time()
    return rest_state(problem), problem, time.process_time() - start


def by_bodies(contacts: Contacts, force: FloatArray, counts: Any = True) -> dict[tuple[int, int], float]:
    """The ``force`` (m,) of the contacts that touch, and that ``counts`` selects, by their two bodies."""
    of = contacts.touching & counts
    bodies = zip(contacts.first[of].tolist(), contacts.second[of].tolist(), strict=True)
    return dict(zip(bodies, force[of].tolist(), strict=True))


def measure(words: str) -> dict[str, Any]:
    """The row of one scene."""
    described = Scene().updated({"loads": [], **SCENES[words]})
    for integrator in ("beeman", "leapfrog"):  # compiles
        rest_state(Problem.from_scene(described.updated({"packing.layers": 4, "protocol.integrator": integrator})))
    found, problem, seconds = fallen(described)
    reached = found.reached
    row = {
        "scene": words, "disks": problem.n, "seconds": seconds, "steps": reached.steps,
        "first_steps": reached.first_steps or reached.steps, "time_step": reached.time_step,
        "peak_gibibytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, "measured_on": processor(),
    }  # fmt: skip
    if problem.n > MOST:
        return row
    end, _, papers = fallen(described.updated(PAPERS))
    floor, floors = (by_bodies(one.walls, one.walls.normal_force, one.walls.second == FLOOR) for one in (found, end))
    forces, others = (by_bodies(one.pairs, one.pairs.tangential_force) for one in (found, end))
    row["floor_error"] = max(abs(floor.get(key, 0.0) - floors.get(key, 0.0)) for key in {**floor, **floors})
    row["tangential_error"] = max(abs(forces.get(key, 0.0) - others.get(key, 0.0)) for key in {**forces, **others})
    row["contacts"], row["contacts_that_differ"] = len(others), len(forces.keys() ^ others.keys())
    return row | {"papers_seconds": papers, "papers_steps": end.reached.steps}


def measure_whole(name: str) -> dict[str, Any]:
    """The row of one whole solution."""
    words, changes = WHOLE[name]
    described = Scene().updated(changes)
    for integrator in ("beeman", "leapfrog"):  # compiles
        small = {"packing.layers": 4, "packing.disks_per_row": 17, "protocol.integrator": integrator, **LIGHT}
        gr.solve(described.updated(small), progress=False)
    start = time.process_time()
    disks = len(gr.solve(described, progress=False).rest.position)
    return {
        "scene": words, "changes": CHANGES[words], "disks": disks, "seconds": time.process_time() - start,
        "peak_gibibytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, "measured_on": processor(),
    }  # fmt: skip


def main(path: str, only: list[str]) -> None:
    # one thread: where others use the machine, threads that wait for each other count as processor time
    os.environ.update(NUMBA_NUM_THREADS="1", OMP_NUM_THREADS="1")
    kept = {row["scene"]: row for row in stored(path, "scenes")}
    whole = {(row["scene"], row["disks"]): row for row in stored(path, "whole")}
    for words in only or [*SCENES, *WHOLE]:
        with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as process:
            row = process.submit(measure if words in SCENES else measure_whole, words).result()
        print(row, flush=True)
        if words in SCENES:
            kept[words] = row
        else:
            whole[row["scene"], row["disks"]] = row
        found = [kept[name] for name in SCENES if name in kept]
        wholes = sorted(whole.values(), key=lambda row: ([*CHANGES].index(row["scene"]), row["disks"]))
        paper = [row for row in found if row["scene"].startswith("slab") and row["disks"] < MOST]
        slope = power(*([row[key] for row in paper] for key in ("disks", "seconds"))) if paper[1:] else None
        write(path, {"exponent_of_seconds": slope, "scenes": found, "whole": wholes})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output")
    parser.add_argument("--only", nargs="*", default=[], choices=[*SCENES, *WHOLE], metavar="WORDS")
    given = parser.parse_args()
    main(given.output, given.only)
