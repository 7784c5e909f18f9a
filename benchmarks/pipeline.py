"""Where the time of the pipeline goes: every figure group from nothing, with kernels compiled.

`python benchmarks/pipeline.py OUTPUT.json`, from the root of the repository or from here. Each group's simulations and
drawings run as the pipeline runs them, into a scratch folder, with all cores; rest states are shared from group to
group as there. `stability` is not one of the paper's groups, so it is not in the sum.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import yaml
from startup import run
from timing import write

ROOT = Path(__file__).resolve().parents[1]
EXTENSIONS = ("stability",)


def groups() -> list[str]:
    """Figure groups in the order in which they can run."""
    stages = yaml.safe_load((ROOT / "dvc.yaml").read_text(encoding="utf-8"))["stages"]
    return [*stages["simulate"]["foreach"], *stages["derive"]["foreach"]]


def main(path: str) -> None:
    output = Path(path).resolve()
    command = [sys.executable, "-m", "granular_response"]
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "data").mkdir()
        (Path(scratch) / "params.yaml").write_bytes((ROOT / "params.yaml").read_bytes())
        os.chdir(scratch)
        begin = time.perf_counter()
        for group in groups():
            row = {"group": group, "paper": group not in EXTENSIONS}
            for part in ("simulate", "draw"):
                row |= {f"{part}_{key}": value for key, value in run([*command, part, group]).items()}
            rows.append(row)
            print(row, flush=True)
        whole = time.perf_counter() - begin
    paper = [row for row in rows if row["paper"]]
    total = {
        "cores": os.process_cpu_count() if hasattr(os, "process_cpu_count") else len(os.sched_getaffinity(0)),
        "simulate_seconds": sum(row["simulate_seconds"] for row in paper),
        "draw_seconds": sum(row["draw_seconds"] for row in paper),
        "processor_seconds": sum(row["simulate_processor_seconds"] + row["draw_processor_seconds"] for row in paper),
        "seconds_with_extensions": whole,
    }
    write(str(output), {"runs": rows, "totals": [total]})


if __name__ == "__main__":
    main(sys.argv[1])
