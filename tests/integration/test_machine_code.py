"""Machine code: where it is kept, never that of other sources, and the same digits on every processor."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import llvmlite.binding as llvm
import numba as nb
import numpy as np
import pytest
from commands import python

from granular_response.machine import machine_code

PACKAGE = Path(machine_code.__file__).parents[1]
#: Processors to compile for, with what they ask of the one that runs it.
PROCESSORS = {"haswell": ["avx2", "fma", "bmi2"], "skylake-avx512": ["avx512f", "avx512vl", "avx512dq", "avx512bw"]}

#: A kernel of one file, with what another one has inlined into it.
SCRIPT = """
from granular_response.contact import Linear
from granular_response.contact.pair import frictionless_pair
print(frictionless_pair(1.99, 0.0, 0.0, 0.0, 2.0, None, Linear(1000.0, 0.0, 0.0, 0.0, 0.0, 0.0))[0])
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


#: Compiles a kernel for one type while another process does so for another one; the index takes long to write.
KEEP = """
import sys, time
import numpy as np
from numba.core.caching import IndexDataCacheFile
from granular_response.machine.machine_code import kernel
from shared_kernel import doubled
write = IndexDataCacheFile._save_index
IndexDataCacheFile._save_index = lambda *given: (time.sleep(0.5), write(*given))
print(doubled(np.dtype(sys.argv[1]).type(3)), sum(doubled.stats.cache_hits.values()))
"""


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_processes_that_compile_a_kernel_at_once_for_different_types_keep_each_their_own(tmp_path):
    source = "from granular_response.machine.machine_code import kernel\ndoubled = kernel(lambda x: x + x)\n"
    (tmp_path / "shared_kernel.py").write_text(source)
    path = os.pathsep.join([str(tmp_path), str(PACKAGE.parent)])
    environment = {**os.environ, "PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    for hits in "0", "1":
        running = [
            subprocess.Popen([sys.executable, "-c", KEEP, kind], env=environment, stdout=subprocess.PIPE, text=True)
            for kind in ("i8", "f8")
        ]
        said = [process.communicate()[0].split() for process in running]
        assert said == [["6", hits], ["6.0", hits]]


@pytest.mark.skipif(nb.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_pipe_in_the_place_of_the_lock_is_not_waited_for(tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "lock")
    monkeypatch.setattr(machine_code, "cache_folder", lambda: tmp_path)
    assert machine_code.kernel(_doubled)(3.0) == 6.0
    assert list(tmp_path.rglob("*.nbi"))  # kept all the same


def _doubled(x):
    return 2.0 * x


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
    values = np.array([float.fromhex(one) for one in first.split()])
    exact = []
    for b in range(8, 129, 8):
        n = 2 * b + 3
        matrix = np.random.default_rng(b).standard_normal((n, n)) + 4.0 * b * np.eye(n)
        exact.append(np.linalg.solve(np.tril(np.triu(matrix, -b), b), np.ones(n)))
    np.testing.assert_allclose(values, np.concatenate(exact), rtol=1e-13)


def test_every_compiled_module_is_among_the_sources_that_name_the_machine_code():
    compiled = [path for path in PACKAGE.rglob("*.py") if re.search(r"^@kernel|^@by_type", path.read_text(), re.M)]
    names = [path.relative_to(PACKAGE).as_posix() for path in compiled]
    assert len(names) > 8 and [name for name in names if not name.startswith(machine_code.SOURCES)] == []
