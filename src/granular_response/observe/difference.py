"""What the load adds: differences of a rest and a loaded state, contact by contact.

Along a load path the candidate contacts keep their order, so a difference is an array subtraction. Where a
packing has rearranged, :func:`match_candidates` first gives both states one common list of candidates.
Forces are in mean disk weights, lengths in mean radii.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import require
from ..state import Contacts, FloatArray, State


def require_same(rest: Contacts, loaded: Contacts, kind: str = "contacts") -> None:
    """Raise ``ValueError`` unless both list the same candidate contacts in the same order."""
    if not rest.same_candidates(loaded):
        raise ValueError(
            f"{kind}: the two states list different candidate contacts ({rest.first.size} and {loaded.first.size}); "
            "bring them to one list with match_candidates"
        )


def pair_force_difference(rest: State, loaded: State) -> FloatArray:
    """(m, 2) force on ``pairs.first`` that the load adds; gravity subtracted as a vector (Sec. III.C)."""
    require_same(rest.pairs, loaded.pairs, "pairs")
    return loaded.pair_force() - rest.pair_force()


def wall_force_difference(rest: State, loaded: State) -> FloatArray:
    """(w, 2) force on ``walls.first`` that the load adds; gravity subtracted as a vector (Sec. III.C)."""
    require_same(rest.walls, loaded.walls, "walls")
    return loaded.wall_force() - rest.wall_force()


def force_misalignment(rest: State, loaded: State) -> float:
    """Mean angle (radians, 0 to pi/2) between the added force and the contact line, weighted with |force|.

    Zero means that the force chains follow the contact directions, as they must without friction up to the
    rotation of the contacts themselves (Sec. V.D, Fig. 13). NaN if the load changes no force.
    """
    force = pair_force_difference(rest, loaded)
    normal = loaded.pair_normal()
    along = np.abs(np.sum(force * normal, axis=1))
    across = np.abs(normal[:, 0] * force[:, 1] - normal[:, 1] * force[:, 0])
    magnitude = np.hypot(along, across)
    total = float(magnitude.sum())
    return float(np.sum(np.arctan2(across, along) * magnitude) / total) if total > 0.0 else float("nan")


def match_candidates(rest: State, loaded: State, radius: FloatArray) -> tuple[State, State]:
    """The same two states on one common candidate list (the union, ordered by disk and partner).

    A contact that one state does not list is OPEN there: no force, no spring, and the overlap that its
    geometry gives. ``radius`` is (n,). A pair keeps its forces when
    it is listed in the other direction, since normal and tangent change sign together. Raises ``ValueError``
    if a state lists a contact twice or the states hold different numbers of disks.
    """
    n = rest.position.shape[0]
    if loaded.position.shape[0] != n or radius.shape != (n,):
        raise ValueError(f"radius: {radius.shape} for states of {n} and {loaded.position.shape[0]} disks")

    pair_keys = [pair_numbers(s.pairs.first, s.pairs.second, n) for s in (rest, loaded)]
    wall_keys = [s.walls.first.astype(np.int64) * 3 + s.walls.second for s in (rest, loaded)]
    i, j = np.divmod(pair_union := np.union1d(*pair_keys), n)
    k, wall = np.divmod(wall_union := np.union1d(*wall_keys), 3)
    matched = []
    for state, pair_key, wall_key in zip((rest, loaded), pair_keys, wall_keys, strict=True):
        distance = np.linalg.norm(state.box.separation(state.position[i], state.position[j]), axis=1)
        gap = state.box.wall_gap(state.position[k], radius[k], wall)
        # the couple on the first disk is the opposite of that on the second
        turned = np.where(state.pairs.first > state.pairs.second, -1.0, 1.0)
        pairs = _spread("pairs", state.pairs, pair_key, pair_union, i, j, radius[i] + radius[j] - distance, turned)
        walls = _spread("walls", state.walls, wall_key, wall_union, k, wall, -gap)
        matched.append(replace(state, pairs=pairs, walls=walls))
    return matched[0], matched[1]


def pair_numbers(first: NDArray, second: NDArray, n: int) -> NDArray[np.int64]:
    """(m,) a number for each pair of ``n`` disks, the same in both directions."""
    return np.minimum(first, second).astype(np.int64) * n + np.maximum(first, second)


def _spread(
    kind: str,
    contacts: Contacts,
    key: NDArray[np.int64],
    union: NDArray[np.int64],
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    overlap: FloatArray,
    turned: FloatArray | float = 1.0,
) -> Contacts:
    at = np.searchsorted(union, key)
    require(np.unique(at).size == at.size, f"{kind}: a contact is listed twice")

    def spread(values: NDArray) -> NDArray:
        """In the common list, zero and OPEN where there is none."""
        wide = np.zeros((*values.shape[:-1], union.size), values.dtype)
        wide[..., at] = values
        return wide

    overlap[at] = contacts.overlap
    forces, springs = contacts.forces, contacts.springs
    forces[1:] *= turned
    springs[1:] *= turned
    rows = (spread(one) for one in (forces, springs, contacts.statuses))
    return Contacts.of(first, second, overlap, spread(contacts.normal_force), *rows)
