"""Settings that every test shares."""

import multiprocessing
import os
from multiprocessing import forkserver

import xdist
from hypothesis import settings

from granular_response.machine import floating_point

floating_point.pin()  # before anything loads numpy, as the command line does
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.pop("DASK_SCHEDULER_ADDRESS", None)  # a sweep in a test runs where the test says

#: What worker processes and commands of tests import, with what the test modules do whose functions they run.
IMPORTED = [
    "granular_response.api.sweep",
    "granular_response.cli.main",
    "granular_response.plot.pictures",
    "granular_response.store.export",
    "granular_response.store.result",
    "granular_response.store.summary",
    "granular_response_paper.archive.crate",
    "granular_response_paper.claims.table",
    "granular_response_paper.cli",
    "granular_response_paper.pipeline.drawing",
    "granular_response_paper.pipeline.simulation",
    "granular_response_paper.report",
    "hypothesis",
    "pytest",
    "xarray",
]


def pytest_sessionstart(session):
    """Processes are forked from one that has imported this much, which each would else import by itself."""
    if not xdist.is_xdist_controller(session):
        multiprocessing.get_context("forkserver").set_forkserver_preload(IMPORTED)
        forkserver.ensure_running()


# Properties are tried on the same examples every time. GRANULAR_RESPONSE_FUZZ=5000 tries as many new ones of each.
settings.register_profile("default", derandomize=True, deadline=None, max_examples=100)
settings.register_profile(
    "fuzz", deadline=None, max_examples=int(os.environ.get("GRANULAR_RESPONSE_FUZZ", "0")) or 100, print_blob=True
)
settings.load_profile("fuzz" if "GRANULAR_RESPONSE_FUZZ" in os.environ else "default")
