"""The contact network: what a load changes in it, its orientations and its symmetry (Secs. IV.A, V.B, V.E).

"Near the load" in the paper means the interior: contacts beside a wall carry almost nothing under gravity
and can open first. Masks are over candidate contacts, (m,). Lengths are in mean radii, angles in radians.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import require
from ..state import Contacts, FloatArray, State
from .difference import pair_numbers, require_same
from .floor import interior_mask

#: Normal force (mean disk weights) up to which a contact bears nothing: equilibria balance to 1e-10, and a disk that
#: lies loose may touch another one by that.
ROUNDING = 1e-8
#: Directions of the triangular lattice, as returned by :func:`lattice_direction`.
HORIZONTAL, RISING, FALLING = 0, 1, 2

BoolArray = NDArray[np.bool_]


def opened(rest: Contacts, loaded: Contacts) -> BoolArray:
    """(m,) contacts that touch at rest and not under load (Figs. 4, 8 and 9), of pairs or walls.

    Raises ``ValueError`` if the candidates differ.
    """
    require_same(rest, loaded)
    return rest.touching & ~loaded.touching


def contact_centre(state: State) -> FloatArray:
    """(m, 2) middle between the centres of the two disks of each pair; with periodic sides within one period."""
    if state.box.periodic:
        middle = state.position[state.pairs.second] + 0.5 * state.pair_separation()
        middle[:, 0] %= state.box.width
        return middle
    return 0.5 * (state.position[state.pairs.first] + state.position[state.pairs.second])


def contact_angle(state: State) -> FloatArray:
    """(m,) angle of each pair's line of centres to the horizontal, in [0, pi)."""
    normal = state.pair_normal()
    angle = np.mod(np.arctan2(normal[:, 1], normal[:, 0]), np.pi)
    # A line that falls by less than rounding gives pi itself.
    return np.where(angle >= np.pi, 0.0, angle)


def lattice_direction(state: State) -> NDArray[np.int8]:
    """(m,) nearest direction of the triangular lattice: HORIZONTAL, RISING (60 degrees), FALLING (120)."""
    return (np.rint(contact_angle(state) / (np.pi / 3.0)).astype(np.int8) % 3).astype(np.int8)


def interior_contacts(state: State, width: float, margin: float = 10.0) -> BoolArray:
    """(m,) whether the centre of each pair is at least ``margin`` away from both side walls.

    Raises ``ValueError`` if nothing can be in the interior.
    """
    return interior_mask(contact_centre(state)[:, 0], width, margin)


def bulk_disks(state: State, width: float, side_margin: float = 10.0, vertical_margin: float = 4.0) -> BoolArray:
    """(n,) disks whose centres keep ``side_margin`` from the side walls and ``vertical_margin`` from the
    floor and from the highest centre; by default that leaves out two rows of a lattice below, three above."""
    x, z = state.position[:, 0], state.position[:, 1]
    return (x >= side_margin) & (x <= width - side_margin) & (z >= vertical_margin) & (z <= z.max() - vertical_margin)


def rattlers(state: State) -> BoolArray:
    """(n,) disks with fewer than two contacts of more than ``ROUNDING``, removed again and again.

    Walls count. A disk whose partners are rattlers loses those contacts too. Under gravity two contacts hold a disk
    (Sec. III.C asks for at least two), so rattlers are disks that lie loose.
    """
    pairs, at_wall = state.pairs, state.walls.normal_force > ROUNDING
    loose = np.zeros(len(state.position), dtype=bool)
    while True:
        live = (pairs.normal_force > ROUNDING) & ~loose[pairs.first] & ~loose[pairs.second]
        found = (state.contact_count(live, walls=at_wall) < 2) & ~loose
        if not found.any():
            return loose
        loose |= found


