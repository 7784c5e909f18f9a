"""The page a reader opens: results, figures, verdicts, interpretations, benchmarks, and how to run each part again.

One HTML file that needs no network. It shows the pictures that stand beside it, or holds them if it is to be
self-contained. It is made from files that the pipeline stored, and has the same bytes for the same files.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2

from granular_response import __version__
from granular_response.errors import GranularError
from granular_response.plot import style
from granular_response.store import atomic
from granular_response.store import files as store

from .. import captions
from ..claims import table
from ..registry import PAPER, Collection, group_member
from . import against, benchmarks, explorer, markdown, pictures, readings
from .typeset import typeset

#: Where the page is kept.
OUTPUT = Path("figures") / "report.html"

#: Figure groups whose datasets the page reads: those of the explorer, and that of the interpretations.
EXPLORED = ("friction_linear_range", "phase_diagram")
SENSITIVITY = "sensitivity"

#: Claims whose sentences stand first on the page: the result without friction, with friction, in disorder, and the
#: preparation.
FIRST = ("F4a", "R3a", "R5a", "A5")

#: Claims of the notes' first table, in its order.
RESULTS = (
    *("F4a", "F4b", "A4", "F8", "F7", "R1", "R3a", "R3b", "R4", "R2a", "R5a", "R7", "R6d", "R9", "A1", "A2", "F12"),
    *("N10", "R12", "K1a", "P1", "P2", "D1", "D7b", "A5", "D3b", "D6", "U4"),
)


#: Of the page, by collection.
TITLES = {
    "paper": "Response of granular solids to a localized force: what was reproduced",
    "extensions": "Response of granular solids to a localized force: beyond the paper",
}


class ReportError(GranularError):
    """Something the page is made from is missing or damaged. The message is one line."""


def datasets_read(collection: Collection) -> tuple[str, ...]:
    """The figure groups whose datasets the page of a collection or its fragments read."""
    if collection == PAPER:
        return tuple(sorted({*EXPLORED, SENSITIVITY, *(row.group for row in against.ROWS)}))
    return tuple(group for group in collection.groups if group_member(group, "tables", "markdown", optional=True))


def write(
    output: str | os.PathLike[str] = OUTPUT,
    root: str | os.PathLike[str] = ".",
    *,
    collection: Collection = PAPER,
    embedded: bool = False,
) -> Path:
    """Make the page of a collection from ``figures/``, ``data/`` and ``benchmarks/`` below ``root``; returns its path.

    Raises ClaimsError, ReportError or StoreError for a table of claims, a ``captions.json`` or a dataset that cannot be
    read, OSError if the page cannot be written, or would replace one of the files it is made from.
    """
    target = Path(output)
    folders = (Path(root) / name for name in ("figures", "data", "benchmarks"))
    used = [file for folder in folders for file in folder.rglob("*") if file.suffix != ".html"]
    # before the work; a folder is made when there is a page
    check = atomic.check_writable if target.parent.is_dir() else atomic.check_output
    check(target, [*used, Path(root) / "requirements.lock"])
    made = page(Path(root), target.parent, collection=collection, embedded=embedded).encode()
    target.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_bytes(target, made)
    return target


def fragments(root: Path, collection: Collection = PAPER) -> dict[str, Callable[[], str]]:
    """The tables that documents include, by file name, and what makes each from the datasets below ``root``."""
    data = root / "data"
    if collection == PAPER:
        return {
            "readings.md": lambda: readings.markdown(store.read(data / f"{SENSITIVITY}.nc")),
            "figures.md": lambda: against.markdown(data),
            "results.md": lambda: results(table.read(root / table.OUTPUT)),
        }
    tables = {group: group_member(group, "tables", "markdown", optional=True) for group in collection.groups}
    return {
        f"{group}.md": lambda group=group, made=made: made(store.read(data / f"{group}.nc"))  # type: ignore[misc]
        for group, made in tables.items()
        if made
    }


def results(claims: Mapping[str, Any]) -> str:
    """The table of the notes: statements of the paper in short, what is found, the verdict, other preparations."""
    by_id = {row["id"]: row for row in claims["table"]}
    rows = []
    for name in RESULTS:
        row = by_id[name]
        star = "*" if row["star"] else ""
        elsewhere = "; ".join(f"{what}: {row[what]['text']}" for what in ("gravity", "lattice") if row[what]["of"])
        rows.append((f"{row['short']} ({name})", row["here"], f"{row['verdict']}{star}", elsewhere or "not tried"))
    return markdown.table(("the paper", "here", "verdict", "other gravity or initial lattice"), rows)


def write_fragments(
    folder: str | os.PathLike[str], root: str | os.PathLike[str] = ".", *, collection: Collection = PAPER
) -> list[Path]:
    """Write the tables that documents include into a folder; returns the paths.

    Raises StoreError for a dataset that cannot be read, ReportError if a parameter is not the paper's and nothing says
    why, OSError if a file cannot be written.
    """
    try:
        made = {Path(folder) / name: lines() for name, lines in fragments(Path(root), collection).items()}
    except ValueError as error:
        raise ReportError(str(error)) from None
    for path, text in made.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        atomic.write_bytes(path, f"{text}\n".encode())
    return list(made)


def page(root: Path, folder: Path | None = None, *, collection: Collection = PAPER, embedded: bool = False) -> str:
    """The page as text. Figures, readings and benchmarks that are not there yet are left out or named as missing.

    Its links to files of the project, to those that are there, begin at ``folder``: by default ``figures/``.
    """
    claims = table.read(root / table.OUTPUT)
    start = root / OUTPUT.parent if folder is None else folder
    try:
        shown = pictures.collect(root / "figures", start, embedded=embedded)
    except ValueError as error:
        raise ReportError(str(error)) from None
    own = collection == PAPER
    paths = {group: root / "data" / f"{group}.nc" for group in (*EXPLORED, SENSITIVITY) if own}
    data = {group: store.read(path) for group, path in paths.items() if path.exists()}
    states = explorer.payload(*(data.get(group, {}) for group in EXPLORED)) if EXPLORED[0] in data else None
    numbers: dict[str, set[int]] = {row["group"]: set() for row in claims["table"]}
    for picture in shown.all():
        numbers.setdefault(picture.group, set()).update([picture.number] if picture.number else [])
    groups = [{"name": group, "figures": sorted(numbers[group])} for group in sorted(numbers)]
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["typeset"] = typeset
    template = environment.from_string(_resource("page.html.j2"))
    by_id = {row["id"]: row for row in claims["table"]}
    values = {
        "version": __version__,
        "size": _SIZE,
        "title": TITLES.get(collection.name, f"Figures of {collection.title}"),
        "paper": own,
        "folder": collection.folder,
        "embedded": embedded,
        "claims": claims,
        "verdicts": [(k["verdict"], table.key(k["verdict"])) for k in claims["verdicts"]],
        "parts": {part: text for part, text in table.PARTS.items() if any(r["part"] == part for r in claims["table"])},
        "results": [(by_id[name]["short"], by_id[name]) for name in FIRST if name in by_id],
        "numbers": range(1, captions.NUMBER_OF_FIGURES + 1),
        "first": shown.first,
        "overview": shown.overview,
        "figures": shown.figures,
        "questions": shown.questions,
        "claims_of": lambda picture: _claims_of(picture, shown.first, claims["table"]),
        "telling_of": telling,
        "linked": lambda picture: _linked(picture, root, start, collection),
        "states": _json_in_html(states) if states else None,
        "explored": states and sorted(slab["friction"] for slab in states["slabs"]),
        "readings": readings.table(data[SENSITIVITY]) if SENSITIVITY in data else None,
        "benchmarks": benchmarks.collect(root / "benchmarks", start, embedded=embedded) if own else [],
        "goals": benchmarks.goals(root / "benchmarks") if own else [],
        "groups": groups,
        "versions": _versions(root / os.path.relpath(".", collection.folder) / "requirements.lock"),
        "style": _colours() + _resource("style.css"),
        "script": _resource("explorer.js"),
        "behaviour": _resource("page.js"),
    }
    try:
        text = template.render(values) + "\n"
    except jinja2.UndefinedError as error:
        raise ReportError(f"{root / table.OUTPUT}: is not a whole table of claims: {error}") from None
    return text.replace(_SIZE, f"{len(text.encode()) / 1e6:.1f} MB")


def _colours() -> str:
    """What colours mean in pictures of packings, as properties of the page."""
    light, dark = (" ".join(f"--{name}: {pair[k].lower()};" for name, pair in style.MEANINGS.items()) for k in range(2))
    return f":root {{ {light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"


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


def _linked(picture: pictures.Picture, root: Path, start: Path, collection: Collection) -> list[tuple[str, str]]:
    """The files of a picture that are there, in words, with their addresses from ``start``."""
    base = root.joinpath(*[".."] * len(Path(collection.folder).parts))  # the folder of the checkout
    there = [(name, base / path) for name, path in picture.files if (base / path).exists()]
    return [(name, Path(os.path.relpath(path, start)).as_posix()) for name, path in there]


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
