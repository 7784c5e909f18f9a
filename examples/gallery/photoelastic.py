"""
Photoelastic disks
==================

Experiments see the forces in a packing by disks that turn the plane of polarised light where they are strained. The
stress in a disk follows from its contact forces in closed form, so any state can be looked at in this way: here a slab
under 150 mg, as much as in such experiments (Sec. II.B of the paper).
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
# The same with the forces of the initial equilibrium, more sensitive: ``fringe`` is the difference of the principal
# stresses from one fringe to the next, in mg per radius.

gr.plot.photoelastic(result, state=0, half_width=20.0, fringe=20.0)
