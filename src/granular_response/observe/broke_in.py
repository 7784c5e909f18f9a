"""Whether a load broke in: equilibria that were lost on its way, and how far disks have moved.

A state may be stable after its load has pushed the loaded disk down by rows. One line says so, the same on the terminal
and in ``print(result)``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..state import MOVED_FAR, State

#: Displacement (mean radii) from which on a disk has left its place: the elastic displacements of the paper's loads are
#: below a hundredth, and disks of a lattice exchange neighbours from some tenths on.
REMARKABLE = 0.1


def broke_in(states: Sequence[State], loaded_disks: NDArray[np.integer]) -> tuple[str, str] | None:
    """What the loads of ``states`` did that no elastic response does, a title and one line; None for nothing of it.

    Dynamic jumps (equilibria from which motion led to the next), equilibria that were lost with the next one nearby,
    and the largest displacements from the first state, of a loaded disk and of any. Minima of the energy that are far
    from the one before may have been reached without a jump. ``loaded_disks`` (l,) : disks with loads.
    """
    events = [event for state in states for event in state.reached.events if event.lost]
    far_off = [event for event in events if event.reason.startswith(MOVED_FAR)]
    jumps = [event for event in events if event.kind != "stepped over" and event not in far_off]
    far = np.stack([np.hypot(*(state.position - states[0].position).T) for state in states])
    if not jumps and not far.max() > REMARKABLE:
        return None
    said = []
    if jumps:
        said.append(f"{_count(len(jumps), 'dynamic jump')}, the first at load factor {jumps[0].load_factor:.4g}")
        if near := len(events) - len(jumps) - len(far_off):
            said.append(f"{_count(near, 'lost equilibrium', 'lost equilibria')} with the next one nearby")
    if far_off:
        between = f"between load factors {far_off[0].load_factor:.4g} and {far_off[0].until:.4g}"
        said.append(f"{_count(len(far_off), 'minimum', 'minima')} far from the one before, the first {between}")
    if where := [(float(far[:, disk].max()), int(disk)) for disk in np.unique(loaded_disks)]:
        how_far, disk = max(where)
        said.append(f"loaded disk {disk} moved by {how_far:.2g}")
    disk = int(far.argmax()) % far.shape[1]
    said.append(f"disk {disk} farthest, by {far.max():.2g} mean radii")
    return "the load broke in" if jumps else "largest displacements", ", ".join(said)


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"
