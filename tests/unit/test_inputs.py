"""Files are opened to be read by one function, which looks at what it has opened."""

import os
from pathlib import Path

import pytest

import granular_response as gr
from granular_response import inputs
from granular_response.scene import FilePacking
from granular_response.scene.formats import SUFFIXES
from granular_response.sweeps.memory import MISSING, Memory


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
