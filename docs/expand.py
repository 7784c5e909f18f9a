"""Generated parts of the documents, put in their places: ``python docs/expand.py`` renews all of them.

A place is a pair of comments in a Markdown file, ``<!-- generated: NAME -->`` and ``<!-- end -->``. What stands between
them is made from stored files and from the package, so that a reader of the plain file sees it: the table
``docs/_generated/NAME.md``, or what a function of ``MADE`` returns, or a class of ``tests/demonstration.py``.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from granular_response.cli.scene_reference import sections
from granular_response.errors import GranularError
from granular_response.scene import Scene
from granular_response_paper.report.markdown import table

ROOT = Path(__file__).resolve().parents[1]
FRAGMENTS = ROOT / "docs" / "_generated"
LAWS = ROOT / "tests" / "demonstration.py"
PLACE = re.compile(r"(?P<head><!-- generated: (?P<name>[\w-]+) -->)\n.*?(?P<end><!-- end -->)", re.DOTALL)

#: Claims behind the six findings of README.md.
FINDINGS = ("F4a", "R3a", "R5a", "K1a", "A1", "A5")
#: The largest number of claims that the gallery shows of a figure.
SHOWN = 2
FIGURES = range(1, 25)
UNJUDGED = "No statement of the paper is judged by it alone."


def documents() -> list[Path]:
    """All Markdown files that have places or may have some."""
    others = ("README.md", "figures/README.md", "benchmarks/README.md")
    return [*(ROOT / name for name in others), *sorted(ROOT.glob("docs/*.md"))]


def expanded(text: str) -> str:
    """A document with all of its places filled anew."""
    return PLACE.sub(lambda place: f"{place['head']}\n\n{filling(place['name'])}\n\n{place['end']}", text)


def filling(name: str) -> str:
    """What stands in a place. Raises KeyError for a name that nothing makes."""
    if name in MADE:
        return MADE[name]()
    if (fragment := FRAGMENTS / f"{name}.md").is_file():
        return fragment.read_text(encoding="utf-8").strip()
    return f"```python\n{source(name)}\n```"


def source(name: str) -> str:
    """A class of the demonstration, as it stands in its file."""
    text = LAWS.read_text(encoding="utf-8")
    classes = {node.name: node for node in ast.parse(text).body if isinstance(node, ast.ClassDef)}
    node = classes[name]
    first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
    return "\n".join(text.splitlines()[first - 1 : node.end_lineno])


@cache
def claims() -> dict[str, Any]:
    """The stored table of claims. Raises ClaimsError if it is not whole."""
    from granular_response_paper.claims import table

    return table.read(ROOT / table.OUTPUT)


def counts() -> str:
    """How many statements of the paper are supported: a list."""
    from granular_response_paper.claims.table import quoted

    return "\n".join(f"* {line}" for line in quoted(claims()).splitlines())


def findings() -> str:
    """Statements of the paper beside what was found, in a list that fits a phone."""
    rows = {row["id"]: row for row in claims()["table"]}
    return "\n".join(f"{k}. {judged(rows[name])}" for k, name in enumerate(FINDINGS, 1))


def judged(row: dict[str, Any]) -> str:
    """A claim in a line: the paper, here, the verdict, and in how many other preparations it holds."""
    named = {"gravity": "other gravity", "lattice": "other lattices"}
    other = [f"{what}: {row[key]['text']}" for key, what in named.items() if row[key]["of"]]
    line = f"**Paper:** {row['short'].rstrip('.')}. **Here:** {row['here']} *{row['verdict']}*"
    return f"{line} ({'; '.join(other)})" if other else line


def gallery() -> str:
    """A picture of each figure of the paper, with the claims on it and the command that draws it."""
    rows = [row for row in claims()["table"] if row["part"] != "extension" and row["row"] == "statement"]
    shown: set[str] = set()
    parts = []
    for figure in FIGURES:
        pictures = [picture for picture in captioned() if picture[2]["figure"] == figure]
        if not pictures:
            continue
        group, stem, caption = pictures[0]
        parts.append(f"## Fig. {figure}: {caption['title']}")
        alternative = caption["alternative"].replace('"', "'")
        parts.append(f'<a href="{group}/{stem}.png"><img src="{group}/{stem}.png" width="420" alt="{alternative}"></a>')
        about = sorted((row for row in rows if figure in row["figures"]), key=lambda row: row["id"] in shown)
        chosen = about[:SHOWN]
        shown |= {row["id"] for row in chosen}
        parts.append("\n".join(f"* {judged(row)}" for row in chosen) or f"* {UNJUDGED}")
        links = [f"[{other['title']}]({folder}/{name}.png)" for folder, name, other in pictures[1:]]
        more = f" More: {', '.join(links)}." if links else ""
        parts.append(f"`make figure FIGURE={figure}` draws it.{more}")
    return "\n\n".join(parts)


def captioned() -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Group, file stem and caption of each picture of a figure; the figure itself before its companions."""
    found = []
    for path in sorted((ROOT / "figures").glob("*/captions.json")):
        for stem, caption in json.loads(path.read_text(encoding="utf-8")).items():
            if caption["figure"] and path.with_name(f"{stem}.png").is_file():
                found.append((path.parent.name, stem, caption))
    yield from sorted(found, key=lambda one: (one[2]["figure"], not re.match(r"fig\d+_", one[1]), one[1]))


