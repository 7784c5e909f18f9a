"""Random scenes of disks that are anything but alike, and a command that tries thousands of both kinds.

``python tests/unlike_scenes.py 5000`` tries that many on all cores, every second one of disks whose masses differ by up
to 1e9 and whose radii by up to 100, and counts the outcomes. Trials that are finished are kept beside ``--output``
until all are: a run that was interrupted continues where it was, and begins anew where the code has changed.
"""

import shutil
import sys
import time
from collections import Counter
from functools import partial
from pathlib import Path

import counts
import numpy as np
from stress.random_scenes import Trial, log_uniform, run, thrown

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
        counts.write(output, number, seed, found)
        shutil.rmtree(kept, ignore_errors=True)
    return int(any(trial.outcome == "wrong" for trial in trials))


if __name__ == "__main__":
    given = counts.arguments("Solve and check random scenes.", 20260101)
    try:
        sys.exit(main(given.number, given.seed, given.output))
    except KeyboardInterrupt:
        sys.exit("interrupted: what is finished is kept with --output, and the same command goes on from there")
