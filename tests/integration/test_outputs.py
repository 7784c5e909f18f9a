"""What commands write: never over their inputs, never in place of what is no regular file."""

import errno
import os
import shutil
import stat
from pathlib import Path

import pytest
import xarray as xr
from commands import SCENE, refused, succeeded
from places import ROOT
from refusals import refuses

from granular_response.cli import main as cli
from granular_response.store import atomic
from granular_response.store import files as store
from granular_response.store.files import StoreError
from granular_response_paper import cli as paper
from granular_response_paper.claims import preparations

TABLE = "packing: {kind: file, path: disks.nc, width: 6}\ncontact: {friction: 0.0}\n"
#: For each command that writes: arguments, and those of its inputs that an output can be confused with.
COMMANDS = {
    "run": (["run", "table.yaml"], ["table.yaml", "disks.nc"]),
    "continue": (["continue", "result.nc", "--to", "2"], ["result.nc"]),
    "simulate": (["simulate", "theory", "--params", "params.yaml"], ["params.yaml"]),
    "draw": (["draw", "theory", "--data", "theory/fig01_predictions.png"], ["theory"]),
    "export": (["export", "result.nc"], ["result.nc"]),
    "plot": (["plot", "result.pdf"], ["result.pdf"]),
    "claims": (["claims"], ["data/torque.nc", "extensions/summary.nc"]),
}


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "table.yaml").write_text(TABLE)
    (folder / "disks.nc").write_text("x,z,radius\n2,1,1\n4,1,1\n")
    for name in ("data", "extensions", "figures", "theory"):
        (folder / name).mkdir()
    store.write(folder / "data" / "torque.nc", xr.Dataset())
    events = xr.Dataset({name: ("event", ["first_opening"]) for name in preparations.COLUMNS})
    for name, one in events.variables.items():
        one.attrs = {"long_name": name, "units": "1"}
    store.write(folder / "extensions" / "summary.nc", {"events": events}, {"group": "preparation"})
    for path in ("figures/claims.json", "figures/a.png"):
        (folder / path).write_text("{}")
    shutil.copy(ROOT / "params.yaml", folder)
    succeeded("run", "scene.yaml", "-o", "result.nc", folder=folder)
    shutil.copy(folder / "result.nc", folder / "result.pdf")
    succeeded("simulate", "theory", "--workers", 1, "-o", "theory/theory.nc", folder=folder)
    (folder / "theory" / "theory.nc").rename(folder / "theory" / "fig01_predictions.png")
    return folder


def test_every_command_that_writes_is_tried():
    writing = {
        command.name or command.callback.__name__
        for command in (*cli.commands.app.registered_commands, *paper.commands.app.registered_commands)
        if "output" in command.callback.__annotations__
    }
    assert writing == set(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_writes_over_its_inputs(inputs, tmp_path, command):
    arguments, read = COMMANDS[command]
    shutil.copytree(inputs, tmp_path, dirs_exist_ok=True)
    before = contents(tmp_path)
    for name in read:
        other = tmp_path / ("other" + Path(name).suffix)
        os.link(tmp_path / name, other) if (tmp_path / name).is_file() else other.symlink_to(name)
        for output in (name, other.name):
            refused(*arguments, "-o", output, folder=tmp_path)
        other.unlink()
        assert contents(tmp_path) == before


def test_an_animation_never_takes_the_place_of_its_result(inputs, tmp_path):
    shutil.copy(inputs / "result.nc", tmp_path)
    before = contents(tmp_path)
    assert "must be another" in refused("plot", "result.nc", "--animate", "result.nc", folder=tmp_path)
    assert contents(tmp_path) == before


@pytest.mark.parametrize(
    "arguments",
    [["run", "scene.yaml", "-o", "r.nc"], ["plot", "result.nc", "-o", "r.png", "--what", "packing"],
     ["plot", "further.nc", "--animate", "r.gif"], ["export", "result.nc", "-o", "r.csv"]],
    ids=lambda arguments: arguments[-1],
)  # fmt: skip
def test_missing_folders_are_made_but_none_that_should_be_home(inputs, tmp_path, arguments):
    shutil.copytree(inputs, tmp_path, dirs_exist_ok=True)
    if "further.nc" in arguments:
        succeeded("continue", "result.nc", "--to", "2", "-o", "further.nc", folder=tmp_path)
    *_, name = (one for one in arguments if one.startswith("r."))
    succeeded(*(f"new/folder/{name}" if one == name else one for one in arguments), folder=tmp_path)
    assert (tmp_path / "new" / "folder" / name).is_file()
    said = refused(*(f"~/{name}" if one == name else one for one in arguments), folder=tmp_path)
    assert f"~/{name}: cannot be written: there is no folder ~ here" in said
    assert not (tmp_path / "~").exists()


def test_a_link_is_followed_and_stays(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    target, link, new = tmp_path / "elsewhere" / "a.nc", tmp_path / "link.nc", tmp_path / "new.nc"
    target.write_text("old")
    target.chmod(0o600)
    link.symlink_to(target)
    new.symlink_to("elsewhere/b.nc")
    atomic.write_bytes(link, b"one")
    atomic.write_bytes(new, b"two")
    assert link.is_symlink() and new.is_symlink()
    assert target.read_bytes() == b"one" and (tmp_path / "elsewhere" / "b.nc").read_bytes() == b"two"
    assert stat.S_IMODE(target.stat().st_mode) == 0o600


def test_a_device_stays(tmp_path):
    link = tmp_path / "link.nc"
    link.symlink_to("/dev/null")
    refuses(StoreError, "cannot be written: is not a regular file", store.write, link, xr.Dataset())
    refuses(StoreError, "cannot be written: is not a regular file", store.check_writable, link)
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    assert [path.name for path in tmp_path.iterdir()] == ["link.nc"]


@pytest.mark.parametrize("ending", ["folder", "read-only"])
def test_what_was_computed_is_kept_where_its_file_cannot_be_written(tmp_path, monkeypatch, ending):
    """After a long run the name may be a folder, or the disk full."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    path = tmp_path / "out" / "a.nc"
    if ending == "folder":
        path.mkdir()
    else:
        write = atomic.write_bytes

        def full(target, *given, **kind):
            if Path(target).parent == path.parent:
                raise OSError(errno.EROFS, os.strerror(errno.EROFS))
            write(target, *given, **kind)

        monkeypatch.setattr(atomic, "write_bytes", full)
    data = xr.Dataset({"a": ("x", [1.0, 2.0], {"long_name": "a", "units": "1"})})
    with pytest.raises(StoreError) as caught:
        store.write(path, data, keep=True)
    said, _, place = str(caught.value).partition("; what was computed is kept as ")
    assert said.startswith(f"{path}: cannot be written: ") and Path(place).name.startswith("a.kept-")
    assert Path(place).parent == (path.parent if ending == "folder" else Path())
    xr.testing.assert_equal(store.read(place)[""], data)
    assert "what was computed" not in refuses(StoreError, None, store.write, path, data)
