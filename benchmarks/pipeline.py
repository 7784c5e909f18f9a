"""Where the time of the pipeline goes: every figure group from nothing, with kernels compiled.

`python benchmarks/pipeline.py OUTPUT.json [FOLDER]`, from anywhere. Each group's simulations and drawings run as the
pipeline runs them, into a scratch folder (or an empty one that is kept), with all cores; rest states are shared from
group to group as there. Groups that neither draw a figure of the paper nor check one of its claims are not in the sum.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from contextlib import nullcontext
from pathlib import Path

from startup import run
from timing import write

from granular_response_paper.claims.table import CLAIMS
from granular_response_paper.claims.table import GROUPS as JUDGED

ROOT = Path(__file__).resolve().parents[1]


def groups() -> list[str]:
    """Figure groups in the order in which they can run."""
    listed = ROOT / "src" / "granular_response_paper" / "groups" / "groups.json"
    return list(json.loads(listed.read_text(encoding="utf-8"))["groups"])


def of_the_paper(group: str) -> bool:
    """Whether the group has a figure of the paper, drawn in this folder, or data that its claims read."""
    beyond = {claim.group for claim in CLAIMS if claim.beyond} - {c.group for c in CLAIMS if not c.beyond}
    return any(Path("figures", group).glob("fig[0-9]*")) or (group in JUDGED and group not in beyond)


def main(path: str, folder: str | None = None) -> None:
    output = Path(path).resolve()
    command = [sys.executable, "-m", "granular_response_paper"]
    rows = []
    with nullcontext(folder) if folder else tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "data").mkdir(parents=True)
        (Path(scratch) / "params.yaml").write_bytes((ROOT / "params.yaml").read_bytes())
        (Path(scratch) / "survey").symlink_to(ROOT / "survey")  # some groups read stored packings
        os.chdir(scratch)
        begin = time.perf_counter()
        for group in groups():
            row = {"group": group}
            for part in ("simulate", "draw"):
                # wall-clock only: processor time of the workers is not that of children of this process
                row[f"{part}_seconds"] = run([*command, part, group])["seconds"]
            row["paper"] = of_the_paper(group)
            rows.append(row)
            print(row, flush=True)
        whole = time.perf_counter() - begin
    paper = [row for row in rows if row["paper"]]
    total = {
        "cores": os.process_cpu_count() if hasattr(os, "process_cpu_count") else len(os.sched_getaffinity(0)),
        "simulate_seconds": sum(row["simulate_seconds"] for row in paper),
        "draw_seconds": sum(row["draw_seconds"] for row in paper),
        "seconds_with_extensions": whole,
    }
    write(str(output), {"runs": rows, "totals": [total]})


if __name__ == "__main__":
    main(*sys.argv[1:3])
