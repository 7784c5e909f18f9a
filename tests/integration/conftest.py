"""A Dask cluster for all who ask for one."""

import pytest


@pytest.fixture(scope="module")
def cluster():
    """A scheduler and two worker processes on this machine, each started again when it dies."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50, host="127.0.0.1"
    ) as cluster:
        yield cluster
