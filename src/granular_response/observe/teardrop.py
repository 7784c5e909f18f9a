"""The teardrop: the connected region of contacts that the load opens below itself (Secs. IV.A and IV.B).

Two open contacts are adjacent if their centres are within :data:`REACH` lattice constants of each other. The region is
the connected component nearest to the loaded disk, if it begins within :data:`START` lattice constants of it: contacts
that the load opens far away, where the side walls have thinned the forces, are no teardrop. All lengths are measured in
the rest state, in mean radii.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..state import FLOOR, Box, FloatArray, State
from .network import contact_centre

BoolArray = NDArray[np.bool_]

#: Lattice constants. On the triangular lattice horizontal contacts of one row and of neighbouring rows are one apart,
#: the next nearest 1.7: neighbours are joined and nothing is bridged.
REACH, START = 1.2, 5.0


@dataclass(frozen=True)
class OpenRegion:
    """A connected region of open contacts."""

    contacts: BoolArray  #: (m,) pairs of the region
    depth: float  #: from the origin (the loaded disk) down to the centre of the lowest contact; 0 if empty
    width: float  #: largest extent of one row, from disk centre to disk centre; 0 if empty
    reaches_floor: bool  #: whether a contact between two floor disks belongs to it

    @property
    def count(self) -> int:
        return int(np.count_nonzero(self.contacts))


def open_region(
    state: State,
    opened: BoolArray,
    origin: FloatArray,
    *,
    start: BoolArray | None = None,
    lattice_constant: float = 2.0,
) -> OpenRegion:
    """Connected region of the ``opened`` pairs ((m,) mask) that begins nearest to ``origin`` ((2,)), Fig. 5.

    ``state`` gives the geometry. ``start`` (a mask over pairs, such as ``interior_contacts``) can narrow where the
    region may begin. Contacts that are equally near to the origin (within a hundredth of a lattice constant) all begin
    the region, so a symmetric network has a symmetric region. The width of a row takes in all contacts whose centres
    differ in height by less than a quarter of the row spacing. The region reaches the floor with a contact of which
    both disks touch the floor in ``state``: on the lattice, a horizontal one of the bottom row.
    """
    centre = contact_centre(state)
    if state.box.periodic:  # the shortest way from the origin
        centre = origin + state.box.separation(centre, origin)
    inside = connected(centre, opened, origin, state.box, start=start, lattice_constant=lattice_constant)
    region = np.flatnonzero(inside)
    if region.size == 0:
        return OpenRegion(contacts=inside, depth=0.0, width=0.0, reaches_floor=False)

    on_floor = np.zeros(state.position.shape[0], dtype=bool)
    on_floor[state.walls.first[(state.walls.second == FLOOR) & state.walls.touching]] = True
    first, second = state.pairs.first[region], state.pairs.second[region]
    ends = state.position[first], state.position[second]
    if state.box.periodic:
        half = 0.5 * state.pair_separation()[region]
        ends = centre[region] + half, centre[region] - half
    return OpenRegion(
        contacts=inside,
        depth=float(origin[1] - centre[region, 1].min()),
        width=_largest_row(*ends, np.sqrt(3.0) / 8.0 * lattice_constant),
        reaches_floor=bool(np.any(on_floor[first] & on_floor[second])),
    )


def connected(
    centre: FloatArray,
    opened: BoolArray,
    origin: FloatArray,
    box: Box,
    *,
    start: BoolArray | None = None,
    lattice_constant: float = 2.0,
) -> BoolArray:
    """Which of the ``opened`` contacts (m,) with ``centre`` (m, 2) belong to the region; see :func:`open_region`."""
    inside = np.zeros(opened.shape, dtype=bool)
    candidate = np.flatnonzero(opened)
    may_begin = opened & (np.linalg.norm(centre - origin, axis=1) <= START * lattice_constant)
    begin = np.flatnonzero(may_begin if start is None else may_begin & start)
    if begin.size == 0:
        return inside
    label = _components(centre[candidate], REACH * lattice_constant, box)
    distance = np.linalg.norm(centre[begin] - origin, axis=1)
    nearest = begin[distance <= distance.min() + 0.01 * lattice_constant]
    begun = np.zeros(label.max() + 1, bool)
    begun[label[np.searchsorted(candidate, nearest)]] = True
    inside[candidate[begun[label]]] = True
    return inside


def _components(points: FloatArray, reach: float, box: Box) -> NDArray[np.int32]:
    from scipy.spatial import cKDTree  # importing takes a twentieth of a second at the start of every process

    if box.periodic:
        tree = cKDTree(np.stack([points[:, 0] % box.width, points[:, 1]], axis=1), boxsize=(box.width, 0.0))
    else:
        tree = cKDTree(points)
    edges = tree.query_pairs(reach, output_type="ndarray")
    size = points.shape[0]
    graph = coo_array((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(size, size))
    return connected_components(graph, directed=False)[1]


def _largest_row(first: FloatArray, second: FloatArray, window: float) -> float:
    """Largest extent in x of segments ``first``-``second`` with middles less than ``window`` apart in z."""
    height = 0.5 * (first[:, 1] + second[:, 1])
    order = np.argsort(height)
    height = height[order]
    left = np.minimum(first[order, 0], second[order, 0])
    right = np.maximum(first[order, 0], second[order, 0])
    low = np.searchsorted(height, height - window, side="right")
    high = np.searchsorted(height, height + window, side="left")
    return float(max(right[a:b].max() - left[a:b].min() for a, b in zip(low, high, strict=True)))
