"""Where machine code is kept: it is never that of other sources."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from granular_response.machine import machine_code

PACKAGE = Path(machine_code.__file__).parents[1]

#: A kernel of one file, with what another one has inlined into it.
SCRIPT = """
from granular_response.contact import Linear
from granular_response.contact.pair import frictionless_pair
print(frictionless_pair(1.99, 0.0, 0.0, 0.0, 2.0, None, Linear(1000.0, 0.0, 0.0, 0.0, 0.0, 0.0))[0])
"""


def force(folder: Path, cache: Path) -> float:
    environment = {**os.environ, "PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(cache)}
    run = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return float(run.stdout)


def test_an_edit_of_one_file_reaches_the_kernels_of_another(tmp_path):
    """Numba looks at the file of a kernel alone, so a cache of the user's gave the force of before the edit."""
    copy = tmp_path / "granular_response"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__", "paper"))
    cache = tmp_path / "cache"
    assert force(tmp_path, cache) == pytest.approx(10.0)
    kept = set(cache.rglob("*.nbc"))
    assert kept
    law = copy / "contact" / "linear.py"
    law.write_text(law.read_text().replace("return self.normal_stiffness * overlap", "return 7.0"))
    assert force(tmp_path, cache) == pytest.approx(7.0)
    assert kept < set(cache.rglob("*.nbc"))  # nothing is deleted


def test_the_first_folder_that_can_be_written_is_taken(tmp_path, monkeypatch):
    blocked = tmp_path / "blocked"
    blocked.write_text("a file")
    bases = [blocked / "no-folder", tmp_path / "second"]
    monkeypatch.setattr(machine_code, "_bases", lambda: iter(bases))
    machine_code.cache_folder.cache_clear()
    try:
        assert machine_code.cache_folder() == bases[1] / machine_code.source_digest()
        machine_code.cache_folder.cache_clear()
        monkeypatch.setattr(machine_code, "_bases", lambda: iter(bases[:1]))
        assert machine_code.cache_folder() is None
        assert machine_code.kernel(lambda x: x + 1.0)(1.0) == 2.0  # compiled all the same
    finally:
        machine_code.cache_folder.cache_clear()
