"""Make a packing of your own: large and small disks at random places of a loose lattice.

    python examples/bidisperse_slab.py examples/bidisperse_slab.csv

The exact places matter little as long as no disks overlap, since they settle under gravity before the load acts.
"""

import csv
import math
import sys

import numpy as np

ROWS, COLUMNS = 7, 12
SMALL, LARGE = 1.0, 1.2
SPACING = 2.0 * LARGE * 1.1  # loose: large disks do not touch
SEED = 7


def disks() -> list[tuple[float, float, float]]:
    """x, z and radius of all disks, row by row from the floor."""
    generator = np.random.default_rng(SEED)
    radius = generator.permutation(np.repeat([SMALL, LARGE], ROWS * COLUMNS // 2))
    found = []
    for number, own in enumerate(radius):
        row, column = divmod(number, COLUMNS)
        x = SPACING * (0.5 + column + 0.5 * (row % 2))
        z = SPACING * (0.5 + row * 0.5 * math.sqrt(3.0))
        found.append((round(x, 4), round(z, 4), float(own)))
    return found


def main() -> None:
    with open(sys.argv[1], "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["x", "z", "radius"])
        writer.writerows(disks())


if __name__ == "__main__":
    main()
