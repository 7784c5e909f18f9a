"""What is kept decides nothing: machine code, rest states and results in folders that nobody can enter, write or fill.

Each is tried by a process that permissions hold for, root's too.
"""

import ctypes
import os
import re
import resource
import shutil
import subprocess
import sys

import pytest
from commands import LONGEST

#: Of Linux: to take from this process, and from what it starts, the right to pass over permissions.
PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH = 24, 1, 2
CODE, STATES, RESULTS = FOLDERS = ("code", "states", "results")
MODULE = "from granular_response.machine.machine_code import kernel\ndoubled = kernel(lambda x: x + x)\n"
SCRIPT = """
from pathlib import Path
import granular_response as gr
from granular_response.machine import machine_code
from granular_response.sweeps import rest
from granular_response.sweeps.resources import using
scene = gr.Scene(packing=gr.Slab(layers=2, disks_per_row=3), contact=gr.Contact(friction=0.0))
with using(rest_states=Path("states")):
    print(rest.rest_of(scene).position.tobytes().hex())
print(gr.map_tasks(abs, [-1, -2, -3], workers=1, checkpoint="results"))
machine_code._bases = lambda: iter([Path("code").absolute()])  # kernels of the package are where they ever are
machine_code.cache_folder.cache_clear()
from twice import doubled
print(doubled(3.0), doubled(3), sum(doubled.stats.cache_hits.values()))
"""
NOWHERE = "no folder for machine code can be written, so kernels are compiled in every process"


def run(folder, full=False):
    """What the script prints in a folder, and what it says of each folder."""

    def begin():
        for right in (CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH):
            ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, right, 0, 0, 0)
        if full:  # a pipe is no file
            resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=folder, capture_output=True, text=True, preexec_fn=begin, timeout=LONGEST,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(folder)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    *same, found = done.stdout.rsplit(maxsplit=1)
    lines = [line for line in done.stderr.splitlines() if not line.startswith("  ")]
    memory = {name: [line.partition(f"{folder / name}: ")[2] for line in lines] for name in (STATES, RESULTS)}
    code = [line for line in lines if line.startswith(("machine code in", "no folder for"))]
    return same, int(found), {CODE: code} | {name: [*filter(None, said)] for name, said in memory.items()}, len(lines)


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A folder with all that is kept, a copy of it, and what the script prints."""
    folder = tmp_path_factory.mktemp("kept")
    (folder / "twice.py").write_text(MODULE)
    printed, found, _, lines = run(folder)
    assert (found, lines) == (0, 0)
    assert run(folder) == (printed, 2, {name: [] for name in FOLDERS}, 0)
    return folder, shutil.copytree(folder, tmp_path_factory.mktemp("copy") / "kept"), printed


ALL = " ".join(FOLDERS)
EACH_FILE, FULL = f"find {ALL} -type f ! -name '*.lock' -exec", f"rm -r {ALL}"
AGAIN = r"machine code in \S+ cannot be read \(\w+\), so kernels are compiled again"
DENIED = ["kept results cannot be read and are computed again: Permission denied"]
CLOSED = "nothing more is kept there: "


@pytest.mark.parametrize(
    ("damage", "of_code", "of_values"),
    [
        (f"chmod 0 {ALL}", NOWHERE, [*DENIED, f"{CLOSED}Permission denied"]),
        (f"chmod -R a-w {ALL}", NOWHERE, []),
        (f"{EACH_FILE} chmod 0 {{}} +", AGAIN, [*DENIED, f"{CLOSED}Permission denied"]),
        (f"{EACH_FILE} truncate -s 0 {{}} +", AGAIN, ["damaged results are computed again"]),
        (f"{EACH_FILE} truncate -s -10 {{}} +", AGAIN, ["damaged results are computed again"]),
        (FULL, r"machine code in \S+ cannot be written \(\w+\), so kernels are", [f"{CLOSED}File too large"]),
    ],
    ids=["no entry", "read-only", "no reading", "empty", "cut", "full"],
)
def test_what_is_kept_changes_no_result_and_each_folder_is_named_once(kept, damage, of_code, of_values):
    folder, copy, printed = kept
    shutil.rmtree(folder)
    shutil.copytree(copy, folder)  # kept code is that of a file in its place
    subprocess.run(damage, shell=True, cwd=folder, check=True)
    try:
        same, found, said, lines = run(folder, full=damage == FULL)
    finally:
        subprocess.run(["chmod", "-R", "u+rwX", folder], check=True)  # else nobody but root can remove it
    assert (same, found) == (printed, 0)
    assert len(said[CODE]) == 1 and re.match(of_code, said[CODE][0])
    assert said[STATES] == said[RESULTS] == of_values
    assert lines == 1 + 2 * len(of_values)
