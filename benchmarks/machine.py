"""What the benchmarks were last measured with.

`python benchmarks/machine.py OUTPUT.json`. Kind of processor and versions; no name of the machine.
"""

from __future__ import annotations

import os
import platform
import sys
from importlib import metadata

from peers import lammps
from timing import write


def main(path: str) -> None:
    write(
        path,
        {
            "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
            "python": platform.python_version(),
            "numba": metadata.version("numba"),
            "numpy": metadata.version("numpy"),
            "lammps": lammps.version(),
        },
    )


if __name__ == "__main__":
    main(sys.argv[1])
