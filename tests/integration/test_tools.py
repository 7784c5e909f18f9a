"""The linters find nothing; the type checker, which takes half a minute, is a part of ``make lint``."""

import os
import subprocess
import sys
from pathlib import Path

from places import ROOT


def tool(*command: str) -> None:
    paths = os.pathsep.join([str(ROOT / "src"), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths})
    assert run.returncode == 0, run.stdout + run.stderr


def test_ruff():
    tool(sys.executable, "-m", "ruff", "check", "--no-cache", "--output-format=concise")


def test_contracts_of_the_layers():
    tool(str(Path(sys.executable).with_name("lint-imports")), "--no-logo")
