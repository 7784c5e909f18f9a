"""A whole file or none: bytes go to a temporary file beside the target, which then replaces it in one step.

Whatever happens in between (no space left, an error, a killed process), a file that stood there before is
untouched. What a killed process leaves is named ``.NAME.RANDOM.partial`` and removed by the next write of the
same file; a lock held by the living tells it from a write that is still going on.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import glob
import os
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path


def write_bytes(path: str | os.PathLike[str], data: bytes, check: Callable[[bytes], None] | None = None) -> None:
    """Write ``data`` to ``path``: afterwards the file is whole and on the disk, or as it was before.

    Parameters
    ----------
    path
        The file to make or to replace; its folder must exist.
    data
        Its content.
    check
        Called with the bytes read back from the temporary file; what it raises prevents the replacement.

    Raises
    ------
    OSError
        If the file cannot be written, or reads back differently.
    """
    target = Path(path)
    remove_leftovers(target)
    with _temporary(target) as (descriptor, temporary):
        view = memoryview(data)
        while view:
            view = view[os.write(descriptor, view) :]
        os.fsync(descriptor)
        written = temporary.read_bytes()
        if written != data:
            raise OSError(f"{temporary} reads back differently from what was written")
        if check:
            check(written)
        os.replace(temporary, target)
    _sync_folder(target.parent)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise the OSError that ``write_bytes`` would meet at once."""
    target = Path(path)
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(target))
    with _temporary(target):
        pass


def remove_leftovers(path: str | os.PathLike[str]) -> list[Path]:
    """Remove the temporary files that killed writes of ``path`` left beside it; returns their paths."""
    target = Path(path)
    removed: list[Path] = []
    for leftover in target.parent.glob(f".{glob.escape(target.name)}.*.partial"):
        with contextlib.suppress(OSError):
            descriptor = os.open(leftover, os.O_RDWR)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)  # fails while its writer lives
                os.unlink(leftover)
                removed.append(leftover)
            finally:
                os.close(descriptor)
    return removed


@contextlib.contextmanager
def _temporary(target: Path) -> Iterator[tuple[int, Path]]:
    """A new, locked file beside ``target``, gone at the end unless it was moved away."""
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(6)}.partial")
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield descriptor, temporary
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(temporary)
        os.close(descriptor)


def _sync_folder(folder: Path) -> None:
    """Put the new name on the disk too, where the file system can."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
