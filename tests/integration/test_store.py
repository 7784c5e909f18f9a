"""Datasets on disk: whole or not there, equal after a round trip, equal bytes for equal data."""

import os
import tempfile
import time
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from commands import python
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from refusals import refuses

from granular_response import __version__
from granular_response.store import atomic
from granular_response.store import files as store
from granular_response.store.files import StoreError

LABEL = {"long_name": "a quantity", "units": "1"}
KILLS = int(os.environ.get("GRANULAR_RESPONSE_KILLS", "8"))


def dataset(seed: int = 0, size: int = 500) -> xr.Dataset:
    generator = np.random.default_rng(seed)
    return xr.Dataset(
        {
            "floor_force": ("floor_disk", generator.normal(size=size), LABEL),
            "status": ("floor_disk", generator.integers(0, 3, size).astype(np.int8), LABEL),
            "open": ("floor_disk", generator.random(size) < 0.5, LABEL),
            "name": ("end", np.array(["left", "right"]), LABEL),
            "total": ((), 3.5, LABEL),
            "duration": ("floor_disk", generator.random(size), {"long_name": "time", "units": "seconds"}),
        },
        coords={
            "floor_disk": ("floor_disk", np.arange(size), LABEL),
            "x": ("floor_disk", np.linspace(-1, 1, size), LABEL),
        },
        attrs={"method": "auto", "residual": 1e-11, "count": 3, "loads": [1.0, 2.0]},
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "data" / "result.nc"


def test_one_dataset_comes_back(path):
    store.write(path, dataset(), {"note": "gravity only"})
    back = store.read(path)
    assert list(back) == [""]
    xr.testing.assert_equal(back[""], dataset())
    for name, variable in dataset().variables.items():
        assert back[""][name].dtype.kind == variable.dtype.kind
        assert back[""][name].attrs == variable.attrs
    assert set(back[""].coords) == {"floor_disk", "x"}
    attributes = store.read_attributes(path)
    assert attributes["note"] == "gravity only"
    assert attributes["package_version"] == __version__
    assert attributes["residual"] == 1e-11


def test_bytes_depend_on_the_data_alone(path, tmp_path):
    store.write(path, {"a": dataset(1), "b": dataset(2)})
    script = (
        "import sys; sys.path.insert(0, sys.argv[1]); from test_store import *;"
        "store.write(sys.argv[2], {'a': dataset(1), 'b': dataset(2)})"
    )
    other = tmp_path / "other.nc"
    time.sleep(1.1)  # HDF5 counts time in whole seconds
    python("-c", script, Path(__file__).parent, other)
    assert other.read_bytes() == path.read_bytes()
    store.write(other, {"a": dataset(1), "b": dataset(3)})
    assert other.read_bytes() != path.read_bytes()


def test_what_no_file_can_hold_and_variables_without_labels_are_named(path):
    bad = dataset()
    del bad["x"].attrs["units"]
    refuses(StoreError, "result.nc: variable rest/x needs the attribute units", store.write, path, {"rest": bad})
    refuses(StoreError, "tricky", store.write, path, dataset().assign_attrs(tricky=None))
    assert not path.exists()


def test_missing_and_foreign_files(path, tmp_path):
    refuses(StoreError, "no such file", store.read, path)
    refuses(StoreError, "cannot be read: Is a directory", store.read, tmp_path)
    (tmp_path / "empty.nc").touch()
    refuses(StoreError, "is empty", store.read, tmp_path / "empty.nc")
    (tmp_path / "text.nc").write_text("x,z,radius\n")
    refuses(StoreError, "not a netCDF-4 file", store.read, tmp_path / "text.nc")
    with netCDF4.Dataset(tmp_path / "classic.nc", "w", format="NETCDF3_CLASSIC"):
        pass
    refuses(StoreError, "not a netCDF-4 file", store.read, tmp_path / "classic.nc")
    (tmp_path / "packed.nc").write_bytes(b"\x1f\x8b\x08")
    refuses(StoreError, r"not a netCDF-4 file, it is compressed \(gzip\)", store.read, tmp_path / "packed.nc")
    with netCDF4.Dataset(tmp_path / "foreign.nc", "w") as file:
        file.createDimension("n", 3)
    refuses(StoreError, "not written by granular_response", store.read, tmp_path / "foreign.nc")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of a file with two datasets."""
    path = tmp_path_factory.mktemp("whole") / "result.nc"
    store.write(path, {"a": dataset(1), "b": dataset(2)})
    assert store.read(path)
    return path.read_bytes()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(cut=st.floats(0.0, 1.0), place=st.floats(0.0, 0.999), flip=st.integers(1, 255))
@example(cut=0.0, place=0.0, flip=1)
@example(cut=1.0, place=0.0, flip=1)
def test_a_damaged_file_is_never_read(tmp_path, whole, cut, place, flip):
    """Truncated anywhere, but for nothing left, or with bits of one byte the other way round."""
    path = tmp_path / "damaged.nc"
    path.write_bytes(whole[: 1 + int(cut * (len(whole) - 2))])
    refuses(StoreError, r"damaged.nc: is truncated or damaged", store.read, path)
    damaged = bytearray(whole)
    damaged[int(place * len(whole))] ^= flip
    path.write_bytes(damaged)
    refuses(StoreError, None, store.read, path)


@pytest.fixture
def next_run():
    """What a process does once for each folder is done again, as by another process."""
    atomic._remove_leftovers.cache_clear()


LEFT = ".granular-0123456789abcdef.partial"


def test_what_others_planted_stays_as_it_is(tmp_path, next_run):
    """A link under the name of a temporary file once emptied somebody else's file, a pipe there waited for ever."""
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "victim").write_bytes(b"precious")
    here = tmp_path / "here"
    here.mkdir()
    (here / ".a.nc.partial").symlink_to(precious / "victim")
    os.mkfifo(here / ".b.nc.partial")
    (here / LEFT).symlink_to(precious)
    os.mkfifo(here / LEFT.replace("0", "1"))
    for name in ("a.nc", "b.nc"):
        atomic.write_bytes(here / name, name.encode())
        assert (here / name).read_bytes() == name.encode() and not (here / name).is_symlink()
    assert (precious / "victim").read_bytes() == b"precious"
    assert len(list(here.iterdir())) == 6


