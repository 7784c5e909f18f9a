"""Datasets out of an archive, if they are those of this checkout."""

from __future__ import annotations

import contextlib
import hashlib
import lzma
import shutil
import tempfile
import urllib.request
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

from granular_response.inputs import check_regular
from granular_response.store import atomic
from granular_response.store import files as store
from granular_response_paper.archive import ArchiveError, lock
from granular_response_paper.archive.lock import Item

#: What reading an archive may raise that is damaged, or none.
DAMAGED = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, NotImplementedError, RuntimeError)


@contextlib.contextmanager
def local(archive: str) -> Iterator[Path]:
    """The archive as a file: downloaded for as long as it is needed where ``archive`` is an address.

    Raises ArchiveError if it cannot be downloaded. What is downloaded is checked as any other file is.
    """
    if "://" not in archive:
        yield Path(archive)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "archive.zip")
        try:
            with urllib.request.urlopen(archive, timeout=60.0) as found, path.open("wb") as file:
                shutil.copyfileobj(found, file)
        except (OSError, ValueError) as error:
            raise ArchiveError(f"{archive}: cannot be downloaded: {getattr(error, 'reason', error)}") from error
        yield path


def restore(archive: Path, root: Path = Path(".")) -> list[str]:
    """Bring the datasets that ``dvc.lock`` names from an archive; returns the paths of those that were not there.

    Nothing is written before all of them have been checked, and nothing else that the archive holds. A dataset that is
    there already stays.

    Raises ArchiveError if the archive is damaged, if a dataset is missing from it or is not the one that ``dvc.lock``
    names, or if another one stands in its place; OSError if the archive cannot be read or a dataset not be written.
    """
    items = [item for stage in lock.stages(root) for item in stage.written if item.path.endswith(store.SUFFIX)]
    check_regular(archive)
    try:
        with zipfile.ZipFile(archive) as file:
            wanted = [item for item in items if not _is_there(root, item)]
            for item in items:
                _content(archive, file, item)
            for item in wanted:
                target = root / item.path
                target.parent.mkdir(parents=True, exist_ok=True)
                atomic.write_bytes(target, _content(archive, file, item))
    except DAMAGED as error:
        raise ArchiveError(f"{archive}: is no zip file, or a damaged one: {error}") from error
    return [item.path for item in wanted]


def _is_there(root: Path, item: Item) -> bool:
    there = (root / item.path).exists()
    if there and lock.md5(root, item.path) != item.md5:
        raise ArchiveError(
            f"{root / item.path}: is there already and is not the one of {lock.LOCK}; move it away to restore that one"
        )
    return there


def _content(archive: Path, file: zipfile.ZipFile, item: Item) -> bytes:
    """What a member holds, which is what ``dvc.lock`` names; no more of it than that is unpacked."""
    try:
        member = file.getinfo(item.path)
    except KeyError:
        raise ArchiveError(f"{archive}: holds no {item.path}") from None
    with file.open(member) as opened:
        content = opened.read(item.size + 1)
    found = hashlib.md5(content).hexdigest()
    if len(content) != item.size or found != item.md5:
        raise ArchiveError(
            f"{archive}: {item.path}: is not the one of {lock.LOCK}, which has {item.size} bytes with md5 {item.md5}; "
            "the archive is of another state of the project, or damaged"
        )
    return content
