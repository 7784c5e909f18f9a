"""
Comparison with an elastic slab
===============================

A small force on a lattice without friction gives nearly the response of an elastic slab. The picture shows how close
fifteen layers come (Sec. II of the paper). The elastic constants are those of the lattice.
"""

import granular_response as gr

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
response = result.floor_response.isel(load=-1)
x = response["x"].values

# %%
# The elastic slab has the lattice's moduli, a smooth floor and smooth side walls.

solid = gr.theory.lattice.moduli(gr.theory.lattice.Springs.uniform(1.0, 0.0), "free")
elastic = gr.theory.slab.response_of_layers(x, layers=LAYERS, moduli=solid, floor="smooth", width=2.0 * DISKS)
print(f"largest difference over largest response: {abs(response.values - elastic).max() / elastic.max():.3f}")

axes = gr.plot.response(result, label="disks")
axes.plot(x, elastic, color="black", linewidth=1.0, linestyle="--", label="elastic slab")
axes.legend()
