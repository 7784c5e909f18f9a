"""Random scenes of disks that are anything but alike, and a command that tries thousands of both kinds.

``python tests/unlike_scenes.py 5000`` tries that many on all cores, every second one of disks whose masses differ by up
to 1e9 and whose radii by up to 100, and counts the outcomes.
"""

import sys
from collections import Counter
from functools import partial
from pathlib import Path

import counts
import numpy as np
from stress.random_scenes import Trial, log_uniform, run, thrown

from granular_response.sweeps.tasks import map_tasks

#: Ratios of masses and of radii.
MASS_RATIO, RADIUS_RATIO = 1e9, 100.0
#: Most steps of a scene, and what the scenes are in turn.
STEPS = 400_000
KINDS = ("any scene", "unlike disks")


def unlike_heap(g: np.random.Generator) -> tuple[np.ndarray, float]:
    """The same of few disks, x, z, radius, mass: radii and masses over many decades, together or each by itself."""
    n, width = int(g.integers(3, 15)), float(g.uniform(4.0, 10.0))
    small = log_uniform(g, 1.0 / RADIUS_RATIO, 1.0) if g.random() < 0.6 else 1.0
    placed = thrown(g, n, width, lambda: log_uniform(g, small, 1.0))
    light = log_uniform(g, 1.0 / MASS_RATIO, 1.0)
    mass = [log_uniform(g, light, 1.0) for _ in range(n)] if g.random() < 0.7 else placed[:, 2] ** 2
    return np.column_stack([placed, mass]), width


def either(index: int, entropy: int) -> Trial:
    return run(STEPS, entropy, index, heap=unlike_heap if index % 2 else None)


def main(number: int, seed: int, output: Path | None = None) -> int:
    """Try ``number`` scenes; prints what is wrong with which and the counts of the outcomes. 1 if any is wrong."""
    trials = map_tasks(partial(either, entropy=seed), range(number), what="scenes")
    for index, trial in enumerate(trials):
        if trial.outcome == "wrong":
            print(f"scene {index}: {trial.message}")
    found = {kind: Counter(trial.outcome for trial in trials[k::2]) for k, kind in enumerate(KINDS)}
    for kind, outcomes in found.items():
        print(f"{kind}: " + ", ".join(f"{count} {outcome}" for outcome, count in outcomes.most_common()))
    if output is not None:
        counts.write(output, number, seed, found)
    return int(any(trial.outcome == "wrong" for trial in trials))


if __name__ == "__main__":
    given = counts.arguments("Solve and check random scenes.", 20260101)
    sys.exit(main(given.number, given.seed, given.output))
