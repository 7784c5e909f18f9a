"""
Loading and unloading
=====================

With friction a packing does not return along its loading path. At half the load the response below the load is smaller
after the full load than before it, because contacts have slid.
"""

import matplotlib.pyplot as plt

import granular_response as gr

LAYERS, DISKS, FORCE = 9, 31, 8.0
STEPS = [0.25, 0.5, 0.75, 1.0, 0.75, 0.5, 0.25, 0.0, 0.25, 0.5, 0.75, 1.0]

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "loads.0.force": [0.0, -FORCE],
        "protocol.load_factors": STEPS,
    }
)
result = gr.solve(scene)
print(result)

# %%
# The incremental floor force below the load, along the load programme.

data = result.to_dataset()
centre = abs(data["x"].values).argmin()
added = data["floor_force_change"].isel(floor_disk=centre).values

figure, ax = plt.subplots(figsize=(5, 3.4), layout="constrained")
force = FORCE * data["load_factor"].values
turn, back = 4, 8
ax.plot([0.0, *force[:turn]], [0.0, *added[:turn]], "o-", label="loading")
ax.plot(force[turn - 1 : back], added[turn - 1 : back], "s--", label="unloading")
ax.plot(force[back - 1 :], added[back - 1 :], "^:", label="loading again")
ax.set(xlabel="F / mg", ylabel="incremental floor force at x = 0 / mg")
ax.legend()

# %%
# These contacts still slide or are open after unloading.

gr.plot.contacts(result, state=back)
