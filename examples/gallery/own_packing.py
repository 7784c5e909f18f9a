"""
A packing of your own
=====================

Arrays of x, z and radius, in any one unit of length, define a packing. Here large and small disks lie at random places
of a loose lattice and settle into a disordered packing.
"""

import numpy as np

import granular_response as gr

ROWS, COLUMNS = 10, 24

radius = np.random.default_rng(7).choice([1.0, 1.3], (ROWS, COLUMNS))
spacing = 2.8
x = spacing * (np.arange(COLUMNS) + 0.5 + 0.5 * (np.arange(ROWS)[:, None] % 2))
z = np.broadcast_to(spacing * (0.5 + 0.5 * np.sqrt(3.0) * np.arange(ROWS))[:, None], x.shape)

# %%
# A disordered packing settles fastest with Verlet's integrator and the largest stable time step.

scene = gr.Scene.from_arrays(
    x.ravel(),
    z.ravel(),
    radius.ravel(),
    width=spacing * (COLUMNS + 0.5),
    scene={
        "contact": {"friction": 0.4},
        "loads": [{"disk": "top-centre", "force": [0.0, -5.0]}],
        "protocol": {"integrator": "verlet", "time_step": "auto", "stop_kinetic_energy": 1e-9},
    },
)
result = gr.solve(scene)
print(result)

# %%
# The initial equilibrium with disks coloured by their radius, and the incremental forces.

gr.plot.packing(result, state=0, values=result.to_dataset()["radius"], label="radius / mean radius")
gr.plot.forces(result)
