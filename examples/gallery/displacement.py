"""
Force against displacement
==========================

A disk that is moved, not pushed, as in experiments with a localized displacement: the middle disk of the bottom row is
raised, let down again, and raised once more. The force that this takes is the answer. It is another one on the way
back, because contacts that slid or opened do not return.
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
# The reaction is the force on the disk, in mg, that holds it where it is.

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
ax.set(xlabel="height above rest, in hundredths of a mean radius", ylabel="force, in mg")
ax.legend()

# %%
# How far the disks of each row have been raised with it: the response to a displacement. Rows from the third on.

data = result.to_dataset()
raised = (data["position"].isel(state=top) - data["position"].isel(state=0)).sel(axis="z").values / RAISED
x = data["position"].isel(state=0).sel(axis="x").values - 0.5 * data.attrs["width"]

figure, ax = plt.subplots(figsize=(5, 3.2), layout="constrained")
for row in range(2, LAYERS, 2):
    here = data["row"].values == row
    ax.plot(x[here], raised[here], ".-", label=f"row {row + 1}")
ax.set(xlabel="place from the raised disk", ylabel="raised, over the disk's own height")
ax.legend()
