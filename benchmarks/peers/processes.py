"""How another code is run and what it used: the same for all that the arena times.

A stage is one `run` of a script; stamps before and after it hold the processor time and the memory of the process,
which the codes do not tell alike, or not at all.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

#: What a script has written about its process, which is the parent of the shell that runs this, or of a shell between.
#: Linux alone tells it; elsewhere nothing is written.
STAMP = """process=$PPID
while read -r name < /proc/$process/comm; do
  case $name in
    sh|dash|bash) process=$(sed -n 's/^PPid:[^0-9]*//p' /proc/$process/status) ;;
    *) break ;;
  esac
done 2>/dev/null
cat /proc/$process/schedstat >> processor 2>/dev/null
grep VmHWM /proc/$process/status > memory 2>/dev/null
true
"""


@dataclass(frozen=True)
class Stage:
    """What some steps took; ``processor`` is None where the system does not tell it."""

    steps: int
    seconds: float
    processor: float | None


@dataclass(frozen=True)
class Used:
    """The stages of a process, and its peak memory where the system tells it."""

    stages: list[Stage]
    peak_mebibytes: float | None

    def least(self) -> dict[str, float | None]:
        """Seconds of a step, the least of all stages after the first, which settles; and peak memory."""
        timed = self.stages[1:]
        processor = [stage.processor / stage.steps for stage in timed if stage.processor is not None]
        return {
            "seconds": min(stage.seconds / stage.steps for stage in timed),
            "processor": min(processor, default=None),
            "peak_mebibytes": self.peak_mebibytes,
        }

    def whole(self) -> dict[str, float | None]:
        """Steps and seconds of all stages together."""
        processor = [stage.processor for stage in self.stages]
        return {
            "steps": sum(stage.steps for stage in self.stages),
            "seconds": sum(stage.seconds for stage in self.stages),
            "processor": None if None in processor else sum(processor),
        }


def stage(steps: int, first: bool = False) -> str:
    """`run` between stamps, in the language of LAMMPS; only the first one sets up."""
    going = "" if first else " pre no post no"
    return f"shell sh stamp.sh\nrun {steps}{going}\nshell sh stamp.sh"


def settled_stages(settle: int, steps: int, repeats: int) -> str:
    """Steps to settle in, and stages to time."""
    return "\n".join([stage(settle, first=True), *[stage(steps)] * repeats])


def launch(arguments: list[str], folder: str | os.PathLike[str]) -> subprocess.CompletedProcess[str]:
    """A process on one thread."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.run(arguments, cwd=folder, env=environment, capture_output=True, text=True)


@contextmanager
def script(command: str, disks: str, text: str) -> Iterator[tuple[Used, Path]]:
    """Runs a script of LAMMPS or LIGGGHTS; what it used and the folder with what it wrote, which goes at the end."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in (("slab.data", disks), ("in.slab", text), ("stamp.sh", STAMP)):
            (folder / file).write_text(content)
        done = launch([command, "-in", "in.slab", "-screen", "none", "-log", "log"], folder)
        log = (folder / "log").read_text() if (folder / "log").exists() else ""
        if done.returncode:
            errors = [line for line in log.splitlines() if "ERROR" in line]
            raise RuntimeError(f"{command} failed: {' '.join(errors) or done.stderr}")
        yield used(folder, log), folder


def used(folder: Path, log: str) -> Used:
    """Stages from the log, each with the processor time between the two stamps around it."""
    loops = re.findall(r"Loop time of ([\d.eE+-]+) on \d+ procs for (\d+) steps", log)
    stamps: list[float] = []
    if (folder / "processor").exists():
        stamps = [1e-9 * int(line.split()[0]) for line in (folder / "processor").read_text().splitlines()]
    between = [after - before for before, after in zip(stamps[::2], stamps[1::2], strict=False)]
    known = between if len(between) == len(loops) else [None] * len(loops)
    stages = [Stage(int(n), float(t), p) for (t, n), p in zip(loops, known, strict=True)]
    return Used(stages, peak((folder / "memory").read_text() if (folder / "memory").exists() else ""))


def peak(status: str) -> float | None:
    """MiB of the largest resident memory in the text of `/proc/PID/status`."""
    found = re.search(r"VmHWM:\s*(\d+) kB", status)
    return int(found.group(1)) / 1024 if found else None


def own_peak() -> float | None:
    """Peak memory of this process."""
    status = Path("/proc/self/status")
    return peak(status.read_text()) if status.exists() else None
