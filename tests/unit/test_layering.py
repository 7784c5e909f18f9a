"""Who imports what, where import-linter has no word for it."""

import ast
import functools
import re
import sys
import tomllib
from pathlib import Path

from imported import imported
from places import ROOT, SOURCE

from granular_response.machine.machine_code import SOURCES

PACKAGE = SOURCE / "granular_response"
PAPER = SOURCE / "granular_response_paper"


def imported_by(part: Path) -> set[str]:
    """All that the files of a part import, types too."""
    paths = part.rglob("*.py") if part.is_dir() else [part]
    return {name for path in paths for name in imported(path, for_types=True)}


def outside_imports(part: Path) -> set[str]:
    """Packages that neither Python nor this project brings."""
    return {name.partition(".")[0] for name in imported_by(part)} - sys.stdlib_module_names - {PACKAGE.name, PAPER.name}


def test_the_library_imports_its_own_by_relative_names():
    absolute = re.compile(r"^\s*(from|import) granular_response", re.MULTILINE)
    assert [path for path in sorted(PACKAGE.rglob("*.py")) if absolute.search(path.read_text("utf-8"))] == []


def test_every_import_is_a_declared_dependency():
    of_others = {"pydantic_core", "cycler", "yaml", "PIL"}  # of pydantic and matplotlib; the packages pyyaml and pillow
    of_extras = {PACKAGE: {"distributed", "gsd"}, PAPER: {"rocrate"}}
    for project, package in ((ROOT, PACKAGE), (PAPER, PAPER)):
        described = tomllib.loads((project / "pyproject.toml").read_text())["project"]
        declared = {re.split("[>=]", name)[0].replace("-", "_") for name in described["dependencies"]}
        assert set(outside_imports(package)) <= declared | of_others | of_extras[package]


@functools.cache
def names_used(path: Path) -> set[str]:
    """Dotted names in a file, such as os.environ.update."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    return {ast.unparse(node) for node in nodes if isinstance(node, (ast.Attribute, ast.Subscript))} | {
        f"{ast.unparse(target.value)} is set"
        for node in nodes
        if isinstance(node, (ast.Assign, ast.Delete))
        for target in node.targets
        if isinstance(target, ast.Subscript)
    }


def test_only_the_entry_point_writes_the_environment():
    writing = {f"os.environ.{verb}" for verb in ("setdefault", "update", "pop", "clear")}
    writing |= {"os.environ is set", "os.putenv", "os.unsetenv"}
    found = {str(path.relative_to(SOURCE)) for path in SOURCE.rglob("*.py") if writing & names_used(path)}
    assert found == {"granular_response/machine/floating_point.py"}
    pinning = {str(p.relative_to(SOURCE)) for p in SOURCE.rglob("*.py") if "floating_point.pin" in names_used(p)}
    assert pinning == {"granular_response/cli/command_line.py"}


def test_pickles_go_to_workers_and_checkpoints_only():
    """A pickle runs code when it is read: from a file only what a sweep itself has kept (``sweeps/memory.py``)."""
    reads = {"pickle.load", "pickle.loads", "pickle.Unpickler", "cloudpickle.load", "cloudpickle.loads"}
    found = {str(p.relative_to(SOURCE)) for p in SOURCE.rglob("*.py") if reads & names_used(p)}
    assert found == {f"granular_response/sweeps/{name}.py" for name in ("executor", "memory")}
    imported = [p.read_text() for p in SOURCE.rglob("*.py") if "pickle import" in p.read_text()]
    assert imported == []


def test_only_scenes_ask_for_the_kind_of_a_packing():
    """What others need of a packing is data: its order, its neighbours, a smaller one of its kind."""
    asks = re.compile(r"(?<!\")\bpacking\.kind\b|isinstance\([^)]*(Slab|Pile|Lattice)Packing")
    paths = [path for path in SOURCE.rglob("*.py") if path.parent.name != "scene"]
    assert len(paths) > 100
    assert [path.name for path in paths if asks.search(path.read_text())] == []


def sources() -> dict[str, str]:
    """Text of every module, by its place in the library, or below ``src`` in the reproduction."""
    bases = ((PACKAGE, PACKAGE), (PAPER, SOURCE))
    return {p.relative_to(base).as_posix(): p.read_text() for top, base in bases for p in sorted(top.rglob("*.py"))}


def test_only_contact_laws_know_their_constants_by_place():
    """Everybody else asks a law by name."""
    asks = re.compile(r"(?<![_\w])law\[|\.law\[|_law\[")
    assert {name for name, text in sources().items() if asks.search(text)} == set()


def test_importing_deletes_nothing():
    removes = re.compile(r"\b(unlink|rmtree|os\.remove)\(")
    for name, text in sources().items():
        module = ast.parse(text)
        outside = [n for n in module.body if not isinstance(n, (ast.FunctionDef, ast.ClassDef))]
        assert not removes.search("\n".join(ast.unparse(node) for node in outside)), name


def test_compiled_modules_are_among_the_sources_that_name_the_machine_code():
    compiled = {name for name, text in sources().items() if re.search(r"^@kernel|^@by_type", text, re.MULTILINE)}
    assert len(compiled) > 8
    assert {name for name in compiled if not name.startswith(SOURCES)} == set()
