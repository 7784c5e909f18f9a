"""Names from content: equal values, equal names; where two values cannot be told apart there is no name."""

import dataclasses
import enum
import functools
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.sweeps.digest import Indistinct, digest


@dataclasses.dataclass(frozen=True)
class Task:
    friction: float
    forces: np.ndarray

    def total(self, item):
        return self.forces.sum() + item


class Colour(enum.Enum):
    RED = 1
    BLUE = 2


def test_equal_for_equal_values_only():
    def task(friction=0.2, last=3.0):
        return {"task": Task(friction, np.array([1.0, last])), "seed": 1}

    assert digest(task()) == digest(dict(reversed(task().items())))
    different = [
        task(), task(friction=0.3), task(last=4.0), (1, 2), [1, 2], (1, 2.0), (1, True), "12", b"12", {1, 2}, 0.0, -0.0,
        np.float64(1.0), np.float32(1.0), 1.0, np.zeros(4), np.zeros((2, 2)), range(3), Colour.RED, Colour.BLUE,
        ("ab", "c"), ("a", "bc"), (("a",), "b"), {"a": 1}, {"a": 2}, {1: "a"}, np.sin, np.cos, len, None,
    ]  # fmt: skip
    assert len({digest(value) for value in different}) == len(different)


def test_equal_in_every_process():
    script = "import sys; sys.path.insert(0, sys.argv[1]); from test_digest import *; print(digest((Task, {'b', 'a'})))"
    for seed in ("1", "2"):
        name = subprocess.run(
            [sys.executable, "-c", script, Path(__file__).parent],
            env={**os.environ, "PYTHONHASHSEED": seed},
            check=True,
            capture_output=True,
            text=True,
        ).stdout.strip()
        assert name == digest((Task, {"a", "b"}))


def table(folder, radius):
    folder.mkdir(exist_ok=True)
    (folder / "disks.csv").write_text(f"x,z,radius\n2,1,{radius}\n5,1,1\n")
    text = "packing: {kind: file, path: disks.csv, width: 10}\nloads: []\n"
    return Scene.from_text(text, folder=folder)


def test_a_table_counts_by_its_content(tmp_path):
    one, same, other = table(tmp_path / "a", 1.0), table(tmp_path / "b", 1.0), table(tmp_path / "c", 0.9)
    assert one.to_dict() == other.to_dict()
    assert digest(one) == digest(same) != digest(other)
    before = digest(one)
    table(tmp_path / "a", 0.8)
    assert digest(one) != before
    (tmp_path / "a" / "disks.csv").unlink()
    with pytest.raises(Indistinct, match=r"disks.csv cannot be read"):
        digest(one)
    (tmp_path / "a" / "disks.csv").symlink_to("/dev/zero")  # which never ends
    with pytest.raises(Indistinct, match=r"disks.csv cannot be read: is not a regular file"):
        digest(one)


def scaled(factor):
    return lambda item: factor * item


def test_equal_parts_count_as_equal_whether_or_not_they_are_one_object():
    one = np.arange(3.0)
    assert digest([one, one, "text"]) == digest([one, one.copy(), "te" + "xt"])


def test_functions_without_a_name_of_their_own_count_by_their_code():
    lambdas = [lambda x: x, lambda *x: x, lambda x: x + 1, lambda x: x + 2, lambda x, y=1: x, lambda x, y=2: x]
    lambdas += [scaled(2), scaled(3)]
    assert len({digest(function) for function in lambdas}) == len(lambdas)
    assert digest(scaled(2)) == digest(scaled(2))

    def caught(x):
        try:
            return 1 / x
        except ZeroDivisionError:
            return 0

    assert digest(caught) != digest(lambda x: 1 / x)


@pytest.mark.parametrize("change", ["def inner(x): return x + 2", "CONSTANT = 2"])
def test_what_a_notebook_function_refers_to_counts(change):
    cells = "CONSTANT = 1\ndef inner(x): return x + 1\ndef task(x): return inner(x) + CONSTANT"
    before, after = {"__name__": "__main__"}, {"__name__": "__main__"}
    exec(cells, before)
    exec(f"{cells}\n{change}", after)
    assert digest(before["task"]) != digest(after["task"])
    exec(cells, again := {"__name__": "__main__"})
    assert digest(again["task"]) == digest(before["task"])


def test_a_function_that_calls_itself_has_a_name():
    def falling(n):
        return falling(n - 1) if n else 0

    assert digest(falling) == digest(falling)


def test_bound_methods_count_with_their_object():
    one, other = Task(0.1, np.ones(2)), Task(0.1, np.zeros(2))
    assert digest(one.total) == digest(Task(0.1, np.ones(2)).total) != digest(other.total)
    assert digest([1].append) != digest([2].append)
    assert digest(functools.partial(one.total, 1)) != digest(functools.partial(one.total, 2))


def test_what_cannot_be_told_apart_has_no_name():
    class Local:
        pass

    for value in (Local(), Local, threading.Lock(), (n for n in [1]), [Local()], lambda: Local):
        with pytest.raises(Indistinct) as refused:
            digest(value)
        assert "\n" not in str(refused.value)


def test_what_a_function_of_the_script_refers_to_counts(tmp_path):
    """The same file, but the value of its global comes from the command line."""
    lines = ["import sys", "from granular_response.sweeps.digest import digest", "WIDTH = float(sys.argv[1])"]
    lines += ["def measure(result):", "    return WIDTH", "print(digest(measure))"]
    (tmp_path / "script.py").write_text("\n".join(lines))
    names = [
        subprocess.run(
            [sys.executable, tmp_path / "script.py", width], check=True, capture_output=True, text=True
        ).stdout
        for width in ("1", "3", "1")
    ]
    assert names[0] == names[2] != names[1]
