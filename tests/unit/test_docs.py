"""Documents name modules, files, keys and messages that exist."""

from __future__ import annotations

import importlib
import re

import pytest
from places import ROOT
from printed import rounded

from granular_response.cli import scene_reference
from granular_response.scene import Scene, SceneError

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


#: Pages whose blocks of Python run in turn, when the site is built and here.
RUN = sorted(page.stem for page in PAGES if "<!-- picture: " in page.read_text(encoding="utf-8"))


@pytest.mark.parametrize("page", RUN)
def test_the_python_of_a_page_draws_and_prints_what_it_says(page, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    found = importlib.import_module("pictures_of_pages").drawn(page, text, tmp_path)
    pictures = re.findall(r"```{image} _drawn/(\S+)", found.text)
    assert len(pictures) >= text.count("<!-- picture: ") and "<!-- picture: " not in found.text
    assert all((tmp_path / name).stat().st_size > 1000 for name in pictures)
    quoted = re.findall(r"```python\n(?:.*?)```(?:\n\n```text\n(.*?)```)?", text, re.DOTALL)
    assert [rounded(one) for one in found.printed] == [rounded(one) for one in quoted]


def test_the_readme_prints_what_it_says(tmp_path, monkeypatch, capsys):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    ((code, printed),) = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", text, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "README.md", "exec"), {})
    assert rounded(capsys.readouterr().out) == rounded(printed)
    assert (tmp_path / "response.png").stat().st_size > 1000


def test_the_reference_of_the_scene_keys_is_current(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    made = importlib.import_module("scene_keys")
    assert made.PAGE.read_text(encoding="utf-8") == made.lines(), "python docs/scene_keys.py"


def test_the_reference_says_what_the_scene_allows():
    keys = {key.path: key for section in scene_reference.sections() for key in section.listed()}
    with pytest.raises(SceneError) as caught:
        Scene.from_dict({"contact": {"friction": -1}})
    assert str(caught.value).endswith(f"must be {keys['contact.friction'].allowed}")
    assert keys["wall.normal_stiffness"].allowed.endswith(", or null")
    assert Scene.from_text(f"contact: {{normal_stiffness: {keys['contact.normal_stiffness'].default}}}") == Scene()
    assert not keys["loads[].disk"].default and not keys["packing.kind"].default
    assert keys["loads[].force"].unit == "mg"
    assert keys["loads[].displacement"].unit == keys["loads[].disk.x"].unit == "mean radius"


def test_descriptions_within_a_text_are_those_of_the_package():
    texts = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    calls = set(re.findall(r"`(gr\.[A-Z]\w*\([^`.]+[^`]*\))`", texts))
    assert {"gr.At(x=-10)", 'gr.Row(row="top", offset=-4)'} <= calls
    for call in calls:
        assert eval(call, {"gr": importlib.import_module("granular_response")}), call
