"""Floor response of slabs of many realizations at two frictions, on a cluster.

On the cores of one node, as one part of a job array, or over the workers of MPI or Dask. Solutions are kept in the
folder ``kept``, so a job that ran out of time goes on when it is submitted again.
"""

from __future__ import annotations

import argparse
import os

import granular_response as gr

SCENE = gr.Scene().updated(
    {
        "packing.layers": 10,
        "packing.disks_per_row": 41,
        "packing.polydispersity": 0.1,
        "packing.lattice_constant": "touching-largest",
        "preparation.gravity": "frictionless",
        "loads.0.force": [0.0, -2.0],
    }
)
AXES = {"contact.friction": [0.2, 1.0], "packing.realization": range(200)}


def measure(result: gr.Result) -> dict[str, float]:
    below = result.response_at(0.0, smooth=2.0).isel(load=-1)
    return {"response_below": float(below), "sliding": int((result.contacts_table().status == "sliding").sum())}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--part", action="store_true", help="solve the part of this task of a job array alone")
    parser.add_argument("--mpi", action="store_true", help="over the ranks of python -m mpi4py.futures")
    parser.add_argument("--dask", metavar="FILE", help="over the cluster of a Dask scheduler file")
    options = parser.parse_args()
    axes, executor = dict(AXES), None
    if options.mpi:
        from mpi4py.futures import MPIPoolExecutor

        executor = MPIPoolExecutor()
    if options.dask:
        from distributed import Client

        client = Client(scheduler_file=options.dask)
        client.wait_for_workers(1, timeout=300)  # seconds; where none start, the sweep would wait for ever
        executor = client.get_executor()
    if options.part:
        first, count = int(os.environ["SLURM_ARRAY_TASK_ID"]), int(os.environ["SLURM_ARRAY_TASK_COUNT"])
        axes["packing.realization"] = axes["packing.realization"][first::count]
    found = gr.sweep(SCENE, axes, measure, executor=executor, checkpoint="kept")
    if not options.part:
        found.to_netcdf("sweep.nc")
        print(found["response_below"].mean("realization").to_series().to_string())


if __name__ == "__main__":
    main()