def public_names() -> str:
    """The public namespace: each name with the first sentence of its docstring."""
    gr = importlib.import_module("granular_response")
    own = {name: getattr(gr, name) for name in gr.__all__ if name != "__version__"}
    parts = []
    for title, prefix, names in (
        ("Functions", "gr.", {name: one for name, one in own.items() if inspect.isroutine(one)}),
        ("Classes", "gr.", {name: one for name, one in own.items() if inspect.isclass(one) and not _error(one)}),
        ("Methods of a result", "result.", _methods(gr.Result)),
        ("Pictures", "gr.plot.", {name: getattr(gr.plot, name) for name in gr.plot.__all__ if name[0].islower()}),
        ("Studies of a load path", "gr.studies.", {name: getattr(gr.studies, name) for name in gr.studies.__all__}),
        ("Modules", "gr.", {name: one for name, one in own.items() if inspect.ismodule(one)}),
        ("Errors", "gr.", {name: one for name, one in own.items() if _error(one)}),
    ):
        rows = [(f"`{prefix}{name}`", sentence(one)) for name, one in sorted(names.items())]
        parts += [f"## {title}", table(("name", "what it is"), rows)]
    return "\n\n".join(parts)


def _error(one: Any) -> bool:
    return inspect.isclass(one) and issubclass(one, Exception)


def _methods(cls: type) -> dict[str, Any]:
    return {name: one for name, one in vars(cls).items() if name[0] != "_" and inspect.getdoc(one)}


def sentence(one: Any) -> str:
    """The first sentence of a docstring, without the roles of Sphinx."""
    text = inspect.getdoc(one) or ""
    if inspect.isclass(one) and text.startswith(one.__name__ + "("):  # a named tuple without words of its own
        text = ""
    first = re.split(r"(?<!Fig)(?<!Sec)[.:;](?: |$)", " ".join(text.partition("\n\n")[0].split()))[0]
    return re.sub(r":\w+:`~?([^`]+)`", r"`\1`", first).replace("``", "`").replace("|", "\\|")


def goals() -> str:
    """What was measured beside the goals, from ``benchmarks/summary.json``."""
    found = json.loads((ROOT / "benchmarks" / "summary.json").read_text(encoding="utf-8"))["goals"]
    met = {True: "yes", False: "**no**"}
    rows = [(one["what"], one["goal"], one["measured"], met[one["met"]]) for one in found]
    return table(("", "goal", "measured", "met"), rows)


def scene_keys() -> str:
    """All keys of a scene, from their descriptions: the parts, then a table for each."""
    found = [table(("part", "meaning"), [(f"`{k}`", info.description or "") for k, info in Scene.model_fields.items()])]
    for section in sections():
        rows = [
            (
                f"`{key.path}`",
                f"`{key.default}`" if key.default else "must be given",
                f"{key.allowed} [{key.unit}]" if key.unit else key.allowed,
                key.meaning,
            )
            for key in section.listed()
        ]
        escaped = [[cell.replace("|", "\\|") for cell in row] for row in rows]  # a bar within a cell would end it
        found += [f"## {section.title}", table(("key", "default", "allowed [unit]", "meaning"), escaped)]
    return "\n\n".join(found)


MADE: dict[str, Callable[[], str]] = {
    "counts": counts,
    "goals": goals,
    "findings": findings,
    "figures-of-the-paper": gallery,
    "public-names": public_names,
    "scene-keys": scene_keys,
}


def main() -> None:
    for path in documents():
        text = path.read_text(encoding="utf-8")
        if (new := expanded(text)) != text:
            path.write_text(new, encoding="utf-8")
            print(f"renewed {path.relative_to(ROOT)}")


if __name__ == "__main__":
    try:
        main()
    except GranularError as error:
        raise SystemExit(f"docs/expand.py: {error}") from None