def coordination_number(
    state: State, disks: BoolArray | None = None, *, walls: bool = True, without_rattlers: bool = False
) -> float:
    """Mean number of closed contacts of a disk (Sec. VII), over ``disks`` ((n,) mask; all of them by default).

    Contacts with floor and walls count, once each, unless ``walls`` is False. Contacts with disks outside ``disks``
    count, so a bulk average has no surface in it. ``without_rattlers`` leaves out the disks found by :func:`rattlers`
    together with all contacts they take part in. Raises ``ValueError`` if no disk is left.
    """
    chosen = np.ones(len(state.position), bool) if disks is None else np.asarray(disks, dtype=bool).copy()
    pairs, live = state.pairs, state.pairs.touching
    if without_rattlers:
        loose = rattlers(state)
        chosen &= ~loose
        live = live & ~loose[pairs.first] & ~loose[pairs.second]
    require(chosen.any(), "disks: none left to average over")
    return float(state.contact_count(live, walls=walls)[chosen].mean())


def fabric_tensor(state: State) -> FloatArray:
    """(2, 2) mean of n n over the closed contacts between disks, n their unit normals; nan without any."""
    normal = state.pair_normal()[state.pairs.touching]
    return normal.T @ normal / len(normal) if len(normal) else np.full((2, 2), np.nan)


def contact_angle_histogram(state: State, bins: int) -> tuple[FloatArray, FloatArray]:
    """Distribution of the angles of the touching pairs: bin centres (b,) from 0 and density (b,) per radian.

    The density integrates to 1 over pi. The first bin is centred on the horizontal, so contacts that are horizontal up
    to rounding are not split; with ``bins`` a multiple of 3 so are the oblique lattice directions. An empty network
    gives zeros. Raises ``ValueError`` for fewer than one bin.
    """
    require(bins >= 1, f"bins: {bins} given; it must be at least 1")
    spacing = np.pi / bins
    # Cells are half-open in the shifted angle; the modulo folds angles just below pi onto the first.
    cell = np.floor(contact_angle(state)[state.pairs.touching] / spacing + 0.5).astype(np.int64) % bins
    density = np.bincount(cell, minlength=bins).astype(np.float64)
    if cell.size:
        density /= cell.size * spacing
    return spacing * np.arange(bins, dtype=np.float64), density


def mirror_disks(position: FloatArray, axis: float, tolerance: float = 0.1) -> NDArray[np.intp]:
    """(n,) index of the mirror image of each disk in the vertical line ``x = axis``.

    ``position`` is (n, 2), best that of the undeformed packing. Raises ``ValueError`` if a disk has no
    image within ``tolerance``, or shares it.
    """
    from scipy.spatial import cKDTree  # importing takes a twentieth of a second at the start of every process

    image = position * np.array([-1.0, 1.0]) + np.array([2.0 * axis, 0.0])
    distance, index = cKDTree(position).query(image)
    worst = int(np.argmax(distance))
    if distance[worst] > tolerance:
        raise ValueError(
            f"position: disk {worst} has no mirror image within {tolerance} (nearest at {distance[worst]:.3g}); "
            f"the packing, taken without its periodic sides, is not symmetric about x = {axis}"
        )
    rule = f"position: two disks share a mirror image about x = {axis}; tolerance {tolerance} too large"
    require(np.array_equal(index[index], np.arange(index.size)), rule)
    return index.astype(np.intp)


def network_asymmetry(contacts: Contacts, mirror: NDArray[np.intp]) -> float:
    """Fraction of the touching pairs whose mirror image does not touch: 0 symmetric, 1 nothing in common (Sec. V.E).

    ``mirror`` comes from :func:`mirror_disks`. An image that is no candidate counts as open. 0 without contacts.
    """
    first, second = contacts.first[contacts.touching], contacts.second[contacts.touching]
    images = pair_numbers(mirror[first], mirror[second], mirror.size)
    unmatched = ~np.isin(images, pair_numbers(first, second, mirror.size))
    return float(np.count_nonzero(unmatched) / len(first)) if len(first) else 0.0
