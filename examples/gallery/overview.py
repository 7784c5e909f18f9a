"""
The paper at a glance
=====================

A slab under a growing force, without and with friction: what the force adds at the contacts, the contacts that it
opens, and what the floor feels, all per applied force. What moves is not linear in the force: without friction one
peak becomes two.
"""

import granular_response as gr

LAYERS, DISKS, FORCES = 15, 61, [0.5, 1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 33, 41, 50]

results = {}
for friction in (0.0, 0.2, 1.0):
    scene = gr.Scene().updated(
        {
            "packing.layers": LAYERS,
            "packing.disks_per_row": DISKS,
            "contact.friction": friction,
            "loads.0.force": [0.0, -1.0],
        }
    )
    results[f"friction {friction:g}"] = gr.solve(scene, load_factors=FORCES)

# %%
# A frame for each load. ``output="growing.gif"`` writes a file, .webp and .html too.

animation = gr.plot.animate(results, half_width=30.0, fps=4)
