"""
Photoelastic disks
==================

Experiments make forces visible with disks that rotate the plane of polarised light where they are strained. The stress
in a disk follows from its contact forces in closed form, so that every state can be shown in this way. Here a slab
carries 150 mg, as in such experiments (Sec. II.B of the paper).
"""

import granular_response as gr

LAYERS, DISKS, FORCE = 15, 61, 150.0

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "contact.friction": 0.94,
        "wall.friction": 0.94,
        "loads.0.force": [0.0, -FORCE],
    }
)
result = gr.solve(scene)
gr.plot.photoelastic(result, half_width=20.0)

# %%
# The initial equilibrium, with higher sensitivity: ``fringe`` is the difference of the principal stresses from one
# fringe to the next, in mg/R.

gr.plot.photoelastic(result, state=0, half_width=20.0, fringe=20.0)
