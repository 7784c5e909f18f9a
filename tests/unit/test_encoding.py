"""What is kept on disk comes back to the last bit, and no file can make anything run."""

import dataclasses
import functools
import os
import pickle
import re
import subprocess
from collections import namedtuple
from pathlib import Path

import cloudpickle
import numpy as np
import pytest
import xarray as xr
from places import SOURCE

from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene
from granular_response.state import State
from granular_response.sweeps.encoding import NotDecodable, NotEncodable, decode, encode
from granular_response.sweeps.keys import key

HERE = (__name__,)
Pair = namedtuple("Pair", "one other")


@dataclasses.dataclass(frozen=True)
class Kept:
    values: np.ndarray
    numbers: dict
    inner: object = None


def test_plain_values_come_back_equal():
    values = [
        None, True, 3, -0.0, 1e-300, float("inf"), "text with ü", b"\0\xff", 2**80, (1, (2.0, "x")), [1, [2]],
        {"a": 1, 2: "b", (1, 2): [3]}, Path("a") / "b", {1, 2}, frozenset({"a"}), np.float32(1.5), np.int8(3),
        np.bool_(True),
        np.arange(6.0).reshape(2, 3), np.asfortranarray(np.arange(6.0).reshape(2, 3)), np.array("text"),
        np.array([True]), np.zeros((0, 3), np.int8), Pair(1, np.ones(2)), Kept(np.ones(3), {"a": np.float64(1)}),
    ]  # fmt: skip
    again = decode(encode(values, HERE), HERE)
    assert key(again) == key(values)
    assert again[19].flags.f_contiguous and again[18].flags.writeable
    assert np.isnan(decode(encode(float("nan"))))


def test_a_solution_comes_back_equal():
    solution = solve_scene(Scene().updated({"packing.layers": 4, "packing.disks_per_row": 7}))
    again = decode(encode(solution))
    assert key(again) == key(solution)
    assert again.scene == solution.scene
    assert isinstance(again.rest, State)


def test_a_dataset_comes_back_identical():
    data = xr.Dataset(
        {"y": (("k", "name"), np.ones((2, 2)), {"units": "1"}), "n": ((), 3)},
        {"k": [0.5, 1.5], "name": ["a", "b"]},
        {"title": "response", "number": np.float64(2.5), "list": [1, 2]},
    )
    assert decode(encode(data)).identical(data)


def test_what_holds_code_is_not_kept():
    class Local:
        pass

    for value in (Local(), len, lambda: 1, np.array([len]), Kept, Kept(np.ones(1), {}), {"a": object()}, Runs()):
        with pytest.raises(NotEncodable) as refused:
            encode(value)
        assert "\n" not in str(refused.value)


class Calls:
    """Its pickle calls something when it is read."""

    def __init__(self, called, *arguments):
        self.reduced = called, arguments

    def __reduce__(self):
        return self.reduced


Runs = functools.partial(Calls, exec, "import builtins; builtins.planted_code_has_run = True")


def named(module, name):
    """A pickle of what a module calls ``name``."""
    return b"\x80\x04" + b"".join(b"\x8c" + bytes([len(text)]) + text.encode() for text in (module, name)) + b"\x93."


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"PK\3\4 damaged",
        pickle.dumps(Runs()),
        pickle.dumps([np.array([Runs()])]),
        pickle.dumps(Kept(np.ones(1), {"inner": Runs()})),
        pickle.dumps(Calls(os.system, "ls")),
        pickle.dumps(Calls(subprocess.Popen, "ls")),
        pickle.dumps(Calls(getattr, Kept, "__init__")),
        pickle.dumps(Calls(np.load, "file.npy")),
        pickle.dumps(Calls(Scene, 3)),
        cloudpickle.dumps(lambda: 1),
        named("granular_response.__main__", "x"),
        named("granular_response.cli.main", "Path"),
        named("granular_response.state.state", "np.ndarray"),
        named("granular_response.state.state", "np"),
        named("granular_response.nowhere", "State"),
        named("granular_response.sweeps.encoding", "decode"),
        named("numpy", "ndarray.tofile"),
        named("builtins", "eval"),
    ],
)
def test_a_planted_file_runs_nothing_and_is_refused(data):
    import builtins

    with pytest.raises(NotDecodable):
        decode(data, HERE)
    assert not hasattr(builtins, "planted_code_has_run")


def test_pickles_are_read_from_workers_only():
    """A pickle runs code when it is read: from a file only values are."""
    reads = re.compile(r"\b(cloud)?pickle\.(loads?|Unpickler)\b|from (cloud)?pickle import")
    found = {str(path.relative_to(SOURCE)) for path in SOURCE.rglob("*.py") if reads.search(path.read_text("utf-8"))}
    assert found == {f"granular_response/sweeps/{name}.py" for name in ("encoding", "executor")}
