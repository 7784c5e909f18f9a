"""Processes without a Dask cluster do not load Dask.

xarray asks of arrays whether they are Dask's, and where that is installed loads all of ``dask.array`` to know: 0.3 s of
every command that reads a result. A module that Python has been told to be absent is not looked for.
"""

from __future__ import annotations

import sys


def hide() -> None:
    """Dask counts as not installed from now on; without effect once it, or xarray, is loaded."""
    if "xarray" not in sys.modules:
        sys.modules.setdefault("dask", None)  # type: ignore[arg-type]


def show() -> None:
    """Dask may be imported again."""
    if not sys.modules.get("dask", True):  # None is what stands for an absent module
        del sys.modules["dask"]
