"""
An ensemble on Dask
===================

Realizations of a disordered packing are solved on a Dask cluster. The picture shows the mean floor response with its
standard error. The cluster is started here, on this machine; ``Client(address).get_executor()`` is that of another one.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from distributed import LocalCluster

import granular_response as gr

LAYERS, DISKS, REALIZATIONS, WORKERS = 6, 21, 12, 2

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "packing.polydispersity": 0.1,
        "packing.lattice_constant": "touching-largest",
        "loads.0.force": [0.0, -2.0],
        "protocol": {"integrator": "verlet", "time_step": "auto", "stop_kinetic_energy": 1e-9},
    }
)
places = np.arange(-12.0, 12.5, 0.5)


def smoothed(result: gr.Result) -> xr.DataArray:
    """The response smoothed over two radii, since floor disks are at other places in each realization."""
    return result.response_at(places, smooth=2.0).isel(load=-1).rename("response")


if __name__ == "__main__":  # the processes of the cluster read this file, too
    with LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        keys = {"packing.realization": range(REALIZATIONS)}
        found = gr.sweep(scene, keys, smoothed, executor=cluster.get_client().get_executor(), progress=False)
    response = found["response"]
    mean = response.mean("realization")
    error = response.std("realization", ddof=1) / REALIZATIONS**0.5

    figure, ax = plt.subplots(figsize=(5, 3.2), layout="constrained")
    ax.plot(places, response.values.T, color="0.85", linewidth=0.6)
    ax.fill_between(places, mean - error, mean + error, alpha=0.3)
    ax.plot(places, mean)
    ax.set(xlabel="x / R", ylabel="smoothed floor response")
