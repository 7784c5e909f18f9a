"""
A first response
================

The paper's slab has 15 rows of 61 and 60 disks with friction 0.2. It settles on the floor, and then 15 mg push the
middle disk of the top row down. How does this force arrive at the floor?
"""

import granular_response as gr

LAYERS, DISKS, FORCE = 15, 61, 15.0

scene = gr.Scene.from_dict(
    {
        "packing": {"kind": "slab", "layers": LAYERS, "disks_per_row": DISKS},
        "contact": {"friction": 0.2},
        "loads": [{"disk": "top-centre", "force": [0.0, -FORCE]}],
    }
)
result = gr.solve(scene)
print(result)

# %%
# Each state reports its residual and whether it is stable. The response is a labelled array: the incremental vertical
# force on each floor disk over the applied force. Its sum over the floor is one.

print(float(result.floor_response.sum()))
gr.plot.response(result)

# %%
# One page shows the response, the incremental forces, the contacts that open and slide, and the stress.

gr.plot.page(result)
