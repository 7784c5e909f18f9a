"""Documents name modules, files, keys and messages that exist."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import re
from functools import cache

import pytest
from places import ROOT
from printed import rounded

from granular_response.cli import scene_reference
from granular_response.scene import FilePacking, LaboratoryUnits, Scene, SceneError
from granular_response.scene.base import UNITS
from granular_response.scene.material import Contact
from granular_response.scene.motion import Motion
from granular_response.scene.protocol import Taps

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_named_modules_and_links_exist(page):
    text = page.read_text(encoding="utf-8")
    modules = re.findall(r"`((?:src/)?[a-z_]+/[a-z_/]+\.py)`", text)
    groups = [*(ROOT / "src" / "granular_response_paper" / "groups").iterdir()]  # files of any figure group
    places = [ROOT, ROOT / "src", ROOT / "src" / "granular_response", *groups]
    missing = [name for name in modules if not any((place / name).exists() for place in places)]
    links = re.findall(r"\]\((?!https?:|#|mailto:)([^)#]+)", text)
    links += re.findall(r"```{include} (.*)", text)
    missing += [link for link in links if not (page.parent / link).exists()]
    assert not missing


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


def test_every_page_is_on_the_site():
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    listed = {line for block in re.findall(r"```{toctree}\n(.*?)```", index, re.DOTALL) for line in block.split()}
    assert {page.stem for page in (ROOT / "docs").glob("*.md")} - {"index"} <= listed


@cache
def texts_of_the_sources() -> str:
    """Every string of the package, one a line; where a formatted one has a value there is a NUL."""
    found = []
    for path in sorted((ROOT / "src").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                found.append("".join(p.value if isinstance(p, ast.Constant) else "\0" for p in node.values))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.append(" ".join(node.value.splitlines()))
    return "\n".join(found)


def quoted_messages() -> list[str]:
    text = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
    return re.findall(r"^\| \*([^*]+)\* \|", text, re.MULTILINE)


@pytest.mark.parametrize("message", quoted_messages())
def test_quoted_messages_are_those_of_the_code(message):
    parts = [re.escape(part.strip()) for part in message.split("...") if part.strip()]
    assert parts and re.search("[^\n]*".join(parts), texts_of_the_sources())


def test_several_messages_are_quoted():
    assert len(quoted_messages()) >= 5


def test_the_reference_of_the_scene_keys_is_current():
    page = (ROOT / "docs" / "_generated" / "scene-keys.md").read_text(encoding="utf-8")
    assert page == f"{scene_reference.lines()}\n", "granular-response keys --page docs/_generated/scene-keys.md"


def paths_of(data: object, place: str = "") -> set[str]:
    """All paths of a scene as a dict, with [] for the items of a list of mappings."""
    if isinstance(data, dict):
        return {path for name, value in data.items() for path in paths_of(value, f"{place}.{name}".lstrip("."))}
    if isinstance(data, list) and data and isinstance(data[0], dict):
        return {path for value in data for path in paths_of(value, f"{place}[]")}
    return {place}


def test_the_reference_has_every_key_of_every_kind_of_scene():
    known = {key.path for key in scene_reference.every()}
    packings = (
        {"kind": "slab"},
        {"kind": "pile"},
        {"kind": "file", "path": "disks.csv", "width": 9.0},
    )
    loads = [
        {"disk": {"row": "top"}, "force": [0.0, -1.0]},
        {"disk": {"x": -4.0}, "force": [0.0, -1.0]},
        {"disk": 3, "displacement": [None, -0.01]},
    ]
    scenes = [Scene.from_dict({"packing": packing, "loads": loads}) for packing in packings]
    scenes.append(Scene.from_dict({"packing": {"kind": "poured"}}))
    scenes.append(Scene.from_arrays([1.0], [1.0], 1.0))
    # written only where they are not the default
    sparse = {f"{part}.{name}" for part in ("contact", "wall") for name in Contact.sparse} - {"wall.parameters"}
    sparse |= {f"motion.{name}" for name in Motion.sparse} | {"preparation.taps"}
    sparse |= {f"preparation.taps.{name}" for name in Taps.model_fields}
    sparse |= {f"packing.{name}" for name in FilePacking.sparse}
    assert set().union(sparse, *(paths_of(scene.to_dict()) for scene in scenes)) == known


def test_the_reference_says_what_the_scene_allows():
    keys = {key.path: key for key in scene_reference.every()}
    with pytest.raises(SceneError) as caught:
        Scene.from_dict({"contact": {"friction": -1}})
    assert str(caught.value).endswith(f"must be {keys['contact.friction'].allowed}")
    assert keys["wall.normal_stiffness"].allowed.endswith(", or null")
    assert Scene.from_text(f"contact: {{normal_stiffness: {keys['contact.normal_stiffness'].default}}}") == Scene()
    assert not keys["loads[].disk"].default and not keys["packing.kind"].default
    assert keys["loads[].force"].unit == "mg"
    assert keys["loads[].displacement"].unit == keys["loads[].disk.x"].unit == "mean radius"


def test_units_are_given_for_keys_that_exist():
    names = {key.path.rpartition(".")[2] for key in scene_reference.every()}
    assert set(UNITS) <= names


def test_laboratory_units_are_as_the_page_says():
    text = (ROOT / "docs" / "packings.md").read_text(encoding="utf-8")
    code = re.search(r"## Laboratory units.*?```python\n(.*?)```", text, re.DOTALL)
    assert code
    names: dict = {}
    for line in code[1].splitlines():
        expression, _, said = line.partition("  # ")
        if not said:
            exec(line, names)
        else:
            assert eval(expression, names) == pytest.approx(float(said.split()[0]), rel=5e-3), line
    assert isinstance(names["units"], LaboratoryUnits)


def docstrings() -> list[tuple[str, str]]:
    """Every docstring of the package with the file it stands in."""
    found = []
    for path in sorted((ROOT / "src").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and (text := ast.get_docstring(node)):
                found.append((path.relative_to(ROOT).as_posix(), text))
    return found


def test_what_docstrings_name_by_its_full_address_is_there():
    named = {(file, name) for file, text in docstrings() for name in re.findall(r"granular_response(?:\.\w+)+", text)}
    assert len(named) > 20
    missing = []
    for file, name in sorted(named):
        try:
            pkgutil.resolve_name(name)
        except (ImportError, AttributeError):
            missing.append(f"{file}: {name}")
    assert missing == []
