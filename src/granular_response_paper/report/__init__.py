"""The page a reader opens: the finding with the explorer, one plot of all numbers, and the chapters of the paper.

One HTML file that needs no network, beside it ``claims.html`` with every claim and its tests, and two pictures of the
claims. The page shows the pictures that stand beside it, or holds them if it is to be self-contained. All are made from
files that the pipeline stored, and have the same bytes for the same files.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import jinja2

from granular_response import __version__
from granular_response.errors import GranularError
from granular_response.plot import style
from granular_response.store import atomic
from granular_response.store import files as store

from ..claims import table
from ..registry import PAPER, Collection, group_member
from . import against, explorer, forest, markdown, pictures, readings
from .typeset import typeset

#: Where the page is kept, and the name of the page of claims beside it.
OUTPUT = Path("figures") / "report.html"
CLAIMS = "claims.html"

#: Figure groups whose datasets the explorer and the fragments read.
EXPLORED = ("friction_linear_range", "phase_diagram")
SENSITIVITY = "sensitivity"


class Finding(NamedTuple):
    """A claim whose sentence stands beside the explorer, and the state that shows it."""

    claim: str
    friction: float
    force: float


FINDINGS = (Finding("F4a", 0.0, 4.0), Finding("R3a", 0.2, 22.0), Finding("R2a", 1.0, 50.0), Finding("R5a", 1.0, 95.0))


class Chapter(NamedTuple):
    """A chapter of the paper: its question, the claim that answers it, and what it shows."""

    name: str
    title: str
    question: str
    answer: str
    figures: tuple[int, ...]
    others: tuple[str, ...] = ()  #: stems of pictures that belong to no figure of the paper


CHAPTERS = (
    Chapter("theory", "Theory", "What do continuum theories predict?", "A4", (1,)),
    Chapter("frictionless", "Without friction", "When does one peak become two?", "F4b", (3, 4, 5)),
    Chapter("friction", "With friction", "What does friction change?", "R9", (6, 7, 8, 9, 10, 11, 12, 13, 14, 15)),
    Chapter("large", "Large forces", "What breaks the symmetry of the response?", "R6d", (16,)),
    Chapter("piles", "Piles and torques", "Where do dips under piles come from, and how far do torques reach?", "P4",
            (17, 18)),
    Chapter("disorder", "Disorder", "What does disorder change?", "D6", (2, 19, 20, 21, 22, 23, 24),
            ("packings", "initial_lattice")),
)  # fmt: skip

#: The document whose first table has the questions of the extensions with their answers, and whose sections show the
#: picture of each.
ANSWERS = Path("docs") / "extensions.md"

#: Claims of the notes' first table, in its order.
RESULTS = (
    *("F4a", "F4b", "A4", "F8", "F7", "R1", "R3a", "R3b", "R4", "R2a", "R5a", "R7", "R6d", "R9", "A1", "A2", "F5"),
    *("N10", "R12", "K1a", "P1", "D1", "D7b", "A5", "D3b", "D6", "U4"),
)


#: Of the page, by collection.
TITLES = {
    "paper": "Friction, disorder and the response of granular solids to a localized force",
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
    """Make the page of a collection from ``figures/`` and ``data/`` below ``root``, with the page of claims and the
    pictures of the claims beside it; returns its path.

    Raises ClaimsError, ReportError or StoreError for a table of claims, a ``captions.json`` or a dataset that cannot be
    read, ReportError for the name of a file beside the page, OSError if a page cannot be written, or would replace one
    of the files it is made from.
    """
    target, base = Path(output), Path(root)
    if target.name in (CLAIMS, *forest.FILES):
        raise ReportError(f"{target}: is the name of a file that is written beside the page; choose another one")
    names = [target.name, CLAIMS, *(() if embedded else forest.FILES)]
    own = [base / OUTPUT.parent / name for name in (OUTPUT.name, *names[1:])]
    used = [file for folder in ("figures", "data") for file in (base / folder).rglob("*") if file not in own]
    # before the work; a folder is made when there is a page
    check = atomic.check_writable if target.parent.is_dir() else atomic.check_output
    for name in names:
        check(target.with_name(name), used)
    made = files(base, target.parent, collection=collection, embedded=embedded, name=target.name)
    target.parent.mkdir(parents=True, exist_ok=True)
    for name, content in made.items():
        atomic.write_bytes(target.with_name(name), content)
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


def files(
    root: Path,
    folder: Path | None = None,
    *,
    collection: Collection = PAPER,
    embedded: bool = False,
    name: str = OUTPUT.name,
) -> dict[str, bytes]:
    """The page, that of the claims, and the pictures of the claims unless the page holds them, by name.

    Pictures and datasets that are not there yet are left out. Links to files of the project, to those that are there,
    begin at ``folder``: by default ``figures/``; ``name`` is that of the page in it.
    """
    claims = table.read(root / table.OUTPUT)
    start = root / OUTPUT.parent if folder is None else folder
    try:
        shown = pictures.collect(root / "figures", start, embedded=embedded)
    except ValueError as error:
        raise ReportError(str(error)) from None
    own, checkout = collection == PAPER, root / os.path.relpath(".", collection.folder)
    paths = {group: root / "data" / f"{group}.nc" for group in EXPLORED if own}
    data = {group: store.read(path) for group, path in paths.items() if path.exists()}
    states = explorer.payload(*(data.get(group, {}) for group in EXPLORED)) if EXPLORED[0] in data else None
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_resource), autoescape=True, undefined=jinja2.StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    environment.filters |= {"typeset": typeset, "key": table.key}
    by_id = {row["id"]: row for row in claims["table"]}
    rows = claims["table"]
    statements = [row for row in rows if own and row["row"] == "statement"]
    failing = [row for row in statements if row["verdict"] == "not supported"]
    told = {row["id"] for row in failing} | {one.claim for one in FINDINGS} | {one.answer for one in CHAPTERS}
    findings = [(one, by_id[one.claim]) for one in FINDINGS if own and one.claim in by_id]
    drawn = forest.render(claims)
    values = {
        "version": __version__,
        "title": TITLES.get(collection.name, f"Figures of {collection.title}"),
        "paper": own,
        "page": name,
        "claims_page": CLAIMS,
        "claims": claims,
        "by_id": by_id,
        "verdicts": [(kind["verdict"], table.key(kind["verdict"])) for kind in claims["verdicts"]],
        "parts": {part: text for part, text in table.PARTS.items() if any(row["part"] == part for row in rows)},
        "findings": findings,
        "drawn": {file.removesuffix(".png"): pictures.address(drawn[file], file, embedded) for file in drawn},
        "overview": next((picture for picture in shown if picture.stem == "overview"), None),
        "chapters": [_chapter(one, shown, rows, told) for one in CHAPTERS if own],
        "questions": [] if own else _asked(answers(checkout / ANSWERS), shown, rows),
        "failing": failing,
        "moved": [row for row in statements if row["gravity"]["of"] and not row["gravity"]["holds"]],
        "told": told,
        "linked": lambda picture: _linked(picture, checkout, start),
        "states": _json_in_html(states) if states else None,
        "explored": states and sorted(slab["friction"] for slab in states["slabs"]),
        "style": _colours() + _resource("style.css"),
        "script": _resource("explorer.js"),
        "behaviour": _resource("page.js"),
    }
    try:
        texts = {made: environment.get_template(kind).render(values) for made, kind in
                 ((name, "page.html.j2"), (CLAIMS, "claims.html.j2"))}  # fmt: skip
    except jinja2.UndefinedError as error:
        raise ReportError(f"{root / table.OUTPUT}: is not a whole table of claims: {error}") from None
    return {made: f"{text}\n".encode() for made, text in texts.items()} | ({} if embedded else drawn)


Rows = Sequence[Mapping[str, Any]]
Answers = Sequence[tuple[str, str, str]]

#: Statements that stand under a figure: those that are not supported before others. All are on the page of claims.
LISTED = 3


def _chapter(chapter: Chapter, shown: Sequence[pictures.Picture], rows: Rows, told: set[str]) -> dict[str, Any]:
    """A chapter with its pictures by figure, the statements that each figure is the first to show, and how many more.

    Those that are ``told`` elsewhere on the page are named besides.
    """
    figures = []
    for number in chapter.figures:
        own = [picture for picture in shown if picture.number == number]
        first = [row for row in rows if row["row"] == "statement" and row["figures"][:1] == [number]]
        chosen = sorted((row for row in first if row["id"] not in told), key=lambda row: row["verdict"] == "supported")
        listed = [row for row in first if row["id"] in told or row in chosen[:LISTED]]
        figures.append((number, own, listed, len(first) - len(listed)))
    others = [picture for picture in shown if picture.stem in chapter.others]
    return {**chapter._asdict(), "figures": figures, "others": others}


def answers(document: Path) -> Answers:
    """Question, answer and the stem of its picture, as a document has them; none without the document.

    Its first table has questions, each a link to a section, and answers; the first picture of the section is shown.
    """
    text = document.read_text(encoding="utf-8") if document.exists() else ""
    sections = {_slug(part.partition("\n")[0]): part for part in text.split("\n## ")}
    found = []
    for question, anchor, answer in re.findall(r"^\| \[(.+?)\]\(#([\w-]+)\) \| (.+?) \|$", text, re.MULTILINE):
        picture = re.search(r"!\[[^]]*\]\([^)]*?([\w-]+)\.png\)", sections.get(anchor, ""))
        found.append((question, answer, picture[1] if picture else ""))
    return found


def _slug(heading: str) -> str:
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def _asked(known: Answers, shown: Sequence[pictures.Picture], rows: Rows) -> list[dict[str, Any]]:
    """The questions, without them every picture, with the claims of a picture's group at its first picture."""
    asked = known or [(picture.title, picture.message, picture.stem) for picture in shown]
    by_stem, told, found = {picture.stem: picture for picture in shown}, set(), []
    for question, answer, stem in asked:
        picture = by_stem.get(stem)
        own = [row for row in rows if picture and row["group"] == picture.group and row["id"] not in told]
        told |= {row["id"] for row in own}
        found.append({"question": question, "answer": answer, "picture": picture, "rows": own})
    return found


def _colours() -> str:
    """What colours mean in pictures of packings, as properties of the page."""
    light, dark = (" ".join(f"--{name}: {pair[k].lower()};" for name, pair in style.MEANINGS.items()) for k in range(2))
    return f":root {{ {light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"


def _linked(picture: pictures.Picture, checkout: Path, start: Path) -> list[tuple[str, str]]:
    """The files of a picture that are there, in words, with their addresses from ``start``."""
    there = [(name, checkout / path) for name, path in picture.files if (checkout / path).exists()]
    return [(name, Path(os.path.relpath(path, start)).as_posix()) for name, path in there]


def _resource(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _json_in_html(value: Any) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(value, separators=(",", ":")).replace("<", "\\u003c")
