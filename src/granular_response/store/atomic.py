"""A whole file or none: what is written is made in a private folder, and then replaces its target in one step.

Whatever happens in between (no space left, an error, a killed process), a file that stood there before is
untouched. The folder has a random name, ``.granular-*.partial``, beside the target, and nobody else may enter it: no
link or pipe that somebody planted can stand in its way. What a killed process leaves is such a folder. The next
process that writes beside it removes it; a lock tells it from the folder of a living one.

Only a regular file is replaced: a link is followed and stays, a device, a pipe or a folder is refused, and so is a
file that the same command reads (``check_writable``).
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import functools
import os
import re
import secrets
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..inputs import check_regular

#: Name of a private folder. It does not grow with the name of the file, which may be as long as the system allows.
_PRIVATE = ".granular-{}.partial"
_LEFTOVER = re.compile(_PRIVATE.format("[0-9a-f]{16}").replace(".", r"\."))
#: How often a private folder is made that another process takes for a leftover before it is locked.
_TRIALS = 10


def write_bytes(path: str | os.PathLike[str], data: bytes, *, lasting: bool = True) -> None:
    """Write ``data`` to ``path``: afterwards the file is whole and on the disk, or as it was before.

    The folder must exist; of a link, what it leads to is replaced. What need not be ``lasting`` may be lost when the
    machine stops, and is written sooner. Raises OSError if the file cannot be written.
    """
    target = _regular(path)
    with scratch(target.parent) as folder:
        made = folder / "made"
        with open(made, "xb", buffering=0) as file:
            with contextlib.suppress(FileNotFoundError):
                os.fchmod(file.fileno(), stat.S_IMODE(os.stat(target).st_mode))
            view = memoryview(data)
            try:
                while view:
                    view = view[file.write(view) :]
                if lasting:
                    os.fsync(file.fileno())
            except OSError as error:  # a stream has no name
                error.filename = os.fspath(path)
                raise
        os.replace(made, target)
    if not lasting:
        return
    with contextlib.suppress(OSError):  # the new name goes to the disk too, where the file system can
        descriptor = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def make_folder(path: str | os.PathLike[str]) -> None:
    """Make the folder of a file to write. OSError, also where a ``~`` would become the name of a new folder."""
    folder = Path(path).parent
    if str(folder).startswith("~") and not folder.exists():
        raise OSError(errno.ENOENT, "there is no folder ~ here; os.path.expanduser gives the home folder", str(path))
    folder.mkdir(parents=True, exist_ok=True)


def check_writable(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]] = ()) -> None:
    """Raise the OSError that ``write_bytes`` would meet at once, or that of ``check_output``."""
    check_output(path, inputs)
    with scratch(_regular(path).parent):
        pass


def check_output(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]]) -> None:
    """Raise OSError if ``path`` is one of the files in ``inputs``, by whatever name."""
    if os.path.exists(path) and any(os.path.exists(given) and os.path.samefile(path, given) for given in inputs):
        raise OSError(errno.EINVAL, "is read by the same command, must be another file", os.fspath(path))


@contextlib.contextmanager
def scratch(beside: Path | None = None) -> Iterator[Path]:
    """A new folder in ``beside``, or in the folder for temporary files, that only this user may enter; then gone.

    For what a library can write to a file only. Raises OSError if it cannot be made.
    """
    parent = Path(tempfile.gettempdir()) if beside is None else beside
    _remove_leftovers(parent)
    for _ in range(_TRIALS):
        folder = parent / _PRIVATE.format(secrets.token_hex(8))
        folder.mkdir(mode=0o700)
        try:
            with _locked(folder, without=True) as own:
                if own:
                    yield folder
                    return
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    raise OSError(errno.EBUSY, "another process removes what is being written", os.fspath(parent))


@contextlib.contextmanager
def _locked(folder: Path, *, without: bool) -> Iterator[bool]:
    """Hold the lock of a private folder; False where another process has it, or has removed the folder. No waiting.

    ``without`` is what a file system that has no locks gives.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except FileNotFoundError:
        yield False
        return
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            held = os.path.exists(folder)
        except BlockingIOError:
            held = False
        except OSError:
            held = without
        yield held
    finally:
        os.close(descriptor)


@functools.cache
def _remove_leftovers(parent: Path) -> None:
    """Remove the private folders of this user's killed processes, once in each process and folder."""
    with contextlib.suppress(OSError), os.scandir(parent) as entries:
        for entry in entries:
            if not _LEFTOVER.fullmatch(entry.name) or entry.stat(follow_symlinks=False).st_uid != os.geteuid():
                continue
            with contextlib.suppress(OSError), _locked(Path(entry.path), without=False) as dead:
                if dead:
                    shutil.rmtree(entry.path, ignore_errors=True)


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
