"""The same digits on every x86 machine: choices that numpy and its BLAS otherwise make from the processor.

They are environment variables, read when numpy is loaded, so they are set before that. What the user has set
stays as it is. The command line does that by itself; for processes that others start, such as Dask workers, a shell
does it with ``eval "$(python -m granular_response.machine.floating_point)"``.
"""

from __future__ import annotations

import os
import platform
import shlex


def variables() -> dict[str, str]:
    """Environment variables that fix order and width of floating-point operations."""
    chosen = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    if platform.machine().lower() in ("x86_64", "amd64"):
        chosen["OPENBLAS_CORETYPE"] = "Haswell"
        chosen["NPY_DISABLE_CPU_FEATURES"] = "X86_V4 AVX512_ICL AVX512_SPR"
    return chosen


def pin() -> None:
    """Set them for this process and its children."""
    for name, value in variables().items():
        os.environ.setdefault(name, value)


if __name__ == "__main__":
    for name, value in variables().items():
        print(f"export {name}={shlex.quote(os.environ.get(name, value))}")
