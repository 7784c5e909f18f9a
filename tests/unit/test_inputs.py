"""Files are opened to be read by one function, which looks at what it has opened."""

import ast
import os
from pathlib import Path

import pytest
from places import ROOT

import granular_response as gr
from granular_response import inputs
from granular_response.scene import FilePacking
from granular_response.scene.formats import SUFFIXES
from granular_response.sweeps.memory import MISSING, Memory

PACKAGE = ROOT / "src" / "granular_response"
#: What else reads files: of this package itself, of the kernel, or one that it has just written.
OWN = {
    "inputs.py", "cli/main.py", "machine/machine_code.py", "machine/memory.py", "plot/animation.py", "store/atomic.py",
    "store/export/gsd_file.py", "store/files.py",
}  # fmt: skip


def _make(kind: str, path: Path) -> None:
    """Something that is no regular file."""
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to(kind)


KINDS = ("pipe", "folder", "/dev/zero", "/nowhere")


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_no_file_is_refused_at_once(tmp_path, kind):
    """A pipe in a folder of checkpoints was waited for without end."""
    memory = Memory(tmp_path / "kept")
    memory.shelf.mkdir(parents=True)
    name = "0" * 32
    _make(kind, memory._path(name))
    assert memory.load(name) is MISSING
    with pytest.raises(OSError) as caught:
        inputs.read_bytes(memory._path(name))
    assert caught.value.filename == os.fspath(memory._path(name))
    for suffix in [".nc", ".yaml", *(suffixes[0] for suffixes in SUFFIXES.values())]:
        place = tmp_path / f"x{suffix}"
        _make(kind, place)
        with pytest.raises(gr.GranularError):
            if suffix == ".nc":
                gr.open_result(place)
            elif suffix == ".yaml":
                gr.Scene.from_yaml(place)
            else:
                FilePacking(path=str(place), width=1.0).build()


def test_nothing_else_opens_a_file_to_read():
    found = set()
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Call):
                called = node.func
                name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
                plain = isinstance(called, ast.Name) and name == "open"
                if plain or (isinstance(called, ast.Attribute) and name in ("read_bytes", "read_text")):
                    found.add(file.relative_to(PACKAGE).as_posix())
    assert found == OWN
