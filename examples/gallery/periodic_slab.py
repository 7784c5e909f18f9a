"""
A slab without side walls
=========================

Periodic sides replace the walls, which could carry part of the load. All disks of the top row are then equivalent: a
load on another disk moves the response and does not change it.
"""

import numpy as np

import granular_response as gr

LAYERS, DISKS = 10, 40

scene = gr.Scene.from_dict(
    {
        "packing": {"kind": "slab", "layers": LAYERS, "disks_per_row": DISKS, "sides": "periodic"},
        "contact": {"friction": 0.2},
        "loads": [{"disk": {"row": "top"}, "force": [0.0, -4.0]}],
    }
)
result = gr.solve(scene)
shifted = gr.solve(scene.updated({"loads.0.disk": {"row": "top", "offset": DISKS // 2 - 1}}))

# %%
# The response to a load on a disk near the end of the row, whose contacts reach across the sides, has the same values.

ordered = [np.sort(one.floor_response.values) for one in (result, shifted)]
print("largest difference:", abs(ordered[0] - ordered[1]).max())
gr.plot.response(result)

# %%
# Pictures cut a contact across the sides into two halves; dashed sides are periodic.

gr.plot.contacts(shifted)
gr.plot.forces(shifted)
