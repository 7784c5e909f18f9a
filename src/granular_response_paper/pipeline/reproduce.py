"""Runs the pipeline of a collection and says how far it is: stages done and to do, time gone and time to come.

``dvc repro`` decides what is out of date and runs it. The stored times of all stages tell how long the rest takes,
scaled by how this machine compares on the stages that have run. Within a stage its own tasks are shown on a terminal.

DVC reads and writes the whole of its lock around every stage, in 1.4 s once all stages are in it. Where every stage
runs, the lock begins empty. At the end it gets back the stages that did not run, in the order of the pipeline.
"""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from granular_response.inputs import read_json, read_text
from granular_response.scene import text
from granular_response.store import atomic
from granular_response_paper.registry import Collection

#: Seconds of every stage from nothing, by collection, with the machine that they were measured on.
TIMES = Path("benchmarks") / "pipeline.json"

#: The pipeline of a collection and its lock, in its folder.
FILE, LOCK = "dvc.yaml", "dvc.lock"

#: What DVC prints where a stage begins, and where it need not run.
_BEGINS = re.compile(r"^Running stage '(?:.*:)?([\w@]+)':")
_SKIPPED = re.compile(r"^Stage '(?:.*:)?([\w@]+)' (?:didn't change, skipping|is cached)")

#: Lines of a stage that are shown if it fails.
_KEPT = 40


def stage_names(collection: Collection, root: Path) -> list[str]:
    """Every stage of a collection, as its pipeline names them."""
    return expanded(text.read(read_text(root / collection.folder / FILE))["stages"])


def expanded(stages: Mapping[str, Any]) -> list[str]:
    """The names of the stages of a pipeline, each of those that it has for every group by itself."""
    return [
        name
        for kind, one in stages.items()
        for name in ([f"{kind}@{group}" for group in one["foreach"]] if "foreach" in one else [kind])
    ]


def stored_times(collection: Collection, root: Path) -> tuple[dict[str, float], str]:
    """Seconds by stage as they are stored, and the machine that they were measured on; none if there are none."""
    rows = [row for row in _rows(root) if row["collection"] == collection.name]
    return {row["stage"]: row["seconds"] for row in rows}, rows[0]["measured_on"] if rows else ""


def _rows(root: Path) -> list[dict[str, Any]]:
    """What is stored: a row for each stage of each collection."""
    path = root / TIMES
    return list(read_json(path)["runs"]) if path.exists() else []


@contextmanager
def emptied(lock: Path, names: Sequence[str]) -> Iterator[None]:
    """A lock of DVC that is empty meanwhile, if ``names`` are given: the stages of its pipeline, which all run."""
    before = lock.read_text(encoding="utf-8") if names and lock.exists() else ""
    if not before:
        yield
        return
    lock.unlink()
    try:
        yield
    finally:
        after = lock.read_text(encoding="utf-8") if lock.exists() else before
        atomic.write_bytes(lock, merged(before, after, names).encode())


def merged(before: str, after: str, names: Sequence[str]) -> str:
    """The stages of two locks in the order of ``names``, each as it is ``after``, if it is there."""
    (head, old), (_, new) = _parts(before), _parts(after)
    both = old | new
    return head + "".join(both[name] for name in names if name in both)


def _parts(lock: str) -> tuple[str, dict[str, str]]:
    """What stands before the stages of a lock, and the text of each stage."""
    head, *stages = re.split(r"(?m)^(?=  \S)", lock)
    return head, {stage.partition("\n")[0].strip(" :'\""): stage for stage in stages}


