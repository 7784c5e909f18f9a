"""
One peak becomes two
====================

Without friction contacts below the load open as it grows. When the region of open contacts is large enough, the single
peak of the response splits (Figs. 3 and 4 of the paper). One initial equilibrium serves all loads.
"""

import matplotlib.pyplot as plt

import granular_response as gr

LAYERS, DISKS, FORCES = 15, 61, [1.0, 3.0, 5.0, 15.0]

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "contact.friction": 0.0,
        "loads.0.force": [0.0, -1.0],
    }
)
result = gr.solve(scene, load_factors=FORCES)
gr.plot.response(result)

# %%
# Contacts of each loaded state compared with the initial equilibrium. Every picture takes ``ax``.

figure, panels = plt.subplots(2, 2, figsize=(9, 4.5), layout="constrained")
for k, ax in enumerate(panels.flat):
    gr.plot.contacts(result, state=k + 1, ax=ax)
    ax.set_title(f"F = {FORCES[k]:g} mg")
