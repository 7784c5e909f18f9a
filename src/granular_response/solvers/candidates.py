"""Which contacts can exist while no disk moves far: the list that kernels go through."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..contact import Law
from ..kernels import neighbours
from ..machine.lanes import WIDTH, aligned, aligned_zeros
from ..scene import Packing
from ..state import FloatArray
from .close_pairs import close_pairs

#: Largest gap of a listed candidate pair (mean radii). Half of it is how far disks may move before the list
#: is made again.
SKIN = 0.6
#: With less room than this left on the lattice, neighbours are searched instead.
LEAST_LATTICE_LIMIT = 0.25


@dataclass(frozen=True, repr=False)
class Candidates:
    """Contacts that can exist while no disk is farther than ``limit`` from ``reference``.

    Slots are the storage places of the runs (see ``kernels.forces``); ``slot`` maps each listed pair to its own.
    """

    reference: FloatArray  #: (n, 2) positions that displacements are measured from
    first: NDArray[np.int32]  #: (m,) listed pairs, first < second
    second: NDArray[np.int32]
    slot: NDArray[np.int64]  #: (m,)
    runs: NDArray[np.int64]  #: (r, 4)
    separation: FloatArray  #: (2, slots) reference separations of the slots' disks
    reach: FloatArray  #: (slots,) sums of radii; 0 in slots of no listed pair
    wall_disk: NDArray[np.int64]  #: (w,)
    wall: NDArray[np.int8]  #: (w,)
    wall_gap: FloatArray  #: (w,) reference gaps
    shape: FloatArray | None  #: (slots,) what the law needs of the radii; None for a law that needs nothing
    wall_shape: FloatArray | None  #: (w,)
    limit: float

    def in_slots(self, values: FloatArray) -> FloatArray:
        """(slots,) what listed pairs have (m,), and 0 in other slots."""
        return _in_slots(values, self.slot, len(self.reach))


def _in_slots(values: FloatArray, slot: NDArray[np.int64], slots: int) -> FloatArray:
    room = aligned_zeros(slots)
    room[slot] = values
    return room


def list_candidates(packing: Packing, laws: tuple[Law, Law], position: FloatArray, stride: float = 0.0) -> Candidates:
    """List candidate contacts of a packing at ``position`` (n, 2); ``laws`` are those between disks and at walls.

    As long as every disk is near its lattice site, the neighbours on the lattice are the only ones that can
    touch, and nothing is searched. The list holds for displacements of at least ``stride``.
    """
    radius, law, wall_law = packing.radius, *laws
    pairs = packing.neighbour_pairs()
    limit = 0.0
    if pairs is not None and packing.lattice_constant is not None:
        # second neighbours touch once two disks have moved this far towards each other
        room = np.sqrt(3.0) * packing.lattice_constant - 2.0 * float(radius.max())
        shift = np.linalg.norm(position - packing.position, axis=1)
        limit = 0.5 * room - float(shift.max())
    if pairs is not None and limit > max(LEAST_LATTICE_LIMIT, stride):
        first, second = pairs[:, 0], pairs[:, 1]
        margin = 2.0 * limit
    else:
        margin = max(SKIN, 2.0 * stride)
        first, second = close_pairs(position, radius, margin, packing.box.period)
        limit = 0.5 * margin
    runs, slot = neighbours.make_runs(first, second, packing.n, multiple=WIDTH)
    i, j = neighbours.run_pairs(runs)
    shapes = law.shapes(radius[first], radius[second])
    wall_disk, wall = packing.box.near_walls(position, radius, margin)
    return Candidates(
        reference=position.copy(),
        first=first.astype(np.int32),
        second=second.astype(np.int32),
        slot=slot,
        runs=runs,
        separation=aligned(packing.box.separation(position[i], position[j]).T),
        reach=_in_slots(radius[first] + radius[second], slot, len(i)),
        wall_disk=wall_disk,
        wall=wall,
        wall_gap=packing.box.wall_gap(position[wall_disk], radius[wall_disk], wall),
        shape=None if shapes is None else _in_slots(shapes, slot, len(i)),
        wall_shape=wall_law.shapes(radius[wall_disk], None),
        limit=limit,
    )
