"""The stages as they were run, with the hashes of what they read and wrote (``dvc.lock``), and files against these."""

from __future__ import annotations

import fnmatch
import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any

from granular_response.inputs import read_text
from granular_response.scene import SceneError, text
from granular_response_paper.archive import ArchiveError
from granular_response_paper.pipeline.reproduce import expanded

LOCK, PIPELINE, IGNORED = "dvc.lock", "dvc.yaml", ".dvcignore"


@dataclass(frozen=True)
class Item:
    """A file or a folder that a stage read or wrote, by its path in the project."""

    path: str
    md5: str
    size: int

    @property
    def folder(self) -> bool:
        return self.md5.endswith(".dir")


@dataclass(frozen=True)
class Stage:
    """A stage as it was run. ``parameters`` maps a parameter file to the values that were read from it, by key."""

    name: str
    command: str
    read: tuple[Item, ...]
    written: tuple[Item, ...]
    parameters: dict[str, dict[str, Any]]


def stages(root: Path) -> list[Stage]:
    """Every stage of the pipeline below ``root``, in the order of their names.

    Raises ArchiveError if a file of the pipeline cannot be read, or a stage has not been run.
    """
    locked = _section(root / LOCK)
    names = sorted(expanded(_section(root / PIPELINE)))
    missing = [name for name in names if name not in locked]
    if missing:
        raise ArchiveError(f"{root / LOCK}: stage {missing[0]} has not been run; make it with make reproduce")

    def items(entries: Iterable[dict[str, Any]]) -> tuple[Item, ...]:
        return tuple(Item(str(one["path"]), str(one["md5"]), int(one["size"])) for one in entries)

    try:
        return [
            Stage(name, str(one["cmd"]), items(one.get("deps", ())), items(one.get("outs", ())), one.get("params", {}))
            for name in names
            for one in [locked[name]]
        ]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ArchiveError(f"{root / LOCK}: is not a lock file of DVC 3: {error!r}") from None


def _section(path: Path) -> dict[str, Any]:
    found = _mapping(path, "is not a file of DVC with stages").get("stages")
    if not isinstance(found, dict):
        raise ArchiveError(f"{path}: is not a file of DVC with stages")
    return found


def _mapping(path: Path, otherwise: str = "") -> dict[str, Any]:
    """What a file of YAML holds, empty if that is no mapping; ``otherwise`` says what is wrong if it is no YAML."""
    try:
        found = text.read(read_text(path))
    except OSError as error:
        raise ArchiveError(f"{path}: cannot be read: {error.strerror}") from None
    except (SceneError, UnicodeDecodeError) as error:
        raise ArchiveError(f"{path}: {otherwise or error}") from None
    return found if isinstance(found, dict) else {}


def files(root: Path, path: str) -> list[str]:
    """The file at a path, or the files in that folder but those that ``.dvcignore`` names, by their paths in ``root``.

    Raises ArchiveError if nothing is there.
    """
    place = root / path
    if place.is_file():
        return [path]
    if not place.is_dir():
        raise ArchiveError(f"{place}: is missing; make reproduce makes it, or restore from an archive")
    patterns = read_text(root / IGNORED).splitlines() if (root / IGNORED).exists() else []
    patterns = [line.strip() for line in patterns if line.strip() and not line.startswith("#")]  # each one of names
    inside = (found.relative_to(place) for found in place.rglob("*") if found.is_file())
    return sorted(
        PurePosixPath(path, one.as_posix()).as_posix()
        for one in inside
        if not any(fnmatch.fnmatchcase(name, pattern) for name in one.parts for pattern in patterns)
    )


def md5(root: Path, path: str) -> str:
    """The hash of a file or a folder, as DVC makes it. Raises ArchiveError if nothing is there."""
    if (root / path).is_file():
        with (root / path).open("rb") as file:
            return hashlib.file_digest(file, "md5").hexdigest()
    names = {PurePosixPath(name).relative_to(path).as_posix(): name for name in files(root, path)}
    inside = [{"md5": md5(root, names[relative]), "relpath": relative} for relative in sorted(names)]
    return hashlib.md5(json.dumps(inside).encode()).hexdigest() + ".dir"


def check(root: Path, stages: list[Stage]) -> None:
    """Raise ArchiveError, naming the first file and stage, unless all files and parameters are those of the stages."""
    known, now = cache(lambda path: md5(root, path)), cache(lambda name: _mapping(root / name))
    for stage in stages:
        for item in (*stage.read, *stage.written):
            if known(item.path) != item.md5:
                raise ArchiveError(f"{root / item.path}: is not what stage {stage.name} had; make reproduce first")
        for name, values in stage.parameters.items():
            for key, value in values.items():
                if now(name).get(key) != value:
                    raise ArchiveError(f"{root / name}: {key} is not what stage {stage.name} had; make reproduce first")
