"""A whole file or none: bytes go to a temporary file beside the target, which then replaces it in one step.

Whatever happens in between (no space left, an error, a killed process), a file that stood there before is
untouched. What a killed process leaves is named ``.NAME.partial`` and taken by the next write of the same file; a
writer holds a lock on it, so that two at once come one after the other.

Only a regular file is replaced: a link is followed and stays, a device, a pipe or a folder is refused, and so is a
file that the same command reads (``check_writable``).
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import stat
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from ..inputs import check_regular


def write_bytes(
    path: str | os.PathLike[str], data: bytes, check: Callable[[bytes], None] | None = None, *, lasting: bool = True
) -> None:
    """Write ``data`` to ``path``: afterwards the file is whole and on the disk, or as it was before.

    The folder must exist; of a link, what it leads to is replaced. ``check`` is called with the bytes read back from
    the temporary file; what it raises prevents the replacement. What need not be ``lasting`` may be lost when the
    machine stops, and is written sooner. Raises OSError if the file cannot be written, or reads back differently.
    """
    target = _regular(path)
    with _temporary(target) as (descriptor, temporary):
        with contextlib.suppress(FileNotFoundError):
            os.fchmod(descriptor, stat.S_IMODE(os.stat(target).st_mode))
        view = memoryview(data)
        while view:
            view = view[os.write(descriptor, view) :]
        if lasting:
            os.fsync(descriptor)
        written = temporary.read_bytes()
        if written != data:
            raise OSError(f"{temporary} reads back differently from what was written")
        if check:
            check(written)
        os.replace(temporary, target)
    if not lasting:
        return
    with contextlib.suppress(OSError):  # the new name goes to the disk too, where the file system can
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def make_folder(path: str | os.PathLike[str]) -> None:
    """Make the folder of a file to write. OSError, also where a ``~`` would become the name of a new folder."""
    folder = Path(path).parent
    if str(folder).startswith("~") and not folder.exists():
        raise OSError(errno.ENOENT, "there is no folder ~ here; os.path.expanduser gives the home folder", str(path))
    folder.mkdir(parents=True, exist_ok=True)


def check_writable(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]] = ()) -> None:
    """Raise the OSError that ``write_bytes`` would meet at once, or that of ``check_output``."""
    check_output(path, inputs)
    with _temporary(_regular(path)):
        pass


def check_output(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]]) -> None:
    """Raise OSError if ``path`` is one of the files in ``inputs``, by whatever name."""
    if os.path.exists(path) and any(os.path.exists(given) and os.path.samefile(path, given) for given in inputs):
        raise OSError(errno.EINVAL, "is read by the same command, must be another file", os.fspath(path))


def _regular(path: str | os.PathLike[str]) -> Path:
    """The place that writing ``path`` makes or replaces. OSError unless it is a regular file or a new name."""
    try:
        os.fsencode(path).decode()
    except UnicodeError:
        raise OSError(errno.EILSEQ, "has a name that is not UTF-8", os.fspath(path)) from None
    target = Path(os.path.realpath(path))
    try:
        check_regular(path)
    except FileNotFoundError:
        return target
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), os.fspath(path))
    return target


@contextlib.contextmanager
def _temporary(target: Path) -> Iterator[tuple[int, Path]]:
    """An empty, locked file beside ``target``, gone at the end unless it was moved away."""
    temporary = target.with_name(f".{target.name}.partial")
    while True:
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT, 0o666)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        if _is_open(descriptor, temporary):
            break
        os.close(descriptor)  # another writer has moved it away meanwhile
    try:
        os.ftruncate(descriptor, 0)
        yield descriptor, temporary
    finally:
        if _is_open(descriptor, temporary):
            os.unlink(temporary)
        os.close(descriptor)


def _is_open(descriptor: int, path: Path) -> bool:
    """Whether this is the file that has the path."""
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False
