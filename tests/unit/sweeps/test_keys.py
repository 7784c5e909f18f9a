"""Keys from content: equal values, equal keys; where two values cannot be told apart there is no key."""

import dataclasses
import enum
import functools
import importlib
import threading
from pathlib import Path

import numpy as np
import pytest
from commands import python
from refusals import refuses

from granular_response.scene import Scene
from granular_response.scene.material import KNOWN_LAWS, KnownLaw
from granular_response.sweeps.keys import Indistinct, key


@dataclasses.dataclass(frozen=True)
class Task:
    friction: float
    forces: np.ndarray

    def total(self, item):
        return self.forces.sum() + item


class Bits(enum.IntFlag):
    ONE = 1


class Colour(enum.Enum):
    RED = 1
    BLUE = 2


def test_equal_for_equal_values_only():
    def task(friction=0.2, last=3.0):
        return {"task": Task(friction, np.array([1.0, last])), "seed": 1}

    assert key(task()) == key(dict(reversed(task().items())))
    different = [
        task(), task(friction=0.3), task(last=4.0), (1, 2), [1, 2], (1, 2.0), (1, True), "12", b"12", {1, 2}, 0.0, -0.0,
        np.float64(1.0), np.float32(1.0), 1.0, np.zeros(4), np.zeros((2, 2)), range(3), Colour.RED, Colour.BLUE,
        ("ab", "c"), ("a", "bc"), (("a",), "b"), {"a": 1}, {"a": 2}, {1: "a"}, np.sin, np.cos, len, None,
    ]  # fmt: skip
    assert len({key(value) for value in different}) == len(different)


def test_equal_in_every_process():
    script = "import sys; sys.path.insert(0, sys.argv[1]); from test_keys import *; print(key((Task, {'b', 'a'})))"
    for seed in ("1", "2"):
        name = python("-c", script, Path(__file__).parent, PYTHONHASHSEED=seed)
        assert name.strip() == key((Task, {"a", "b"}))


def table(folder, radius):
    folder.mkdir(exist_ok=True)
    (folder / "disks.csv").write_text(f"x,z,radius\n2,1,{radius}\n5,1,1\n")
    text = "packing: {kind: file, path: disks.csv, width: 10}\nloads: []\n"
    return Scene.from_text(text, folder=folder)


def test_a_table_counts_by_its_content(tmp_path):
    one, same, other = table(tmp_path / "a", 1.0), table(tmp_path / "b", 1.0), table(tmp_path / "c", 0.9)
    assert one.to_dict() == other.to_dict()
    assert key(one) == key(same) != key(other)
    before = key(one)
    table(tmp_path / "a", 0.8)
    assert key(one) != before
    (tmp_path / "a" / "disks.csv").unlink()
    refuses(Indistinct, r"disks.csv cannot be read", key, one)
    (tmp_path / "a" / "disks.csv").symlink_to("/dev/zero")  # which never ends
    refuses(Indistinct, r"disks.csv cannot be read: is not a regular file", key, one)


