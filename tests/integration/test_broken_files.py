"""Packings of all formats cut and changed at random, the same ones in every run, and what the readers make of them.

A broken file is refused in one line, or what it still says is taken: never a quiet change.
"""

import re
import warnings
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import unlike_scenes
from places import DATA, ROOT
from stress import random_scenes

from granular_response.inputs import read_json
from granular_response.scene import Scene, formats
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.export import export
from granular_response.store.result import to_dataset

#: What stands in the place of a number or a word.
HOSTILE = ("1e300", "1e-300", "nan", "-1", "0", "", "abc", "9" * 5000, "1_0", "\0", "99")
TABLE = "x,z,radius,density\n1,1,1,1\n3,1,1,2\n5.2,1,0.9,1\n2,2.7,1,1\n4,2.7,0.95,3\n"


class File(NamedTuple):
    """A file as it should be."""

    name: str
    content: bytes
    #: Whether a cut is always seen: a table by hand that ends with a line is a whole one.
    closed: bool


def originals(folder: Path) -> list[File]:
    """Packings in all formats, by this package and by others."""
    (folder / "disks.csv").write_text(TABLE)
    load = {"disk": 3, "force": [0.0, -1.0]}
    scenes = {
        "walls": {"packing": {"kind": "file", "path": "disks.csv", "width": 6.3}, "contact": {"friction": 0.3}},
        "periodic": {"packing": {"kind": "slab", "layers": 2, "disks_per_row": 5, "sides": "periodic"}},
    }
    found = [File("disks.csv", TABLE.encode(), False)]
    for name, scene in scenes.items():
        path = folder / f"{name}.nc"
        store.write(path, to_dataset(solve_scene(Scene.from_dict({**scene, "loads": [load]}, folder=folder))))
        for suffix in (".csv", ".data", ".dump", ".gsd"):
            with warnings.catch_warnings(action="ignore"):
                made = export(path, folder / f"{name}{suffix}")
            found.append(File(made.name, made.read_bytes(), True))
    for name in ("shrink_wrapped.dump", "general_box.dump"):
        found.append(File(name, (DATA / "packings" / name).read_bytes(), True))
    return found


def changed(g: np.random.Generator, content: bytes, text: bool) -> bytes:
    """The file after a cut, another byte or number, or lines and words that are gone, twice or elsewhere."""
    kinds = ["cut", "byte", "gone", "twice", "number"] + ["line gone", "line twice", "lines swapped", "word"] * text
    kind = str(g.choice(kinds))
    at, end = sorted(int(k) for k in g.integers(0, len(content) + 1, 2))
    end = min(end, at + 64)
    lines = content.split(b"\n")
    k, m = (int(value) for value in g.integers(0, len(lines), 2))
    if kind == "cut":
        return content[: int(g.integers(0, len(content)))]
    if kind == "byte" or (kind == "number" and not text):
        flipped = bytearray(content)
        flipped[at - (at == len(content))] ^= 1 << int(g.integers(8))
        return bytes(flipped)
    if kind in ("gone", "twice"):
        return content[:at] + {"gone": b"", "twice": 2 * content[at:end]}[kind] + content[end:]
    if kind.startswith("line"):
        lines[k : k + 1] = {"line gone": [], "line twice": 2 * [lines[k]]}.get(kind, [lines[m]])
        if kind == "lines swapped":
            lines[m] = content.split(b"\n")[k]
        return b"\n".join(lines)
    mark = b"," if b"," in lines[k] else b" "
    words = lines[k].split(mark)
    j = int(g.integers(len(words)))
    words[j] = words[int(g.integers(len(words)))] if kind == "word" else str(g.choice(HOSTILE)).encode()
    lines[k] = mark.join(words)
    return b"\n".join(lines)


def disks_of(table: formats.Table) -> Counter[tuple[float, ...]]:
    """The disks of a table, in its own units."""
    columns = [table.x, table.z, table.radius, *([] if table.mass is None else [table.mass])]
    return Counter(zip(*(column.tolist() for column in columns), strict=True))


def split(content: bytes) -> list[bytes]:
    """Lines, whatever ends them."""
    return content.replace(b"\r\n", b"\n").replace(b"\r", b"\n").rstrip(b"\n").split(b"\n")


