"""Keeps compiled kernels in step with their sources.

Numba stores machine code beside each module and renews it when that module changes, but a kernel also holds code
inlined from other modules here. So when any source in this package has changed, all stored code goes; in a folder of
the user's choice (``NUMBA_CACHE_DIR``) each state of the sources has a part of its own.
"""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path

import numba

_HERE = Path(__file__).parent
_STAMP = "sources.sha256"


def drop_stale() -> None:
    """Delete stored machine code that was made from other sources. Does nothing where nothing may be written."""
    digest = hashlib.sha256()
    for path in sorted(_HERE.rglob("*.py")):
        digest.update(path.relative_to(_HERE).as_posix().encode())
        digest.update(path.read_bytes())
    if numba.config.CACHE_DIR:
        numba.config.CACHE_DIR = str(Path(numba.config.CACHE_DIR) / digest.hexdigest()[:16])
        return
    stamp = _HERE / "__pycache__" / _STAMP
    with contextlib.suppress(OSError):
        if stamp.exists() and stamp.read_text() == digest.hexdigest():
            return
        for pattern in ("*.nbi", "*.nbc"):
            for stored in _HERE.rglob(pattern):
                stored.unlink(missing_ok=True)
        stamp.parent.mkdir(exist_ok=True)
        stamp.write_text(digest.hexdigest())