def test_functions_of_modules_count_by_name_and_file(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    file = tmp_path / "mine_to_measure.py"
    file.write_text("def one(x): return x\ndef other(x): return x\n")
    import mine_to_measure as mine

    assert key(functools.partial(mine.one, 1)) == key(functools.partial(mine.one, 1))
    assert len({key(f) for f in (mine.one, mine.other, functools.partial(mine.one, 1), abs, np.linalg.norm)}) == 5
    before, by_name = key(mine.one), key(mine.one, packages=["mine_to_measure"])
    file.write_text(file.read_text().replace("return x", "return x + 1"))
    assert key(mine.one) != before and key(mine.one, packages=["mine_to_measure"]) == by_name


def test_what_cannot_be_told_apart_has_no_key():
    class Local:
        pass

    bound = [Task(0.1, np.ones(2)).total, [1].append]
    local = [Local(), Local, [Local()], np.array([Local()]), lambda: 1]
    for value in (*local, *bound, threading.Lock(), (n for n in [1])):
        refuses(Indistinct, None, key, value)


def test_functions_of_a_script_count_by_its_file_and_those_of_a_notebook_not_at_all(tmp_path):
    lines = "from granular_response.sweeps.keys import key\ndef measure(x):\n    return x\nprint(key(measure))\n"
    (tmp_path / "script.py").write_text(lines)

    first, again = (python(tmp_path / "script.py") for _ in range(2))
    (tmp_path / "script.py").write_text(lines.replace("return x", "return 2 * x"))
    assert first == again != python(tmp_path / "script.py")
    with pytest.raises(AssertionError, match="Indistinct: function measure stands in no module that can be imported"):
        python("-c", lines)


def test_the_springs_of_a_packing_count_by_their_content(tmp_path):
    (tmp_path / "disks.csv").write_text("x,z,radius\n2,1,1\n5,1,1\n")
    text = "packing: {kind: file, path: disks.csv, width: 10, springs: disks.contacts.csv}\nloads: []\n"
    keys = []
    for force in ("0.1", "-0.05", "0.1"):
        (tmp_path / "disks.contacts.csv").write_text(
            f"first,second,wall,normal_force,tangential_force\n0,,floor,1,{force}\n"
        )
        keys.append(key(Scene.from_text(text, folder=tmp_path)))
    assert keys[0] != keys[1] and keys[0] == keys[2]
    (tmp_path / "disks.contacts.csv").unlink()
    refuses(Indistinct, r"disks.contacts.csv cannot be read", key, Scene.from_text(text, folder=tmp_path))


LAW = """
import granular_response as gr
from granular_response.contact import Linear
import constants_of_mine
class Stiffer(Linear):
    def elastic_force(self, overlap, shape):
        return constants_of_mine.PART * self.normal_stiffness * overlap
"""


def test_a_module_that_a_law_imports_counts(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "stiffer_law.py").write_text(LAW)
    (tmp_path / "constants_of_mine.py").write_text("PART = 1.0\n")
    law = importlib.import_module("stiffer_law").Stiffer
    monkeypatch.setitem(KNOWN_LAWS, "stiffer", KnownLaw(law=law))
    scene = Scene().updated({"contact.law": "stiffer"})
    of_problem = law.of(1.0, 1.0, 1.0, 1.0, 0.2, 0.0, 0.5)  # as in the name of a rest state
    before = key(scene), key(of_problem)
    assert (key(scene), key(of_problem)) == before
    (tmp_path / "constants_of_mine.py").write_text("PART = 2.0\n")
    assert not {*before} & {key(scene), key(of_problem)}


BY_FILE = """from importlib import util
spec = util.spec_from_file_location({}, 'elsewhere/factor.py')
mine = util.module_from_spec(spec)
spec.loader.exec_module(mine)
"""

#: Ways to a module whose ``FACTOR`` a task takes: the text above the task, and the other file.
WAYS = {
    "by_statement": ("import factor_of_statement as mine\n", "factor_of_statement.py"),
    "inside": (
        "def inside():\n    import factor_inside as mine\n    return mine\nmine = inside()\n",
        "factor_inside.py",
    ),
    "further": ("import between_them\nmine = between_them.mine\n", "factor_further.py"),
    "all_of_it": ("from factor_of_all import *\nmine = None\n", "factor_of_all.py"),
    "by_name": ("import importlib\nmine = importlib.import_module('factor_by_name')\n", "factor_by_name.py"),
    "deep": ("import top.deep.helper\nmine = top.deep.helper\n", "top/deep/helper.py"),
    "its_top": ("import roof.deep.helper\nmine = roof\n", "roof/__init__.py"),
    "without_a_top": ("from space import factor_in_space as mine\n", "space/factor_in_space.py"),
    "relative": ("from near.deep.other import mine\n", "near/deep/helper.py"),
    "by_word": ("import importlib\nmine = importlib.import_module(name='factor_by_word')\n", "factor_by_word.py"),
    "by_alias": ("from importlib import import_module as load\nmine = load('factor_by_alias')\n", "factor_by_alias.py"),
    "by_file": (BY_FILE.format("'mine'"), "elsewhere/factor.py"),
    "by_file_under_the_same_name": (BY_FILE.format("__name__"), "elsewhere/factor.py"),
    "by_name_of_the_library": ("import tabnanny as mine\n", "tabnanny.py"),
    "of_package.task": ("mine = None  # of_package as mine\n", "of_package/__init__.py"),
}
#: What stands between a task and the other file.
BETWEEN = {"between_them.py": "import factor_further as mine\n", "near/deep/other.py": "from . import helper as mine\n"}


@pytest.mark.parametrize("module", WAYS)
def test_modules_count_whatever_the_way_to_them(tmp_path, monkeypatch, module):
    text, other = WAYS[module]
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    empty = [f"{top}/{name}__init__.py" for top in ("top", "roof", "near") for name in ("", "deep/")]
    files = dict.fromkeys([*empty, "roof/deep/helper.py", "unrelated.py", "of_package/none.py"], "") | BETWEEN
    files |= {other: "FACTOR = 1\n", f"{module.replace('.', '/')}.py": f"{text}def task(x): return mine.FACTOR * x\n"}
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    task = importlib.import_module(module).task
    before = key(task)
    (tmp_path / "unrelated.py").write_text("# another\n")
    assert key(task) == before
    (tmp_path / other).write_text("FACTOR = 2\n")
    assert key(task) != before
    (tmp_path / other).unlink()
    (tmp_path / other).mkdir()  # as one in an archive
    refuses(Indistinct, "cannot be read", key, task)


class Factor(Task):
    def __init__(self, factor):
        super().__init__(0.1, np.ones(2))
        object.__setattr__(self, "factor", factor)


def test_attributes_beside_a_value_count():
    assert key(Bits(4)) != key(Bits(8))  # no name
    assert key(Factor(1.0)) == key(Factor(1.0)) != key(Factor(2.0))
    refuses(Indistinct, "MaskedArray", key, np.ma.array([1.0, 2.0], mask=[False, True]))


def test_a_scene_of_mappings_or_by_its_file_counts_with_its_table(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "packing: {kind: file, path: disks.csv, width: 10}\nloads: []\n"
    (tmp_path / "scene.yaml").write_text(text)
    keys = []
    for radius in (1.0, 0.9, 1.0):
        table(tmp_path, radius)
        mapped = {"packing": {"kind": "file", "path": "disks.csv", "width": 10}}
        keys.append([key(one) for one in (mapped, {"scene": mapped}, "scene.yaml", Path("scene.yaml"))])
    assert keys[0] == keys[2] and not {*keys[0]} & {*keys[1]}
    assert key("none.yaml") == key("none.yaml") and key({"packing": 1}) != key({"packing": 2})
