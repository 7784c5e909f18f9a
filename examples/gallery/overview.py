"""
The paper at a glance
=====================

A slab under a growing force, with friction 0, 0.2 and 1. The animation shows the incremental contact forces, the
contacts that have opened, and the normalized floor response. Without friction one peak becomes two; the changes of the
normalized response show where it is not linear.
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
# One frame for each load. ``output="growing.gif"`` writes a file; .webp and .html work too.

animation = gr.plot.animate(results, half_width=30.0, fps=4)
