"""What the benchmarks were last measured with: `python benchmarks/machine.py OUTPUT.json`."""

import platform
import sys
from importlib import metadata

from timing import write

from granular_response.machine.threads import cores

if __name__ == "__main__":
    versions = {name: metadata.version(name) for name in ("numba", "numpy")}
    write(sys.argv[1], {"cores": cores(), "python": platform.python_version(), **versions})
