"""The page a reader opens: verdicts, figures, readings, benchmarks, and how to run each part again.

One HTML file that needs no network: pictures, style and script are inside. It is made from files that the pipeline
stored, and has the same bytes for the same files.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
import xarray as xr

from granular_response import __version__
from granular_response.errors import GranularError
from granular_response.store import atomic, generated
from granular_response.store import files as store

from .. import captions
from ..claims import stored
from ..claims.verdict import key
from . import against, benchmarks, beyond, contents, explorer, pictures, readings
from .typeset import typeset

#: Where the page is kept.
OUTPUT = Path("figures") / "report.html"

#: Figure groups that the explorer shows, and the one whose table the readings come from.
EXPLORED = ("friction_linear_range", "explorer", "phase_diagram")
SENSITIVITY = "sensitivity"


class ReportError(GranularError):
    """Something the page is made from is missing or damaged. The message is one line."""


def write(
    output: str | os.PathLike[str] = OUTPUT,
    root: str | os.PathLike[str] = ".",
    keep: Sequence[str | os.PathLike[str]] = (),
) -> Path:
    """Make the page from ``figures/``, ``data/`` and ``benchmarks/`` below ``root``; returns its path.

    Raises ClaimsError, ReportError or StoreError for a table of claims, a ``captions.json`` or a dataset that cannot be
    read, OSError if the page cannot be written, or would replace one of the files it is made from or of those to
    ``keep``.
    """
    target = Path(output)
    folders = (Path(root) / name for name in ("figures", "data", "benchmarks"))
    used = [file for folder in folders for file in folder.rglob("*") if file.suffix != ".html"]
    # before the work; a folder is made when there is a page
    check = atomic.check_writable if target.parent.is_dir() else atomic.check_output
    check(target, [*used, Path(root) / "requirements.lock", *keep])
    made = page(Path(root), target.parent).encode()
    target.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_bytes(target, made)
    return target


def _of(group: str, lines: Callable[[Mapping[str, xr.Dataset]], str]) -> Callable[[Path], str]:
    """What makes lines of the datasets in a folder, of one group's."""
    return lambda data: lines(store.read(data / f"{group}.nc"))


#: By kind of document, the blocks of generated lines and what makes them from the folder of datasets.
BLOCKS: Mapping[str, Mapping[str, Callable[[Path], str]]] = {
    "notes": {readings.BLOCK: _of(SENSITIVITY, readings.markdown)},
    "figures": {against.BLOCK: against.markdown},
    "beyond": {group: _of(group, lines) for group, lines in beyond.BLOCKS.items()},
    "data": {contents.BLOCK: contents.markdown},
}


def renew(kind: str, document: str | os.PathLike[str], root: str | os.PathLike[str] = ".") -> None:
    """Renew the generated lines of a document from ``data/`` below ``root``; its ``kind`` is a key of :data:`BLOCKS`.

    Raises GeneratedError if it cannot be read or has no place for the lines, StoreError for a dataset that cannot be
    read, ReportError if a parameter is not the paper's and nothing says why.
    """
    for block, lines in BLOCKS[kind].items():
        try:
            made = lines(Path(root) / "data")
        except ValueError as error:
            raise ReportError(str(error)) from None
        generated.renew(document, block, made)


