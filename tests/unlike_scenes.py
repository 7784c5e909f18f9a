"""Random scenes of disks that are anything but alike, and a command that tries thousands of both kinds.

``python tests/unlike_scenes.py 5000`` tries that many on all cores, every second one of disks whose masses differ by up
to 1e9 and whose radii by up to 100, and counts the outcomes. Trials that are finished are kept beside ``--output``
until all are: a run that was interrupted continues where it was, and begins anew where the code has changed.
"""

import argparse
import json
import platform
import shutil
import sys
import time
from collections import Counter
from collections.abc import Mapping
from functools import partial
from importlib import metadata
from pathlib import Path

import numpy as np
from stress.random_scenes import Trial, log_uniform, run, thrown

from granular_response import __version__
from granular_response.inputs import read_json
from granular_response.store import atomic
from granular_response.sweeps.keys import sources
from granular_response.sweeps.resources import using
from granular_response.sweeps.tasks import map_tasks

#: Ratios of masses and of radii.
MASS_RATIO, RADIUS_RATIO = 1e9, 100.0
#: Most steps of a scene.
STEPS = 400_000
#: What the scenes are in turn, and what is said of those that resist rolling.
KINDS, ROLL = ("any scene", "unlike disks"), ", rolling resistance"
#: Code that makes a trial, beside the library.
PACKAGES = ("granular_response_paper", "stress")


def unlike_heap(g: np.random.Generator) -> tuple[np.ndarray, float]:
    """The same of few disks, x, z, radius, mass: radii and masses over many decades, together or each by itself."""
    n, width = int(g.integers(3, 15)), float(g.uniform(4.0, 10.0))
    small = log_uniform(g, 1.0 / RADIUS_RATIO, 1.0) if g.random() < 0.6 else 1.0
    placed = thrown(g, n, width, lambda: log_uniform(g, small, 1.0))
    light = log_uniform(g, 1.0 / MASS_RATIO, 1.0)
    mass = [log_uniform(g, light, 1.0) for _ in range(n)] if g.random() < 0.7 else placed[:, 2] ** 2
    return np.column_stack([placed, mass]), width


def either(index: int, entropy: int) -> Trial:
    trial = run(STEPS, entropy, index, heap=unlike_heap if index % 2 else None)
    if trial.outcome == "wrong":  # at once: what is left may take an hour
        print(f"scene {index}: {trial.message}", file=sys.stderr, flush=True)
    return trial


def told():
    """A line of progress for each hundredth."""
    started, said = time.monotonic(), -1

    def progress(done: float, total: float, what: str = "") -> None:
        nonlocal said
        if (hundredths := int(100 * done / total)) > said:
            said = hundredths
            minutes = (time.monotonic() - started) / 60.0
            print(f"{what}: {done:.0f} of {total:.0f} after {minutes:.1f} minutes", file=sys.stderr, flush=True)

    return progress


def write(path: Path, number: int, seed: int, outcomes: Mapping[str, Mapping[str, int]]) -> None:
    """Write how many of which kind (the keys of ``outcomes``) had which outcome, with what repeats them."""
    versions = {name: metadata.version(name) for name in ("numba", "numpy", "scipy")}
    made = {
        "number": number,
        "seed": seed,
        "outcomes": {kind: dict(sorted(counts.items())) for kind, counts in sorted(outcomes.items())},
        "package_version": __version__,
        "sources": sources("", "granular_response_paper"),
        "versions": {"python": platform.python_version(), **versions},
    }
    atomic.write_bytes(path, (json.dumps(made, indent=1) + "\n").encode())


def totals(path: Path) -> dict[str, int]:
    """How many of all kinds together had which outcome. Raises OSError and ValueError for a file that is not one."""
    return sum(map(Counter, read_json(path)["outcomes"].values()), Counter())


def main(number: int, seed: int, output: Path | None = None) -> int:
    """Try ``number`` scenes; prints what is wrong with which and the counts of the outcomes. 1 if any is wrong."""
    kept = None if output is None else output.absolute().with_name(f".{output.stem}.checkpoint")
    with using(packages=PACKAGES, checkpoint=kept, progress=told()):
        trials = map_tasks(partial(either, entropy=seed), range(number), what="scenes")
    for index, trial in enumerate(trials):
        if trial.outcome == "wrong":
            print(f"scene {index}: {trial.message}")
    found: dict[str, Counter[str]] = {}
    for index, trial in enumerate(trials):
        found.setdefault(KINDS[index % 2] + ROLL * trial.rolls, Counter())[trial.outcome] += 1
    for kind, outcomes in sorted(found.items()):
        print(f"{kind}: " + ", ".join(f"{count} {outcome}" for outcome, count in outcomes.most_common()))
    if output is not None:
        write(output, number, seed, found)
        shutil.rmtree(kept, ignore_errors=True)
    return int(any(trial.outcome == "wrong" for trial in trials))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Solve and check random scenes.")
    parser.add_argument("number", type=int, help="how many to try")
    parser.add_argument("--seed", type=int, default=20260101, help="the same ones for the same seed")
    parser.add_argument("--output", type=Path, help="file of the counts (JSON)")
    given = parser.parse_args()
    try:
        sys.exit(main(given.number, given.seed, given.output))
    except KeyboardInterrupt:
        sys.exit("interrupted: what is finished is kept with --output, and the same command goes on from there")
