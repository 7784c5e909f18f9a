"""Documents can be read where they are opened, and name modules, files, keys and messages that exist."""

from __future__ import annotations

import importlib
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import get_args

import pytest
from markdown_it import MarkdownIt
from places import ROOT
from printed import rounded

import granular_response as gr
from granular_response.cli import scene_reference
from granular_response.scene.scene import AnyPacking
from granular_response_paper.claims.claim import ClaimsError

sys.path.insert(0, str(ROOT / "docs"))
expand = importlib.import_module("expand")
pictures = importlib.import_module("pictures_of_pages")

PAGES = [*expand.documents(), ROOT / "data" / "README.md"]
#: Of a code host: CommonMark with tables, and nothing else.
HOST = MarkdownIt("commonmark").enable("table")
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]


class Targets(HTMLParser):
    """What HTML within a document leads to."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.found += [value for key, value in attrs if key in {"href", "src"}]


def tokens(text: str):
    """All tokens of a document, those within lines too."""
    for token in HOST.parse(text):
        yield token
        yield from token.children or ()


def html(text: str) -> Targets:
    found = Targets()
    found.feed("".join(token.content for token in tokens(text) if token.type in {"html_block", "html_inline"}))
    return found


def anchors(path: Path) -> set[str]:
    """The anchors that a code host gives to the headings of a document."""
    blocks = HOST.parse(path.read_text(encoding="utf-8"))
    titles = [blocks[k + 1] for k, token in enumerate(blocks) if token.type == "heading_open"]
    kept = {"text", "code_inline"}
    plain = ["".join(part.content for part in title.children if part.type in kept) for title in titles]
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in plain}


def broken(target: str, page: Path) -> bool:
    """Whether a link or a picture of a page leads nowhere; addresses of the web are not followed."""
    if re.match(r"https?://|mailto:", target):
        return False
    name, _, anchor = target.partition("#")
    path = (page.parent / name).resolve() if name else page
    if not path.exists() or ROOT not in [path, *path.parents]:
        return True
    return bool(anchor) and anchor not in anchors(path)


@pytest.mark.parametrize("name", NAMES)
def test_pictures_and_links_of_a_page_lead_somewhere(name):
    page = ROOT / name
    text = page.read_text(encoding="utf-8")
    targets = [token.attrs.get("href") or token.attrs.get("src") for token in tokens(text)
               if token.type in {"link_open", "image"}] + html(text).found  # fmt: skip
    assert [target for target in targets if broken(str(target), page)] == []


PLACES = [(name, place["name"]) for name, page in zip(NAMES, PAGES, strict=True)
          for place in expand.PLACE.finditer(page.read_text(encoding="utf-8"))]  # fmt: skip


@pytest.mark.parametrize(("name", "place"), PLACES)
def test_what_stands_in_a_place_is_what_makes_it(name, place):
    """``python docs/expand.py`` renews all places."""
    text = (ROOT / name).read_text(encoding="utf-8")
    (stands,) = [one[0] for one in expand.PLACE.finditer(text) if one["name"] == place]
    try:
        assert stands == expand.expanded(stands)
    except ClaimsError as error:  # a table of claims that is to be made anew
        pytest.skip(str(error))


def test_every_fragment_stands_in_a_page():
    fragments = {path.stem for path in expand.FRAGMENTS.glob("*.md")}
    assert fragments <= {place for _, place in PLACES}
    assert set(expand.MADE) <= {place for _, place in PLACES}


@pytest.mark.parametrize("name", pictures.pages())
def test_the_python_of_a_page_draws_and_prints_what_it_says(name, tmp_path, monkeypatch):
    with pictures.scratch():
        found = pictures.drawn(name, tmp_path)
    text = pictures.page(name).read_text(encoding="utf-8")
    assert found.files == pictures.images(name)
    assert [file for file in found.files if not pictures.same(tmp_path / file, pictures.FOLDER / file)] == []
    quoted = re.findall(r"```python\n(?:.*?)```(?:\n\n```text\n(.*?)```)?", text, re.DOTALL)
    assert [rounded(one) for one in found.printed] == [rounded(one) for one in quoted]


def test_every_kind_of_packing_has_a_section_and_a_public_name():
    kinds = set(get_args(AnyPacking))
    assert kinds == {section.model for section in scene_reference.sections() if section.place == "packing"}
    assert kinds <= {getattr(gr, name) for name in gr.__all__}


def test_descriptions_within_a_text_are_those_of_the_package():
    texts = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    calls = set(re.findall(r"`(gr\.[A-Z]\w*\([^`.]+[^`]*\))`", texts))
    assert {"gr.At(x=-10)", 'gr.Row(row="top", offset=-4)'} <= calls
    for call in calls:
        assert eval(call, {"gr": importlib.import_module("granular_response")}), call
