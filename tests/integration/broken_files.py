"""Files of every kind that others may hand over, cut and changed at random, and what the commands make of them.

``make broken`` tries thousands and prints how many had which outcome. A broken file is refused in one line, or what it
still says is taken: never a traceback, a quiet change, or more time or memory than a file of this size may cost.
"""

from __future__ import annotations

import importlib
import struct
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import counts
import numpy as np
from commands import IMPORTED, call

from granular_response.scene import Scene, formats
from granular_response.scene.formats.table import NO_MASSES
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.export import export
from granular_response.store.result import to_dataset

#: Seconds and bytes of memory, beyond what the libraries take, of one command on one file.
MOST_SECONDS, MOST_MEMORY = 30, 2 * 2**30
#: Outcomes that must not be.
WRONG = ("traceback", "killed", "several lines", "quiet change", "too much memory")
#: What stands in the place of a number or a word.
HOSTILE = (
    "1e300", "-1e300", "1e-300", "nan", "inf", "-1", "0", "", "abc", "9" * 5000, "1_0", "0x10", "1e5", "\0", "99",
)  # fmt: skip
TABLE = "x,z,radius,density\n1,1,1,1\n3,1,1,2\n5.2,1,0.9,1\n2,2.7,1,1\n4,2.7,0.95,3\n"
SHORT = {"protocol": {"maximum_steps": 2000, "method": "path"}}


class File(NamedTuple):
    """A file as it should be, and what it means."""

    name: str
    content: bytes
    given: dict[str, object]  #: what a scene has to add to a packing
    #: Whether a cut is always seen: a table by hand that ends with a line is a whole one.
    closed: bool


@dataclass(frozen=True)
class Trial:
    """What became of one file."""

    what: str  #: ending of the name, what was done to it, and the command
    outcome: str
    said: str
    seconds: float


def originals(folder: Path) -> list[File]:
    """Packings in all formats, by this package and by others, results and scenes."""
    (folder / "disks.csv").write_text(TABLE)
    load = {"disk": 3, "force": [0.0, -1.0]}
    scenes = {
        "walls": {"packing": {"kind": "file", "path": "disks.csv", "width": 6.3}, "contact": {"friction": 0.3}},
        "periodic": {"packing": {"kind": "slab", "layers": 2, "disks_per_row": 5, "sides": "periodic"}},
    }
    found = [File("scene.yaml", Scene.from_dict({**scenes["periodic"], "loads": [load]}).to_yaml().encode(), {}, False)]
    for name, scene in scenes.items():
        path = folder / f"{name}.nc"
        solved = to_dataset(solve_scene(Scene.from_dict({**scene, "loads": [load]}, folder=folder)))
        store.write(path, solved)
        found.append(File(path.name, path.read_bytes(), {}, True))
        for suffix in (".csv", ".data", ".dump", ".gsd"):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                made = export(path, folder / f"{name}{suffix}")
            # with a width of the scene a table is read that has lost its mark
            width = {"width": float(solved.attrs["width"])} if suffix == ".csv" else {}
            found.append(File(made.name, made.read_bytes(), {"sides": name, **width}, True))
    found.append(File("disks.csv", TABLE.encode(), {"width": 6.3}, False))
    data = Path(__file__).parents[1] / "data" / "packings"
    found.append(File("sw.dump", (data / "shrink_wrapped.dump").read_bytes(), {"width": 6.0, "origin": [0, 0]}, True))
    found.append(File("edges.dump", (data / "general_box.dump").read_bytes(), {"sides": "periodic"}, True))
    return found


def changed(g: np.random.Generator, content: bytes, text: bool) -> tuple[str, bytes]:
    """What was done, and the file after it."""
    kinds = ["cut", "byte", "bytes", "gone", "twice", "number"]
    kinds += ["line gone", "line twice", "lines swapped", "word", "word gone"] if text else []
    kind = str(g.choice(kinds, p=None if not text else [0.2, 0.08, 0.04, 0.04, 0.04, 0.2, 0.1, 0.05, 0.05, 0.1, 0.1]))
    at, end = sorted(int(k) for k in g.integers(0, len(content) + 1, 2))
    end = min(end, at + 64)
    lines = content.split(b"\n")
    k, m = (int(value) for value in g.integers(0, len(lines), 2))
    if kind == "cut":
        return kind, content[: int(g.integers(0, len(content)))]
    if kind == "byte":
        flipped = bytearray(content)
        flipped[at - (at == len(content))] ^= 1 << int(g.integers(8))
        return kind, bytes(flipped)
    if kind == "number" and not text:
        at -= at % 8
        value = float(g.choice([1e300, -1e300, np.nan, np.inf, -1.0, 0.0, 2.0**40]))
        packed = struct.pack("<d", value) if g.random() < 0.5 else struct.pack("<q", int(g.integers(-2, 2**40)))
        return kind, content[:at] + packed + content[at + 8 :]
    if kind in ("bytes", "gone", "twice"):
        new = {"bytes": g.bytes(int(g.integers(1, 32))), "gone": b"", "twice": 2 * content[at:end]}[kind]
        return kind, content[:at] + new + content[end:]
    if kind.startswith("line"):
        lines[k : k + 1] = {"line gone": [], "line twice": 2 * [lines[k]]}.get(kind, [lines[m]])
        if kind == "lines swapped":
            lines[m] = content.split(b"\n")[k]
        return kind, b"\n".join(lines)
    mark = b"," if b"," in lines[k] else b" "
    words = lines[k].split(mark)
    j = int(g.integers(len(words)))
    new = {"word gone": [], "word": [words[int(g.integers(len(words)))]]}.get(kind, [str(g.choice(HOSTILE)).encode()])
    words[j : j + 1] = new
    lines[k] = mark.join(words)
    return kind, b"\n".join(lines)


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


