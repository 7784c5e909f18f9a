"""Settings that every test shares."""

import contextlib
import fcntl
import multiprocessing
import os
import sys
from multiprocessing import forkserver

import pytest
import xdist
from hypothesis import settings

from granular_response.machine import floating_point

floating_point.pin()  # before anything loads numpy, as the command line does
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.pop("DASK_SCHEDULER_ADDRESS", None)  # a sweep in a test runs where the test says

#: What most worker processes and commands of tests import, with what the test modules do whose functions they run.
IMPORTED = [
    "granular_response.api.sweep",
    "granular_response.cli.main",
    "granular_response.store.result",
    "granular_response_paper.cli",
    "hypothesis",
    "pytest",
    "xarray",
]


def pytest_sessionstart(session):
    """Processes are forked from one that has imported this much, which each would else import by itself."""
    if not xdist.is_xdist_controller(session):
        multiprocessing.get_context("forkserver").set_forkserver_preload(IMPORTED)
        forkserver.ensure_running()


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """In a fresh clone one process prepares the asserts of a module, and the others wait and read what it has kept."""
    with contextlib.ExitStack() as held:
        if isinstance(collector, pytest.Module) and xdist.is_xdist_worker(collector) and not _prepared(collector.path):
            with contextlib.suppress(OSError):  # a file system without locks
                fcntl.flock(held.enter_context(collector.path.open()), fcntl.LOCK_EX)
        return (yield)


def _prepared(path):
    """Whether there is bytecode of a test module as it is; none is waited for if none is kept."""
    kept = (path.parent / "__pycache__").glob(f"{path.stem}.*-pytest-*.pyc")
    return sys.dont_write_bytecode or any(one.stat().st_mtime >= path.stat().st_mtime for one in kept)


# Properties are tried on the same examples every time. GRANULAR_RESPONSE_FUZZ=5000 tries as many new ones of each.
settings.register_profile("default", derandomize=True, deadline=None, max_examples=100)
settings.register_profile(
    "fuzz", deadline=None, max_examples=int(os.environ.get("GRANULAR_RESPONSE_FUZZ", "0")) or 100, print_blob=True
)
settings.load_profile("fuzz" if "GRANULAR_RESPONSE_FUZZ" in os.environ else "default")
