"""
Force against displacement
==========================

A disk is displaced in place of being pushed, as in some experiments. The middle disk of the bottom row is raised,
lowered, and raised once more. The force that this takes differs on the way back, because contacts that slid or opened
do not return.
"""

import matplotlib.pyplot as plt
import numpy as np

import granular_response as gr

LAYERS, DISKS, RAISED = 9, 31, 0.02
UP = np.linspace(0.1, 1.0, 10)
STEPS = [*UP, *UP[-2::-1], 0.0, *UP]

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "contact.friction": 0.3,
        "loads": [{"disk": {"row": "bottom"}, "displacement": [0.0, RAISED]}],
        "protocol.load_factors": [round(float(step), 3) for step in STEPS],
    }
)
result = gr.solve(scene)
print(result)

# %%
# The reaction is the force, in mg, that holds the disk at its prescribed displacement.

force = np.concatenate([[0.0], result.reaction.sel(axis="z").squeeze("load_point").values])
height = 100.0 * RAISED * np.concatenate([[0.0], result.load_factors])

figure, ax = plt.subplots(figsize=(5, 3.4), layout="constrained")
top, back = len(UP), 2 * len(UP)
for part, look, label in (
    (slice(0, top + 1), "o-", "up"),
    (slice(top, back + 1), "s--", "down"),
    (slice(back, None), "^:", "up again"),
):
    ax.plot(height[part], force[part], look, markersize=3, label=label)
ax.set(xlabel="displacement / (0.01 R)", ylabel="reaction / mg")
ax.legend()

# %%
# The vertical displacement of the disks of each row, from the third row on: the response to a displacement.

data = result.to_dataset()
raised = (data["position"].isel(state=top) - data["position"].isel(state=0)).sel(axis="z").values / RAISED
x = data["position"].isel(state=0).sel(axis="x").values - 0.5 * data.attrs["width"]

figure, ax = plt.subplots(figsize=(5, 3.2), layout="constrained")
for row in range(2, LAYERS, 2):
    here = data["row"].values == row
    ax.plot(x[here], raised[here], ".-", label=f"row {row + 1}")
ax.set(xlabel="x / R", ylabel="displacement / that of the raised disk")
ax.legend()