def test_what_a_killed_process_left_is_removed_by_the_next_run_and_no_living_one_is_met(tmp_path, next_run):
    (tmp_path / LEFT).mkdir()
    (tmp_path / LEFT / "made").write_bytes(b"half")
    with atomic.scratch(tmp_path) as living:
        assert not (tmp_path / LEFT).exists()
        atomic._remove_leftovers.cache_clear()
        atomic.write_bytes(tmp_path / "a.nc", b"whole")
        assert living.stat().st_mode & 0o777 == 0o700
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.nc"]


def test_an_interrupted_write_leaves_nothing(tmp_path, monkeypatch):
    atomic.write_bytes(tmp_path / "a.nc", b"old")

    def interrupted(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", interrupted)
        with pytest.raises(KeyboardInterrupt):
            atomic.write_bytes(tmp_path / "a.nc", b"new")
    assert [(entry.name, entry.read_bytes()) for entry in tmp_path.iterdir()] == [("a.nc", b"old")]


KILL_LOOP = """
import os, random, signal, sys, tempfile, time
sys.path.insert(0, sys.argv[1])
from pathlib import Path
from test_store import dataset, store, xr

path, kills = Path(sys.argv[2]), int(sys.argv[3])
temporary = Path(tempfile.gettempdir())
versions = [dataset(1, 2000), dataset(2, 3000)]
store.write(path, versions[0])
started = time.perf_counter()
store.write(path, versions[1])
duration = time.perf_counter() - started
generator = random.Random(0)
seen = interrupted = done = 0
while done < kills or (not interrupted and done < 10 * kills):  # on a busy machine few kills fall into a write
    done += 1
    child = os.fork()
    if child == 0:
        while True:
            for version in versions:
                store.write(path, version)
    time.sleep(duration * generator.uniform(0.2, 3))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    interrupted += any(path.parent.glob(".*.partial")) or any(temporary.glob(".granular-*.partial"))
    back = store.read(path)[""]
    seen += any(back.equals(version) for version in versions)
print(seen == done, interrupted)
"""


def test_killed_at_random_moments(path, tmp_path, monkeypatch, next_run):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    script = ("-c", KILL_LOOP, Path(__file__).parent, path, KILLS)
    seen, interrupted = python(*script, TMPDIR=str(temporary)).split()
    assert seen == "True"
    assert int(interrupted) > 0, "no kill fell into a write: the test proves nothing"
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    store.write(path, dataset())  # by the next run
    assert list(path.parent.iterdir()) == [path] and list(temporary.iterdir()) == []


def test_a_changed_byte_of_a_scalar_is_met(path):
    """The checksums of netCDF are of chunks of values, which scalars have not."""
    store.write(path, dataset().assign(total=((), 3.141592653589793, LABEL)))
    whole = path.read_bytes()
    at = whole.index(np.float64(3.141592653589793).tobytes())
    path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
    refuses(StoreError, "is damaged: its digest differs", store.read, path)
