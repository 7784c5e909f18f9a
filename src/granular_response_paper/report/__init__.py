"""The page a reader opens: the finding with the explorer, one plot of all numbers, and the chapters of the paper.

One HTML file that needs no network, beside it ``claims.html`` with every claim and its tests, and two pictures of the
claims. All are made from files that the pipeline stored, and have the same bytes for the same files. ``page.yaml`` has
what the page says besides claims and captions.
"""

from __future__ import annotations

import io
import json
import os
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
from PIL import Image

from granular_response import __version__
from granular_response.errors import GranularError
from granular_response.plot import style
from granular_response.scene import text as yaml
from granular_response.store import atomic
from granular_response.store import files as store

from ..claims import table
from ..registry import PAPER, Collection, group_member
from . import against, explorer, forest, markdown, pictures, readings
from .typeset import typeset

#: The folder of figures, pages and claims.
FIGURES = table.OUTPUT.parent

#: The page, and that of the claims beside it.
PAGE, CLAIMS = "report.html", "claims.html"

#: Figure groups whose datasets the explorer reads.
EXPLORED = ("friction_linear_range", "phase_diagram")

#: The document whose first table has the questions of the extensions with their answers, and whose sections show the
#: picture of each.
ANSWERS = Path("docs") / "extensions.md"

#: Statements that stand under a figure: those that are not supported before others. All are on the page of claims.
LISTED = 3

Rows = Sequence[Mapping[str, Any]]
Answers = Sequence[tuple[str, str, str]]


class ReportError(GranularError):
    """Something the page is made from is missing or damaged. The message is one line."""


def _resource(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


SAID: Mapping[str, Any] = yaml.read(_resource("page.yaml"))


def write(root: Path = Path(), *, collection: Collection = PAPER) -> Path:
    """Write the page of a collection below its folder ``root``, and what stands beside it; returns its path.

    Raises ClaimsError, ReportError or StoreError for a table of claims or a dataset that cannot be read, OSError if a
    file cannot be written.
    """
    for name, content in files(root, collection).items():
        atomic.write_bytes(root / FIGURES / name, content)
    return root / FIGURES / PAGE


def results(claims: Mapping[str, Any]) -> str:
    """The table of the notes: statements of the paper in short, what is found, the verdict, other preparations."""
    by_id = {row["id"]: row for row in claims["table"]}
    rows = []
    for name in SAID["results"]:
        row = by_id[name]
        star = "*" if row["star"] else ""
        elsewhere = "; ".join(f"{what}: {row[what]['text']}" for what in ("gravity", "lattice") if row[what]["of"])
        rows.append((f"{row['short']} ({name})", row["here"], f"{row['verdict']}{star}", elsewhere or "not tried"))
    return markdown.table(("the paper", "here", "verdict", "other gravity or initial lattice"), rows)


def write_fragments(folder: Path, root: Path = Path(), *, collection: Collection = PAPER) -> list[Path]:
    """Write the tables that documents include into a folder, made from the datasets below ``root``; returns the paths.

    Raises StoreError for a dataset that cannot be read, ReportError if a parameter is not the paper's and nothing says
    why, OSError if a file cannot be written.
    """

    def stored(group: str) -> dict[str, Any]:
        return store.read(root / "data" / f"{group}.nc")

    try:
        if collection == PAPER:
            made = {
                "readings": readings.markdown(stored("sensitivity")),
                "figures": against.markdown(root / "data"),
                "results": results(table.read(root / table.OUTPUT)),
            }
        else:
            of = {group: group_member(group, "tables", "markdown", optional=True) for group in collection.groups}
            made = {group: markdown(stored(group)) for group, markdown in of.items() if markdown}
    except ValueError as error:
        raise ReportError(str(error)) from None
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in made.items():
        atomic.write_bytes(folder / f"{name}.md", f"{text}\n".encode())
    return [folder / f"{name}.md" for name in made]


def files(root: Path, collection: Collection = PAPER) -> dict[str, bytes]:
    """The page, that of the claims, and the pictures of the claims, by name.

    Pictures and datasets that are not there yet are left out, and so are links to files that are not.
    """
    claims, folder = table.read(root / table.OUTPUT), root / FIGURES
    shown = pictures.collect(folder)
    own, checkout = collection == PAPER, root / os.path.relpath(".", collection.folder)
    paths = [root / "data" / f"{group}.nc" for group in EXPLORED]
    states = explorer.payload(*map(store.read, paths)) if own and all(path.exists() for path in paths) else None
    rows = claims["table"]
    by_id = {row["id"]: row for row in rows}
    statements = [row for row in rows if own and row["row"] == "statement"]
    failing = [row for row in statements if row["verdict"] == "not supported"]
    told = {row["id"] for row in failing} | {one["claim"] for one in SAID["findings"]}
    told |= {one["answer"] for one in SAID["chapters"]}
    drawn = forest.render(claims)
    values = {
        "version": __version__,
        "title": SAID["titles"].get(collection.name, f"Figures of {collection.title}"),
        "paper": own,
        "claims": claims,
        "by_id": by_id,
        "verdicts": [(kind["verdict"], table.key(kind["verdict"])) for kind in claims["verdicts"]],
        "parts": {part: text for part, text in table.PARTS.items() if any(row["part"] == part for row in rows)},
        "findings": [(one, by_id[one["claim"]]) for one in SAID["findings"] if own and one["claim"] in by_id],
        "drawn": {file: Image.open(io.BytesIO(image)).size for file, image in drawn.items()},
        "overview": next((picture for picture in shown if picture.stem == "overview"), None),
        "chapters": [_chapter(one, shown, rows, told) for one in SAID["chapters"] if own],
        "questions": [] if own else _asked(answers(checkout / ANSWERS), shown, rows),
        "failing": failing,
        "moved": [row for row in statements if row["gravity"]["no"] and not row["gravity"]["holds"]],
        "told": told,
        "linked": lambda picture: _linked(picture, checkout, folder),
        # JSON that cannot end the script element it stands in
        "states": json.dumps(states, separators=(",", ":")).replace("<", "\\u003c") if states else None,
        "explored": states and sorted(slab["friction"] for slab in states["slabs"]),
        "style": _colours() + _resource("style.css"),
        "script": _resource("explorer.js"),
        "behaviour": _resource("page.js"),
    }
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_resource), autoescape=True, undefined=jinja2.StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    environment.filters |= {"typeset": typeset, "key": table.key}
    try:
        texts = {name: environment.get_template(f"{name}.j2").render(values) for name in (PAGE, CLAIMS)}
    except jinja2.UndefinedError as error:
        raise ReportError(f"{root / table.OUTPUT}: is not a whole table of claims: {error}") from None
    return {name: f"{text}\n".encode() for name, text in texts.items()} | drawn


