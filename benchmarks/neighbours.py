"""Lists of close disks: the sweep of this package and a tree of scipy, in turns.

`python benchmarks/neighbours.py OUTPUT.json`. Slabs whose disks are displaced a little at random, with the skin of a
fall under gravity. Both give the same pairs, which is checked. Times are of the processor.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.spatial import KDTree
from timing import interleaved, write

from granular_response.scene import Scene
from granular_response.solvers.candidates import SKIN
from granular_response.solvers.close_pairs import close_pairs

#: layers and disks in the bottom row
SLABS = [(15, 61), (60, 242), (180, 720)]
REPEATS = 15


def by_tree(position: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """(m, 2) the pairs of :func:`close_pairs`, from a tree."""
    pairs = KDTree(position).query_pairs(2.0 * float(radius.max()) + SKIN, p=np.inf, output_type="ndarray")
    first, second = np.sort(pairs, axis=1).T
    apart, reach = position[first] - position[second], radius[first] + radius[second] + SKIN
    close = (apart * apart).sum(axis=1) < reach * reach
    first, second = first[close], second[close]
    return np.stack([first, second], axis=1)[np.lexsort((second, first))]


def main(path: str) -> None:
    rows = []
    for layers, per_row in SLABS:
        packing = {"kind": "slab", "layers": layers, "disks_per_row": per_row, "polydispersity": 0.1}
        built = Scene.from_dict({"packing": packing, "loads": []}).packing.build()
        position = built.position + 0.05 * np.random.default_rng(0).standard_normal(built.position.shape)
        ours = np.stack(close_pairs(position, built.radius, SKIN), axis=1)
        if not np.array_equal(ours, by_tree(position, built.radius)):
            sys.exit(f"the pairs of {built.n} disks differ")
        sweep, whole = interleaved(
            [
                lambda: close_pairs(position, built.radius, SKIN),  # noqa: B023 called at once
                lambda: by_tree(position, built.radius),  # noqa: B023
            ],
            REPEATS if built.n < 10_000 else 3,
            time.process_time,
        )
        row = {"disks": built.n, "sweep_milliseconds": 1e3 * sweep, "tree_milliseconds": 1e3 * whole}
        rows.append({**row, "ratio": whole / sweep})
        print(rows[-1], flush=True)
    write(path, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
