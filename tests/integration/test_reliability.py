"""Kills, where only the order of writes keeps files whole, and the wheel."""

import contextlib
import io
import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
import zipfile
from multiprocessing.synchronize import Event
from pathlib import Path

import pytest
import yaml
from commands import PAPER, package_of, python
from places import ROOT

from granular_response.cli import main as cli
from granular_response_paper import cli as paper

SCENE = {
    "packing": {"kind": "slab", "layers": 5, "disks_per_row": 11},
    "contact": {"friction": 0.3},
    "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
}


def command(folder: str, arguments: list[str], moves: Event | None = None) -> None:
    """Run a command; ``moves`` is set once its disks do."""
    os.chdir(folder)
    if moves is not None:
        main = threading.get_ident()

        def look() -> None:
            while not any(frame.f_code.co_name == "relax" for frame, _ in traceback.walk_stack(frames()[main])):
                time.sleep(0.01)
            moves.set()

        frames = sys._current_frames
        threading.Thread(target=look, daemon=True).start()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in what a script runs in the background
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # and under nohup
    sys.argv = ["granular-response", *arguments]
    with contextlib.redirect_stdout(io.StringIO()):
        (paper if package_of(*arguments) == PAPER else cli).main()


@pytest.fixture(scope="module")
def processes():
    return multiprocessing.get_context("forkserver")  # starts in milliseconds, with everything imported


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_run_that_is_told_to_end_leaves_the_old_result(tmp_path, processes, number):
    endless = {**SCENE, "protocol": {"method": "dynamics", "ramp_time": 1e7, "maximum_steps": 10**12}}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(endless))
    (tmp_path / "result.nc").write_bytes(b"old")
    moves = processes.Event()
    run = processes.Process(target=command, args=(str(tmp_path), ["run", "scene.yaml", "-o", "result.nc"], moves))
    run.start()
    assert moves.wait(600.0)
    os.kill(run.pid, number)
    run.join(600.0)
    ended = run.exitcode
    run.kill()  # it would run for ever
    assert ended not in (0, None)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["result.nc", "scene.yaml"]
    assert (tmp_path / "result.nc").read_bytes() == b"old"


@pytest.mark.parametrize(
    ("project", "package"),
    [
        (ROOT, "src/granular_response"),
        (ROOT / "src" / "granular_response_paper", "src/granular_response_paper"),
        (ROOT / "extensions", "extensions/src/granular_response_extensions"),
    ],
    ids=["library", "reproduction", "extensions"],
)
def test_the_wheel_holds_every_module_of_its_package(tmp_path, project, package):
    pytest.importorskip("hatchling")
    python("-m", "hatchling", "build", "-t", "wheel", "-d", tmp_path, folder=project)
    (wheel,) = tmp_path.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    source = (ROOT / package).parent
    files = [path for path in (ROOT / package).rglob("*") if path.is_file() and path.suffix not in (".pyc", ".toml")]
    files = [path for path in files if "__pycache__" not in path.parts]
    assert {str(path.relative_to(source)) for path in files} <= names
    assert {name.partition("/")[0].partition("-")[0] for name in names} == {Path(package).name}
    assert not [name for name in names if "test" in name.lower() or name.endswith((".nc", ".pyc"))]
