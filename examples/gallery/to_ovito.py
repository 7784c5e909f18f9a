"""
Pictures in OVITO
=================

Results are exported for OVITO and ParaView. This example shows what the file contains: one frame for each state, and
for each disk radius, angle, coordination number and incremental net contact force.
"""

import tempfile
from pathlib import Path

import numpy as np

import granular_response as gr

LAYERS, DISKS = 10, 31

folder = Path(tempfile.mkdtemp())
scene = gr.Scene().updated(
    {"packing.layers": LAYERS, "packing.disks_per_row": DISKS, "contact.friction": 1.0, "loads.0.force": [5.0, -10.0]}
)
result = gr.solve(scene)
path = result.export(folder / "result.xyz")  # or .gsd, which keeps the contacts as bonds

# %%
# The command line does the same: ``granular-response export result.nc -o result.xyz``. The last frame begins with:

lines = path.read_text().splitlines()
count = int(lines[0])
frame = lines[-count - 1 :]
print(frame[0])
print(frame[1])

# %%
# In OVITO, colour the disks by the magnitude of ``force_change``. This picture is made from the same numbers.

columns = np.array([line.split()[1:] for line in frame[1:]], float)
position, change = columns[:, :3], np.linalg.norm(columns[:, 6:9], axis=1)
gr.plot.packing(result, values=change, label="incremental net contact force / mg")
