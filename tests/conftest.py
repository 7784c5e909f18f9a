"""Settings that every test shares."""

import os
from pathlib import Path

import xdist
from commands import preload
from hypothesis import settings

from granular_response.machine import floating_point

floating_point.pin()  # before anything loads numpy, as the command line does
os.environ.setdefault("MPLBACKEND", "Agg")
# Repositories of tests are their own, whatever the user's settings are and though a hook of git runs the tests; what
# make gives to a make within it does not reach the ones that tests start.
for _name in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "MAKEFLAGS", "MAKELEVEL", "MFLAGS", "MAKEOVERRIDES"):
    os.environ.pop(_name, None)
os.environ["GIT_CONFIG_GLOBAL"] = os.devnull
# modules that new processes import find the helpers of tests, as here
_paths = str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, _paths))


def pytest_sessionstart(session):
    if not xdist.is_xdist_controller(session):
        preload()


# Properties are tried on the same examples every time. GRANULAR_RESPONSE_FUZZ=5000 tries as many new ones of each.
settings.register_profile("default", derandomize=True, deadline=None, max_examples=100)
settings.register_profile(
    "fuzz", deadline=None, max_examples=int(os.environ.get("GRANULAR_RESPONSE_FUZZ", "0")) or 100, print_blob=True
)
settings.load_profile("fuzz" if "GRANULAR_RESPONSE_FUZZ" in os.environ else "default")