def outcome(ended: subprocess.CompletedProcess[str]) -> str:
    """What a command did, by how it ended."""
    if ended.returncode < 0:
        return "killed"
    if "Traceback" in ended.stderr:
        return "traceback"
    if ended.returncode == 2 and sum(NO_MASSES not in line for line in ended.stderr.splitlines()) != 1:
        return "several lines"  # but for a remark that comes before
    if "not enough memory" in ended.stderr:
        return "too much memory"
    return {0: "taken", 1: "taken", 2: "refused"}.get(ended.returncode, "killed")


def attempt(g: np.random.Generator, files: list[File], folder: Path) -> Trial:
    """Change one file and give it to a command that reads it."""
    file = files[int(g.integers(len(files)))]
    path = folder / file.name
    suffix = path.suffix
    done, content = changed(g, file.content, suffix not in (".nc", ".gsd"))
    path.write_bytes(content)
    if suffix == ".nc":
        command = str(g.choice(["show", "continue", "export", "plot"], p=[0.4, 0.3, 0.25, 0.05]))
        output = {"show": [], "continue": ["--to", "1.1", "-o", "out.nc"], "plot": ["-o", "out.png"],
                  "export": ["-o", f"out{g.choice(['.gsd', '.vtu', '.csv', '.xyz', '.dump'])}"]}[command]  # fmt: skip
        arguments = [command, file.name, *output]
    else:
        command = "run"
        arguments = ["run", file.name, "-o", "out.nc"]
        if suffix != ".yaml":
            scene = {"packing": {"kind": "file", "path": file.name, **file.given}, "loads": [], **SHORT}
            (folder / "of.yaml").write_text(Scene.from_dict(scene).to_yaml())
            arguments[1] = "of.yaml"
    started = time.monotonic()
    ended = call(*arguments, folder=folder, start="fork", memory=MOST_MEMORY)
    seconds, said = time.monotonic() - started, ended.stderr
    found = outcome(ended) if seconds < MOST_SECONDS else "killed"
    if suffix == ".nc" and found == "taken" and content != file.content:
        found = "quiet change"
    if suffix not in (".nc", ".yaml") and found == "taken" and (change := quiet_change(file, content, folder)):
        found, said = "quiet change", f"{change}\n{said}"
    return Trial(f"{suffix} {done}: {command}", found, said, seconds)


def attempts(count: int, seed: int, folder: Path, *, show: bool = False) -> list[Trial]:
    """That many trials, the same ones for the same seed; ``show`` prints those that are wrong as they come."""
    for module in IMPORTED:
        importlib.import_module(module)  # once, and not in every process
    files, trials = originals(folder), []
    for index in range(count):
        trial = attempt(np.random.default_rng([seed, index]), files, folder)
        trials.append(trial)
        if show and trial.outcome in WRONG:
            print(f"{index}: {trial.what}: {trial.outcome}: {trial.said.strip().splitlines()[-1:]}", flush=True)
    return trials


def by_kind(trials: list[Trial]) -> dict[str, Counter[str]]:
    """Counts of outcomes by format and command, such as ``.csv: run``."""
    found: dict[str, Counter[str]] = {}
    for trial in trials:
        done, _, command = trial.what.partition(": ")
        found.setdefault(f"{done.partition(' ')[0]}: {command}", Counter())[trial.outcome] += 1
    return found


if __name__ == "__main__":
    given = counts.arguments("Cut and change files of all formats, and see what reads them.", 0)
    with tempfile.TemporaryDirectory() as place:
        made = attempts(given.number, given.seed, Path(place), show=True)
    for name, number in sorted(Counter(trial.outcome for trial in made).items()):
        print(f"{number:6} {name}")
    longest = max(made, key=lambda trial: trial.seconds)
    print(f"longest {longest.seconds:.1f} s: {longest.what}")
    if given.output is not None:
        counts.write(given.output, given.number, given.seed, by_kind(made))
    sys.exit(any(trial.outcome in WRONG for trial in made))
