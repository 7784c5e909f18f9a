"""Seconds of every stage from nothing: runs all stages of both collections, and reads what the command says.

`python pipeline.py pipeline.json`, by hand: it runs DVC, so it is no stage of `dvc.yaml`.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from timing import processor, write

LINE = re.compile(r"^ *\d+ of (\d+)  ([\w@]+) +([\d.]+) s ")


def main(path: str) -> None:
    rows, totals, machine = [], [], f"{processor()}, {os.cpu_count()} cores"
    for collection in ("paper", "extensions"):
        command = [sys.executable, "-m", "granular_response_paper", "reproduce", "--force", "--collection", collection]
        root = Path(__file__).resolve().parents[1]
        said = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, text=True, check=True).stdout
        found = [match.groups() for match in map(LINE.match, said.splitlines()) if match]
        assert found and len(found) == int(found[0][0]), f"{collection}: not every stage has run"
        seconds = {stage: float(number) for _, stage, number in found}
        common = {"collection": collection, "measured_on": machine}
        rows += [common | {"stage": stage, "seconds": number} for stage, number in seconds.items()]
        totals.append({"collection": collection, "seconds": round(sum(seconds.values()), 1)})
    write(path, {"runs": rows, "totals": totals}, measured=False)


if __name__ == "__main__":
    main(sys.argv[1])