def quiet_change(file: File, content: bytes, folder: Path) -> str:
    """What the packing of a changed file has that the change does not account for; nothing if it does.

    A change of some lines, or bytes, changes as many disks at most, and their number only in a table by hand, which
    does not say it. Box, masses and all disks at once follow from other lines than those of disks alone.
    """
    tables = []
    for name, data in (("whole", file.content), ("changed", content)):
        path = folder / f"{name}{Path(file.name).suffix}"
        path.write_bytes(data)
        tables.append(formats.read(path, formats.by_suffix(path)))
    whole, changed = tables
    if path.suffix == ".gsd":
        if len(content) != len(file.content):
            return "" if disks_of(whole) == disks_of(changed) else "longer or shorter"
        touched = sum(one != other for one, other in zip(content, file.content, strict=True))
        gone = new = touched
        header = True
    else:
        before, after = split(file.content), split(content)
        lost, added = Counter(before) - Counter(after), Counter(after) - Counter(before)
        moved = [k for k, (one, other) in enumerate(zip(before, after, strict=False)) if one != other]
        moved = moved if len(before) == len(after) else []
        gone, new = max(lost.total(), len(moved)), max(added.total(), len(moved))
        rows = {int(place.removeprefix("line ")) - 1 for place in whole.places}
        header = any(k not in rows for k, line in enumerate(before) if line in lost or k in moved)
        ends = content.endswith((b"\n", b"\r")) and file.content.startswith(content)
        if path.suffix == ".dump" and ends and file.content[len(content) :].startswith(b"ITEM: TIMESTEP"):
            return ""  # the format has no end: a whole frame less is another whole file
    if file.closed:
        expected = len(whole.radius)
    else:
        expected = len(whole.radius) + sum(
            sign * sum(bool(line.strip(b", ")) and not line.startswith(b"#") for line in lines)
            for sign, lines in ((1, after), (-1, before))
        )
    if len(changed.radius) != expected:
        return f"{len(changed.radius)} of {expected} disks"
    if changed.box != whole.box and not header:
        return "another box"
    masses = (changed.mass is None) != (whole.mass is None)
    if masses and not (header and (changed.remark or not file.closed)):
        return "masses"
    if masses:
        whole, changed = (replace(table, mass=None) for table in (whole, changed))
    one, other = disks_of(whole), disks_of(changed)
    if (one - other).total() > gone or (other - one).total() > new:
        return f"{(other - one).total()} other disks after a change of {new}"
    return ""


@pytest.mark.filterwarnings("ignore:overflow")
def test_packings_that_are_changed_are_refused_or_account_for_the_change(tmp_path):
    packings, refused = originals(tmp_path), Counter()
    for index in range(600):
        file, g = packings[index % len(packings)], np.random.default_rng([7, index])
        content = changed(g, file.content, not file.name.endswith(".gsd"))
        try:
            assert quiet_change(file, content, tmp_path) == "", (index, file.name)
        except (formats.FormatError, UnicodeDecodeError) as error:
            assert "\n" not in str(error)
            refused[file.name] += 1
    assert refused.keys() == {file.name for file in packings} and min(refused.values()) > 10


def test_no_random_scene_was_solved_wrongly():
    path = DATA / "random_scenes.json"
    found = unlike_scenes.totals(path)
    assert set(found) <= set(random_scenes.OUTCOMES) - {"wrong"}
    outcomes = read_json(path)["outcomes"]
    assert {kind.removesuffix(unlike_scenes.ROLL) for kind in outcomes} == set(unlike_scenes.KINDS)
    rolls = [one for kind, one in outcomes.items() if kind.endswith(unlike_scenes.ROLL)]
    resist = [sum(sum(one.values()) for one in rolls), sum(one["certified"] for one in rolls)]
    page = (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
    (paragraph,) = (part for part in re.split(r"\n\n|\n\* ", page) if "`tests/data/random_scenes.json`" in part)
    said = [int(number.replace(",", "")) for number in re.findall(r"(?<![\w.])\d[\d,]*(?=\s)", paragraph)]
    assert said[:5] == [sum(found.values()), found["certified"], unlike_scenes.STEPS, *resist]
