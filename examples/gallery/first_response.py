"""
A first response
================

The paper's slab: 15 rows of 61 and 60 disks with friction 0.2 fall onto a floor, and the middle disk of the top row is
pushed down with fifteen times the weight of a disk. What does the floor feel?
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
# Each state says what is left unbalanced in it and whether it is stable. The response is a labelled array: what the
# load adds to the force on each floor disk, per applied force. Over the floor it sums to one.

print(float(result.floor_response.sum()))
gr.plot.response(result)

# %%
# Everything on one page: the response, the forces that the load adds, the contacts that open and slide, the stress.

gr.plot.page(result)
