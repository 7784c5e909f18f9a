"""
A disordered packing
====================

Disks of two sizes are poured into a box one after the other, and each rolls down to the first hollow. Then gravity acts
on all of them, and a force on one.
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
# The initial equilibrium with disks coloured by their radius, and the incremental forces.

gr.plot.packing(result, state=0, values=result.to_dataset()["radius"], label="radius / mean radius")
gr.plot.forces(result)