def _chapter(
    chapter: Mapping[str, Any], shown: Sequence[pictures.Picture], rows: Rows, told: set[str]
) -> dict[str, Any]:
    """A chapter with its pictures by figure, the statements that each figure is the first to show, and how many more.

    Those that are ``told`` elsewhere on the page are named besides.
    """
    figures = []
    for number in chapter["figures"]:
        own = [picture for picture in shown if picture.number == number]
        first = [row for row in rows if row["row"] == "statement" and row["figures"][:1] == [number]]
        chosen = sorted((row for row in first if row["id"] not in told), key=lambda row: row["verdict"] == "supported")
        listed = [row for row in first if row["id"] in told or row in chosen[:LISTED]]
        figures.append((number, own, listed, len(first) - len(listed)))
    others = [picture for picture in shown if picture.stem in chapter["others"]]
    return {**chapter, "figures": figures, "others": others}


def answers(document: Path) -> Answers:
    """Question, answer and the stem of its picture, as a document has them; none without the document.

    Its first table has questions, each a link to a section, and answers; the first picture of the section is shown.
    """
    text = document.read_text(encoding="utf-8") if document.exists() else ""
    headed = {part.partition("\n")[0].strip().lower(): part for part in text.split("\n## ")}
    sections = {re.sub(r"[^\w\- ]", "", heading).replace(" ", "-"): part for heading, part in headed.items()}
    found = []
    for question, anchor, answer in re.findall(r"^\| \[(.+?)\]\(#([\w-]+)\) \| (.+?) \|$", text, re.MULTILINE):
        picture = re.search(r"!\[[^]]*\]\([^)]*?([\w-]+)\.png\)", sections.get(anchor, ""))
        found.append((question, answer, picture[1] if picture else ""))
    return found


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
