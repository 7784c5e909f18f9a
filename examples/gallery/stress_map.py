"""
A map of stress
===============

The stress is coarse-grained from the contact forces with a Gaussian (Sec. V.C of the paper). ``Result.stress`` gives
the tensor on any grid, ``gr.plot.stress`` draws one component.
"""

import matplotlib.pyplot as plt
import numpy as np

import granular_response as gr

LAYERS, DISKS = 15, 61

scene = gr.Scene().updated({"packing.layers": LAYERS, "packing.disks_per_row": DISKS, "loads.0.force": [0.0, -4.0]})
result = gr.solve(scene)
gr.plot.stress(result)

# %%
# The incremental vertical stress, integrated over any horizontal line, equals the load of 4 mg.

x = np.arange(-80.0, 80.0, 0.25)
z = np.arange(4.0, 1.6 * LAYERS, 2.0)
vertical = result.stress(x, z).sel(force="z", branch="z")
print((vertical.sum("x") * 0.25).values.round(3))

# %%
# The two shear components differ where tangential forces twist the packing.

figure, (upper, lower) = plt.subplots(2, 1, figsize=(7, 4.5), layout="constrained")
gr.plot.stress(result, component="xz", ax=upper)
gr.plot.stress(result, component="zx", ax=lower)
