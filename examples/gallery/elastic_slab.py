"""
Beside an elastic slab
======================

A small force on a lattice without friction is answered as by an elastic slab, in the end: this is how near fifteen
layers come (Sec. II of the paper). The elastic constants are those of the lattice.
"""

import granular_response as gr
from granular_response.theory import lattice, slab

LAYERS, DISKS = 15, 61

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "contact.friction": 0.0,
        "loads.0.force": [0.0, -0.1],
    }
)
result = gr.solve(scene)
x, response = result.floor_response["x"].values, result.floor_response.values

# %%
# The elastic slab has the lattice's moduli, a smooth floor and smooth side walls.

solid = lattice.moduli(lattice.Springs.uniform(1.0, 0.0), "free")
elastic = slab.response_of_layers(x, layers=LAYERS, moduli=solid, floor="smooth", width=2.0 * DISKS)
print(f"largest difference over largest response: {abs(response - elastic).max() / elastic.max():.3f}")

axes = gr.plot.response(result, label="disks")
axes.plot(x, elastic, color="black", linewidth=1.0, linestyle="--", label="elastic slab")
axes.legend()
