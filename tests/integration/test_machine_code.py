"""Machine code: where it is kept, never that of other sources, and the same digits on every processor."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import llvmlite.binding as llvm
import numba as nb
import pytest
from commands import python

from granular_response.machine import machine_code

PACKAGE = Path(machine_code.__file__).parents[1]
#: Processors to compile for, with what they ask of the one that runs it.
PROCESSORS = {"haswell": ["avx2", "fma", "bmi2"], "skylake-avx512": ["avx512f", "avx512vl", "avx512dq", "avx512bw"]}

#: A kernel of one file, with what another one has inlined into it.
SCRIPT = """
from granular_response.contact import Linear
from granular_response.contact.law import normal_force
print(normal_force(0.01, None, 0.0, Linear(1000.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
"""


def force(folder: Path, cache: Path) -> float:
    return float(python("-c", SCRIPT, PYTHONPATH=str(folder), NUMBA_CACHE_DIR=str(cache)))


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


#: A module with a kernel, and a script that prints what it gives and whether its code was found.
SHARED = "from granular_response.machine.machine_code import kernel\ndoubled = kernel(lambda x: x + x)\n"
CALL = """
import sys
import numpy as np
from shared_kernel import doubled
print(doubled(np.dtype(sys.argv[1]).type(3)), sum(doubled.stats.cache_hits.values()))
"""
#: The same; it does not end its compilation before another process waits for it (a file says that one does).
COMPILE_WHILE_ANOTHER_WAITS = """
import pathlib, time
from granular_response.machine import machine_code
pause, save, there = time.sleep, machine_code._Files._save_index, pathlib.Path("waiting").exists
def waited(*given):
    until = time.monotonic() + 120.0
    while not there() and time.monotonic() < until:
        pause(0.01)
    save(*given)
machine_code._Files._save_index = waited
time.sleep = lambda seconds: (pathlib.Path("waiting").touch(), pause(seconds))
"""


@pytest.fixture
def called(tmp_path):
    """Calls the shared kernel in new processes that begin at once; what each has printed, and its messages."""
    (tmp_path / "shared_kernel.py").write_text(SHARED)
    path = os.pathsep.join([str(tmp_path), str(PACKAGE.parent)])
    environment = {**os.environ, "PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}

    def call(*kinds, before=""):
        command = [sys.executable, "-c", before + CALL]
        options = {"env": environment, "cwd": tmp_path, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        running = [subprocess.Popen([*command, kind], text=True, **options) for kind in kinds]
        ended = [one.communicate() for one in running]
        return [out.split() for out, _ in ended], [said for _, said in ended]

    return call


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_processes_that_compile_a_kernel_at_once_for_different_types_keep_each_their_own(called):
    for hits in "0", "1":
        assert called("i8", "f8")[0] == [["6", hits], ["6.0", hits]]


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_of_processes_that_need_a_kernel_at_once_one_compiles_it(called, tmp_path):
    said, _ = called("f8", "f8", before=COMPILE_WHILE_ANOTHER_WAITS)
    assert (tmp_path / "waiting").exists() and sorted(said) == [["6.0", "0"], ["6.0", "1"]]


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_damaged_machine_code_is_compiled_again_and_named_once(called, tmp_path, kind):
    """Index or code alone; files that are cut or empty, and all at once: ``test_kept.py``."""
    called("f8")
    (file,) = (tmp_path / "cache").rglob(f"shared_kernel*.{kind}")
    content = file.read_bytes()
    file.write_bytes(content[:-40] + bytes([content[-40] ^ 1]) + content[-39:])
    said, messages = called("f8")
    assert said == [["6.0", "0"]] and messages[0].count("so kernels are compiled again") == 1
    assert str(tmp_path / "cache") in messages[0]
    assert called("f8") == ([["6.0", "1"]], [""])


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_code_for_other_arguments_and_a_pipe_are_not_taken_for_what_the_index_names(called, tmp_path):
    """A file system without locks, or a folder that was copied in parts."""
    called("i8"), called("f8")
    one, other = (tmp_path / "cache").rglob("shared_kernel*.nbc")
    one.rename(other.with_suffix("")), other.rename(one), other.with_suffix("").rename(other)
    said, messages = called("i8")
    assert said == [["6", "0"]] and "cannot be read (ValueError)" in messages[0]
    for kind in "nbi", "nbc":
        for file in [*(tmp_path / "cache").rglob(f"shared_kernel*.{kind}")]:
            file.unlink()
            os.mkfifo(file)
        assert called("i8")[0] == [["6", "0"]]


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_pipe_in_the_place_of_the_lock_is_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(machine_code, "cache_folder", lambda: tmp_path)
    compiled = machine_code.kernel(_doubled)
    lock = Path(compiled._cache._cache_path) / f"{compiled._cache._impl.filename_base}.lock"
    os.mkfifo(lock)
    assert compiled(3.0) == 6.0
    assert list(tmp_path.rglob("*.nbi"))  # kept all the same


def _doubled(x):
    return 2.0 * x


def test_an_installed_package_keeps_nothing_within_itself(tmp_path, monkeypatch):
    """Else ``pip uninstall`` leaves a folder that can be imported."""
    package = tmp_path / "lib" / "site-packages" / "granular_response"
    monkeypatch.setattr(machine_code, "_PACKAGE", package)
    found = [*machine_code._bases()]
    assert found and not [one for one in found if one.is_relative_to(package)]
    monkeypatch.setattr(machine_code, "_PACKAGE", tmp_path / "src" / "granular_response")
    assert any(one.is_relative_to(tmp_path / "src") for one in machine_code._bases())


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


#: Solutions with matrices up to a wide band, in hexadecimal: sums over lanes, and fused products.
SUMS = """
import numpy as np
from granular_response.linalg.band_lu import eliminate, padded, solve, stride
found = []
for b in range(8, 129, 8):
    n = 2 * b + 3
    matrix = np.random.default_rng(b).standard_normal((n, n)) + 4.0 * b * np.eye(n)
    rows = np.zeros((n, stride(b)))
    for i in range(n):
        first, last = max(0, i - b), min(n, i + b + 1)
        rows[i, b + first - i : b + last - i] = matrix[i, first:last]
    x = padded(np.ones((1, n)), b)
    eliminate(rows.ravel(), n, b)
    solve(rows.ravel(), n, b, x.reshape(-1), x.shape[1])
    found += [*x[0, b : b + n]]
print(*(float(value).hex() for value in found))
"""


@pytest.mark.parametrize("said", [True, {"reassoc"}])
def test_no_kernel_leaves_the_order_of_its_sums_to_the_compiler(said):
    """Which takes that of the processor's registers: the same scene then had other digits on another machine."""
    with pytest.raises(ValueError, match="fastmath is not allowed"):
        machine_code.kernel(fastmath=said)(lambda x: x)


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_sums_are_the_same_compiled_for_processors_with_wide_and_with_narrow_registers(tmp_path):
    features = llvm.get_host_cpu_features()
    kinds = [kind for kind, needs in PROCESSORS.items() if all(features.get(one) for one in needs)]
    if len(kinds) < 2:
        pytest.skip("this processor runs no code for another one")
    first, *others = (python("-c", SUMS, NUMBA_CPU_NAME=kind, NUMBA_CACHE_DIR=str(tmp_path)) for kind in kinds)
    assert set(others) == {first}


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_no_kernel_has_a_form_for_c_to_call():
    """Which nobody calls, and which an eighth of the time to compile went to."""
    added = machine_code.kernel(lambda x: x + 1.0)
    assert added(1.0) == 2.0
    (code,) = added.inspect_llvm().values()
    assert "cpython" in code and "cfunc" not in code


def test_every_compiled_module_is_among_the_sources_that_name_the_machine_code():
    compiled = [path for path in PACKAGE.rglob("*.py") if re.search(r"^@kernel|^@by_type", path.read_text(), re.M)]
    names = [path.relative_to(PACKAGE).as_posix() for path in compiled]
    assert len(names) > 8 and [name for name in names if not name.startswith(machine_code.SOURCES)] == []
