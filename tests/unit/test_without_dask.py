"""Commands load Dask where a cluster is asked for, and not to read a result."""

import subprocess
import sys
from importlib.util import find_spec

import pytest

# looked for and not imported, which takes its time in every process of the tests
pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="distributed is not installed")

SCRIPT = """
import sys
from granular_response.machine import without_dask
without_dask.hide()
import xarray as xr
data = xr.DataArray([1.0, 2.0], dims="x")
assert float(((data + 1.0).astype(int) * data).mean()) == 4.0
assert not any(name.startswith("dask.") for name in sys.modules)
without_dask.show()
import distributed
without_dask.hide()
without_dask.show()
assert sys.modules["dask"] is distributed.client.dask
"""


def test_dask_counts_as_absent_until_it_is_asked_for():
    run = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_commands_hide_it():
    script = "import sys; from granular_response.cli.main import main; sys.argv = ['granular-response', '--help']\n"
    script += "try:\n    main()\nfinally:\n    assert sys.modules['dask'] is None"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
