"""
A sweep with an error band
==========================

A sweep solves a scene with every combination of parameter values, on all cores, and returns one labelled dataset. Here
it measures the floor response near the load for slabs with polydispersity 0.1, over several realizations of the radii.
"""

import matplotlib.pyplot as plt

import granular_response as gr

LAYERS, DISKS, REALIZATIONS, WORKERS = 6, 21, 6, 1  # without workers=1: all cores

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


def below_the_load(result: gr.Result) -> float:
    """The response within five radii of the load."""
    response = result.floor_response.isel(load=-1)
    return float(response.values[abs(response["x"].values) < 5.0].sum())


keys = {"contact.friction": [0.1, 0.2, 0.5, 1.0], "packing.realization": range(REALIZATIONS)}
found = gr.sweep(scene, keys, below_the_load, workers=WORKERS, progress=False)
print(found)

# %%
# Means and their standard errors are one line of xarray each.

measured = found["measure"]
mean = measured.mean("realization")
error = measured.std("realization", ddof=1) / REALIZATIONS**0.5

figure, ax = plt.subplots(figsize=(5, 3.2), layout="constrained")
ax.fill_between(found["friction"], mean - error, mean + error, alpha=0.25)
ax.plot(found["friction"], mean, "o-")
ax.set(xlabel="friction", ylabel="response within 5 radii of the load")