def page(root: Path, folder: Path | None = None) -> str:
    """The page as text. Figures, readings and benchmarks that are not there yet are left out or named as missing.

    Its links to files of the project, to those that are there, begin at ``folder``: by default ``figures/``.
    """
    claims = stored.read(root / stored.OUTPUT)
    try:
        shown = pictures.collect(root / "figures")
    except ValueError as error:
        raise ReportError(str(error)) from None
    paths = [root / "data" / f"{group}.nc" for group in (*EXPLORED, SENSITIVITY)]
    *explored, sensitivity = (store.read(path) if path.exists() else {} for path in paths)
    states = explorer.payload(*explored) if explored[0] else None
    numbers: dict[str, set[int]] = {row["group"]: set() for row in claims["table"]}
    for picture in shown.all():
        numbers.setdefault(picture.group, set()).update([picture.number] if picture.number else [])
    groups = [{"name": group, "figures": sorted(numbers[group])} for group in sorted(numbers)]
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["typeset"] = typeset
    template = environment.from_string(_resource("page.html.j2"))
    values = {
        "version": __version__,
        "size": _SIZE,
        "claims": claims,
        "verdicts": [(k["verdict"], key(k["verdict"])) for k in claims["verdicts"]],
        "parts": stored.PARTS,
        "numbers": range(1, captions.NUMBER_OF_FIGURES + 1),
        "first": shown.first,
        "overview": shown.overview,
        "questions": shown.questions,
        "claims_of": lambda picture: _claims_of(picture, shown.first, claims["table"]),
        "telling_of": telling,
        "linked": lambda picture: _linked(picture, root, root / OUTPUT.parent if folder is None else folder),
        "states": _json_in_html(states) if states else None,
        "explored": states and _choices(states["slabs"]),
        "readings": readings.table(sensitivity) if sensitivity else None,
        "benchmarks": benchmarks.collect(root / "benchmarks"),
        "goals": benchmarks.goals(root / "benchmarks"),
        "groups": groups,
        "versions": _versions(root / "requirements.lock"),
        "style": _resource("style.css"),
        "script": _resource("explorer.js"),
        "behaviour": _resource("page.js"),
    }
    try:
        text = template.render(values) + "\n"
    except jinja2.UndefinedError as error:
        raise ReportError(f"{root / stored.OUTPUT}: is not a whole table of claims: {error}") from None
    return text.replace(_SIZE, f"{len(text.encode()) / 1e6:.1f} MB")


def _claims_of(
    picture: pictures.Picture, first: Mapping[int, str], table: Sequence[Mapping[str, Any]]
) -> list[Mapping[str, Any]]:
    """What a picture shows: the claims of its figure, once, or those of its group that no figure of the paper shows."""
    if picture.number is None:
        return [row for row in table if row["group"] == picture.group and not row["figures"]]
    return [row for row in table if picture.number in row["figures"]] if first[picture.number] == picture.stem else []


#: Tests of a claim that the page lists.
LISTED = 3


def telling(tests: Sequence[Mapping[str, Any]]) -> Sequence[Mapping[str, Any]]:
    """The tests of a claim that the page lists: all of a few, else the first and those that do not hold."""
    if len(tests) <= LISTED:
        return tests
    first, *rest = tests
    failing = sorted(rest, key=lambda test: ("no", "cannot tell", "yes").index(test["outcome"]))
    return [first, *failing[: LISTED - 1]]


def _linked(picture: pictures.Picture, root: Path, start: Path) -> list[tuple[str, str]]:
    """The files of a picture that are there, in words, with their addresses from ``start``."""
    there = [(name, root / path) for name, path in picture.files if (root / path).exists()]
    return [(name, Path(os.path.relpath(path, start)).as_posix()) for name, path in there]


def _choices(slabs: Sequence[dict[str, Any]]) -> dict[str, list[float]]:
    """What the reader chooses between."""
    names = {"packings": "polydispersity", "frictions": "friction", "ratios": "ratio"}
    return {plural: sorted({slab[name] for slab in slabs}) for plural, name in names.items()}


#: Stands for the size of the page until the page is there.
_SIZE = "(size of the page)"

#: What the digits and the pictures come from.
_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "xarray", "netCDF4", "matplotlib", "dvc")


def _versions(lock: Path) -> list[tuple[str, str]]:
    """Names and pinned versions of the libraries that results depend on, none without the file."""
    if not lock.exists():
        return []
    pinned = dict(line.split("==") for line in lock.read_text(encoding="utf-8").split() if line.count("==") == 1)
    return [(name, pinned[name]) for name in _LIBRARIES if name in pinned]


def _resource(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _json_in_html(value: Any) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(value, separators=(",", ":")).replace("<", "\\u003c")
