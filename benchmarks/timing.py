"""What all benchmarks share: the scene they time, seconds of calls and of processes, exponents, and JSON files."""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.store import atomic
from granular_response_paper.checkout import check


def processor() -> str:
    """The kind of processor, as the system calls it; no name of the machine."""
    try:
        names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()


def scene(friction: float, force: float, **protocol: Any) -> Scene:
    """The paper's slab with one load on the middle of its top row."""
    loads = [{"disk": "top-centre", "force": [0.0, -force]}]
    return Scene.from_dict({"contact": {"friction": friction}, "loads": loads, "protocol": protocol})


def floor(state, problem: Problem) -> np.ndarray:
    """Forces of the floor on the bottom row."""
    return state.walls.normal_force[: int((problem.packing.row == 0).sum())]


def least(action: Callable[[], Any], repeats: int = 1, long: float = np.inf) -> tuple[Any, dict[str, float]]:
    """What an action returns, and its least seconds by the clock and of the processor; none after ``long``."""
    found = {"seconds": np.inf, "processor": np.inf}
    for _ in range(repeats):
        clock, processor = time.perf_counter(), time.process_time()
        made = action()
        used = {"seconds": time.perf_counter() - clock, "processor": time.process_time() - processor}
        found = {key: min(found[key], used[key]) for key in found}
        if used["processor"] > long:
            break
    return made, found


def process(command: list[str], **environment: str) -> dict[str, float]:
    """Wall-clock and processor seconds, and GiB of memory, of a process. Raises RuntimeError where it fails."""
    start = time.perf_counter()
    running = subprocess.Popen(command, env={**os.environ, **environment}, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(running.pid, 0)
    seconds = time.perf_counter() - start
    running.returncode = os.waitstatus_to_exitcode(status)
    if running.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with code {running.returncode}")
    used = usage.ru_utime + usage.ru_stime
    return {"seconds": seconds, "cpu_seconds": used, "peak_gibibytes": usage.ru_maxrss / 2**20}


def power(x: list[float], y: list[float]) -> float:
    """The exponent of the power law that is fitted to y against x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def stored(path: str, name: str = "runs") -> list[dict[str, Any]]:
    """The rows under a name in a JSON file; none before its first run."""
    return json.loads(Path(path).read_text(encoding="utf-8")).get(name, []) if Path(path).exists() else []


def write(path: str, metrics: dict[str, Any], *, measured: bool = True) -> None:
    """A JSON file with numbers of six digits, since more is noise, and what they were ``measured`` on.

    Raises CheckoutError where the package that runs is not that of this checkout.
    """
    check(start=Path(__file__).parent)
    if measured:
        metrics = {"measured_on": processor(), **metrics}

    def rounded(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: rounded(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [rounded(item) for item in value]
        if isinstance(value, float | np.floating):
            return float(f"{value:.6g}")
        return value

    atomic.write_bytes(path, (json.dumps(rounded(metrics), indent=1) + "\n").encode())
