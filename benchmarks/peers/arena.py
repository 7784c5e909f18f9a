"""Time of a step and memory of slabs with friction, ours and those of other codes, one core each, in turns in one run.

`python -m peers.arena OUTPUT.json [LEAST_DISKS [MOST_DISKS]]`; slabs of fewer or more disks keep the rows that
OUTPUT.json has for them. Same scene, contact law and time step. Nothing is installed: a
code that is not there is named as skipped, with what installs it (`codes.py`). Other work on the machine lengthens the
time of a step but not its processor time, where the system tells it; both are stored.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from peers import codes, kernel, ours, processes
from timing import stored, write

from granular_response import __version__

FRICTION = 0.2
#: Steps of a timed stage by number of disks; ours has ten times as many.
STEPS = {908: 400, 14_490: 25, 99_950: 5}
ROUNDS = 3
#: Timed stages of each round.
REPEATS = 4


def measure_steps(layers: int, per_row: int, settle: int, steps: int, there: list[codes.Peer]) -> list[dict]:
    """One record for each code, ours first.

    All start from the positions that our dynamics reaches after ``settle`` steps. Each round starts all of them anew.
    """
    packing = ours.settled(layers, per_row, FRICTION, settle, kernel.TIME_STEP)
    with tempfile.TemporaryDirectory() as folder:
        start = Path(folder, "start.npy")
        np.save(start, packing.position)
        # our stages have more steps, so that they are not too short to be timed
        own = partial(ours.steps_used, start, layers, per_row, FRICTION, 10 * steps, REPEATS, kernel.TIME_STEP)
        actions: dict[str, tuple[str | None, Callable[[], processes.Used]]] = {"granular_response": (__version__, own)}
        for peer in there:
            theirs = partial(peer.steps, packing, FRICTION, steps, steps, kernel.TIME_STEP, repeats=REPEATS)
            actions[peer.name] = peer.version, theirs
        rounds: dict[str, list[dict]] = {name: [] for name in actions}
        for _ in range(ROUNDS):
            for name, (_, action) in actions.items():
                rounds[name].append(action().least())
                print(packing.n, name, rounds[name][-1], flush=True)
    rows: list[dict] = []
    for name, (version, _) in actions.items():
        row: dict[str, Any] = {"code": name, "version": version, "disks": packing.n, "rounds": ROUNDS}
        for key, title in (("seconds", "microseconds"), ("processor", "processor_microseconds")):
            found = [1e6 * least[key] for least in rounds[name] if least[key] is not None]
            row |= {title: min(found, default=None), f"{title}_worst_round": max(found, default=None)}
        row["peak_mebibytes"] = max(least["peak_mebibytes"] or 0.0 for least in rounds[name]) or None
        rows.append(row)
    told = all(row["processor_microseconds"] is not None for row in rows)
    key = "processor_microseconds" if told else "microseconds"
    return [{**row, "times_ours": row[key] / rows[0][key]} for row in rows]


def main(path: str, least: int = 0, most: int = 10**9) -> None:
    there, skipped = codes.there()
    earlier = stored(path)
    rows: list[dict] = []
    for layers, per_row, settle, _ in kernel.SLABS:
        n = kernel.slab(layers, per_row, FRICTION).n
        if n not in STEPS:
            continue
        if least <= n <= most:
            rows += measure_steps(layers, per_row, settle, STEPS[n], there)
        else:
            rows += [row for row in earlier if row["disks"] == n]
        # after every size: the last ones take long
        write(path, {"friction": FRICTION, "skipped": skipped, "runs": rows})


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:4]))
