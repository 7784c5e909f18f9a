"""Settings that every test shares."""

import os

from granular_response import floating_point

floating_point.pin()  # before anything loads numpy, as the command line does
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.pop("DASK_SCHEDULER_ADDRESS", None)  # a sweep in a test runs where the test says
os.environ.pop("GRANULAR_RESPONSE_CHECKPOINT", None)
