"""
A disordered packing
====================

Disks of two sizes poured into a box, one after the other, each rolling down to the first hollow; then gravity acts on
all of them, and one is pushed.
"""

import granular_response as gr

DISKS, WIDTH = 150, 26.0

scene = gr.Scene(
    packing=gr.Poured(disks=DISKS, width=WIDTH, sizes=[1.0, 1.4], polydispersity=0.1),
    contact=gr.Contact(friction=0.4),
    wall=gr.Wall(friction=0.4),
    loads=[gr.Load(disk="top-centre", force=(0.0, -2.0))],
)
result = gr.solve(scene)
print(result)

# %%
# The packing under gravity, its disks coloured by their size, and the forces that the load adds.

gr.plot.packing(result, state=0, values=result.to_dataset()["radius"], label="radius over mean radius")
gr.plot.forces(result)
