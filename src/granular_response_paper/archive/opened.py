"""The stored datasets as xarray, from a checkout or from an archive: a list of what there is, and one file opened.

``listed`` names the files of the figure groups (``data``) and of the survey (``survey/data``), ``load`` opens one, if
its hash is that in ``dvc.lock``. The lock is that of the checkout or of the archive: it shows damage, and that files
belong together, not who made them.
"""

from __future__ import annotations

import ast
import contextlib
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from granular_response.store import files as store
from granular_response_paper.archive import ArchiveError, lock, restore
from granular_response_paper.archive.lock import Item
from granular_response_paper.pipeline.imports import file_of
from granular_response_paper.registry import collections

#: Datasets of the survey are in git; the lock has the hash of their folder.
SURVEY = "survey/data"


@dataclass(frozen=True)
class Entry:
    """A file of datasets. ``md5`` is that of the file; ``dimensions`` are sizes by dataset and dimension."""

    path: str
    description: str
    dimensions: dict[str, dict[str, int]]
    md5: str


def listed(source: str = ".") -> list[Entry]:
    """What datasets there are in a checkout, or in an archive (path or address), in the order of their paths.

    Raises ArchiveError as :func:`load` does.

    Examples
    --------
    >>> from granular_response_paper.archive import opened  # doctest: +SKIP
    >>> {entry.path: entry.description for entry in opened.listed("granular-response.zip")}  # doctest: +SKIP
    """
    with _unpacked(source) as root:
        names = [name for name in _locked(root) if (root / name).exists()]
        return [_entry(root, name) for name in names]


def load(path: str, source: str = ".") -> dict[str, xr.Dataset]:
    """The datasets of one file by name, in memory; ``path`` as :func:`listed` has it, ``source`` as there.

    Raises ArchiveError if the source is no checkout or archive of the project or cannot be downloaded, or the file is
    not among its datasets or not the one of ``dvc.lock``; granular_response.store.files.StoreError if the file cannot
    be read.

    Examples
    --------
    >>> opened.load("survey/data/delta_10.nc")["packings"]["coordination_number"].mean("realization")  # doctest: +SKIP
    """
    with _unpacked(source) as root:
        known = _locked(root)
        if path not in known:
            raise ArchiveError(f"{path}: is no dataset of {source}, must be one of {', '.join(known)}")
        if lock.md5(root, known[path].path) != known[path].md5:
            raise ArchiveError(f"{source}: {known[path].path}: is not the one of {lock.LOCK}")
        return store.read(root / path)


def _locked(root: Path) -> dict[str, Item]:
    """What the lock has of each file of datasets: the file, or the folder of the survey."""
    found: dict[str, Item] = {}
    for stage in lock.stages(root):
        found |= {item.path: item for item in stage.written if item.path.endswith(store.SUFFIX)}
        for item in stage.read:
            if item.path == SURVEY and (root / SURVEY).is_dir():
                found |= {name: item for name in lock.files(root, SURVEY) if name.endswith(store.SUFFIX)}
    return dict(sorted(found.items()))


def _entry(root: Path, path: str) -> Entry:
    datasets, stem = store.read(root / path), Path(path).stem
    dimensions = {name: {str(d): size for d, size in one.sizes.items()} for name, one in datasets.items()}
    about = "Ensembles of slabs"
    package = next((one.package for one in collections() if stem in one.groups), "")
    if study := file_of(f"{package}.{stem}.simulate"):
        about = (ast.get_docstring(ast.parse(study.read_text("utf-8"))) or stem).split("\n\n")[0].replace("\n", " ")
    elif "ensembles" in datasets:
        cases = datasets["ensembles"]
        for name in [name for name in ("polydispersity", "friction") if name in cases.variables]:
            about += f", {name} " + ", ".join(f"{value:g}" for value in np.unique(cases[name]))
    return Entry(path, about if path.startswith("data/") else f"Survey: {about}", dimensions, lock.md5(root, path))


@contextlib.contextmanager
def _unpacked(source: str) -> Iterator[Path]:
    """The folder of a checkout, or that of an archive's datasets for as long as they are needed."""
    if Path(source).is_dir():
        yield Path(source)
        return
    with restore.local(source) as archive, tempfile.TemporaryDirectory() as folder:
        try:
            with zipfile.ZipFile(archive) as file:
                names = [n for n in file.namelist() if n in (lock.LOCK, lock.PIPELINE) or n.endswith(store.SUFFIX)]
                file.extractall(folder, names)  # which leads no name out of the folder
        except (OSError, *restore.DAMAGED) as error:
            raise ArchiveError(f"{source}: is no checkout, and no archive that can be read: {error}") from error
        yield Path(folder)