@dataclass
class Watch:
    """What has run and what is to come. ``expected`` are stored seconds by stage."""

    names: Sequence[str]
    expected: Mapping[str, float]
    clock: Callable[[], float] = time.monotonic
    taken: dict[str, float] = field(default_factory=dict)  #: seconds by stage that has run; 0 for a skipped one
    current: str = ""
    begun: float = 0.0

    def __post_init__(self) -> None:
        self.start = self.clock()

    def read(self, line: str) -> str:
        """What to say after a line of DVC's output; empty if that tells nothing new."""
        if match := _BEGINS.match(line):
            said = self.ended()
            self.current, self.begun = match[1], self.clock()
            return said
        if match := _SKIPPED.match(line):
            said = self.ended()
            self.taken[match[1]] = 0.0
            return said
        return ""

    def ended(self) -> str:
        """The current stage is over."""
        if not self.current:
            return ""
        self.taken[self.current] = self.clock() - self.begun
        name, self.current = self.current, ""
        return f"{len(self.taken):3} of {len(self.names)}  {name:36} {self.taken[name]:6.1f} s   {self.rest()}"

    def rest(self) -> str:
        """Time gone and, where stage times are stored, time to come."""
        gone = f"{clock_time(self.clock() - self.start)} gone"
        left = [self.expected.get(name) for name in self.names if name not in self.taken and name != self.current]
        if not left or None in left:
            return gone
        pairs = [(self.expected[name], one) for name, one in self.taken.items() if one and name in self.expected]
        stored, here = (sum(one) for one in zip(*pairs, strict=True)) if pairs else (1.0, 1.0)
        return f"{gone}, at most {clock_time(sum(filter(None, left)) * here / stored)} to come"


def clock_time(seconds: float) -> str:
    """Minutes and seconds."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"


def reproduce(
    collection: Collection,
    root: Path,
    *,
    arguments: Sequence[str] = (),
    keep_times: bool = False,
    say: Callable[[str], None] = print,
) -> int:
    """Bring a collection up to date; returns the exit status of DVC.

    ``arguments`` go to ``dvc repro``. With ``keep_times`` the seconds of the stages are stored for the next run, if
    every stage has run. ``root`` is the folder of the checkout.
    """
    expected, machine = stored_times(collection, root)
    names = stage_names(collection, root)
    if set(names) <= set(expected):
        total = clock_time(sum(expected[name] for name in names))
        say(f"{collection.title}: {len(names)} stages, {total} from nothing on {machine}; less if up to date")
    watch, last = Watch(names, expected), deque[str](maxlen=_KEPT)
    command = [sys.executable, "-m", "dvc", "repro", *arguments]
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    folder = root / collection.folder
    stored = (root / ".dvc" / "cache").exists() or any((folder / "data").glob("*.nc"))
    with (
        emptied(folder / LOCK, names if "--force" in arguments or not stored else ()),
        subprocess.Popen(
            command, cwd=folder, env=environment, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
        ) as run,
    ):
        assert run.stdout is not None
        for line in run.stdout:
            last.append(line.rstrip("\n"))
            if said := watch.read(line):
                say(said)
    if run.returncode:
        say("\n".join(last))
        return run.returncode
    if said := watch.ended():
        say(said)
    if keep_times and all(watch.taken.get(name) for name in names):
        _store(collection, root, watch.taken)
    ran = sum(1 for one in watch.taken.values() if one)
    say(f"{collection.title}: {ran} stages run, {len(names) - ran} were up to date, {watch.rest().partition(',')[0]}")
    return 0


def _store(collection: Collection, root: Path, taken: Mapping[str, float]) -> None:
    common = {"collection": collection.name, "measured_on": f"{processor()}, {os.cpu_count()} cores"}
    own = [common | {"stage": name, "seconds": round(taken[name], 1)} for name in stage_names(collection, root)]
    rows = [row for row in _rows(root) if row["collection"] != collection.name] + own
    names = dict.fromkeys(row["collection"] for row in rows)
    totals = {name: sum(row["seconds"] for row in rows if row["collection"] == name) for name in names}
    found = {"runs": rows, "totals": [{"collection": name, "seconds": round(one, 1)} for name, one in totals.items()]}
    atomic.write_bytes(root / TIMES, (json.dumps(found, indent=1) + "\n").encode())


def processor() -> str:
    """The kind of processor, as the system calls it; no name of the machine."""
    try:
        names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()
