"""A state checked from its positions alone: every contact force summed anew, with none of the solver's code.

Each pair of disks and each wall is looked at, whether the solver listed it or not, so a contact that was overlooked
shows as an unbalanced force. The only thing taken from the solver is the history of friction: the tangential
spring of each contact. The loops are dense (n, n) arrays: this is for packings of up to a few hundred disks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granular_response.state import OPEN, FloatArray, State

#: Inward normals of floor, left and right wall.
_NORMALS = np.array([[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0]])


@dataclass(frozen=True)
class ContactRule:
    """Static contact law: stiffnesses in weights per radius, coefficient of friction (0: no tangential force)."""

    normal_stiffness: float
    tangential_stiffness: float
    friction: float


@dataclass(frozen=True)
class Audit:
    """What a state is, by its positions and springs; forces in mean disk weights.

    ``force_residual``, ``torque_residual``: largest on any disk. ``coulomb_excess``: largest ``|f_t| - mu f_n`` of a
    closed contact. ``force_mismatch``: largest difference between a recorded contact force and the one found here.
    ``unlisted``: closed contacts that the state does not list. ``stale_springs``: open contacts that kept a spring.
    ``escaped``: disks with their centre outside of the box.
    """

    force_residual: float
    torque_residual: float
    coulomb_excess: float
    force_mismatch: float
    unlisted: int
    stale_springs: int
    escaped: int


def audit(
    state: State,
    radius: FloatArray,
    mass: FloatArray,
    width: float,
    pair: ContactRule,
    wall: ContactRule,
    load: FloatArray,
) -> Audit:
    """Check a static state.

    Parameters
    ----------
    state : positions, springs, and the recorded forces to compare with.
    radius, mass : (n,).
    width : distance of the side walls.
    pair, wall : laws of the contacts between disks and with walls.
    load : (n, 3) external force and torque on each disk, gravity left out.
    """
    n = len(radius)
    x = state.position
    total = np.array(load, float)
    total[:, 1] -= mass
    excess = [0.0]
    mismatch = [0.0]
    unlisted = 0

    # disks: upper triangle of all pairs
    spring, recorded, listed = _tables(state, n)
    i, j = np.triu_indices(n, 1)
    d = x[i] - x[j]
    distance = np.hypot(d[:, 0], d[:, 1])
    overlap = radius[i] + radius[j] - distance
    touch = overlap > 0
    i, j, d, overlap, distance = i[touch], j[touch], d[touch], overlap[touch], distance[touch]
    normal = d / distance[:, None]
    fn = pair.normal_stiffness * overlap
    ft = -pair.tangential_stiffness * spring[i, j] if pair.friction > 0 else np.zeros(len(i))
    _add(total, i, normal, fn, ft, radius, 1.0)
    _add(total, j, normal, fn, ft, radius, -1.0)
    excess.append(float((np.abs(ft) - pair.friction * fn).max(initial=0.0)))
    known = listed[i, j]
    unlisted += int((~known).sum())
    found = np.stack([fn, ft], axis=1)
    mismatch.append(float(np.abs(found - recorded[i, j])[known].max(initial=0.0)))

    # walls
    wall_spring = np.zeros((n, 3))
    wall_recorded = np.zeros((n, 3, 2))
    wall_listed = np.zeros((n, 3), bool)
    c = state.walls
    wall_spring[c.first, c.second] = c.spring
    wall_recorded[c.first, c.second] = np.stack([c.normal_force, c.tangential_force], axis=1)
    wall_listed[c.first, c.second] = True
    for side, gap in enumerate((x[:, 1], x[:, 0], width - x[:, 0])):
        k = np.flatnonzero(gap < radius)
        fn = wall.normal_stiffness * (radius[k] - gap[k])
        ft = -wall.tangential_stiffness * wall_spring[k, side] if wall.friction > 0 else np.zeros(len(k))
        _add(total, k, np.broadcast_to(_NORMALS[side], (len(k), 2)), fn, ft, radius, 1.0)
        excess.append(float((np.abs(ft) - wall.friction * fn).max(initial=0.0)))
        known = wall_listed[k, side]
        unlisted += int((~known).sum())
        found = np.stack([fn, ft], axis=1)
        mismatch.append(float(np.abs(found - wall_recorded[k, side])[known].max(initial=0.0)))

    stale = sum(int(((c.status == OPEN) & (c.spring != 0)).sum()) for c in (state.pairs, state.walls))
    outside = (x[:, 0] < 0) | (x[:, 0] > width) | (x[:, 1] < 0) | ~np.isfinite(x).all(axis=1)
    turning = pair.friction > 0 or wall.friction > 0
    return Audit(
        force_residual=float(np.abs(total[:, :2]).max()),
        torque_residual=float(np.abs(total[:, 2]).max()) if turning else 0.0,
        coulomb_excess=max(excess),
        force_mismatch=max(mismatch),
        unlisted=unlisted,
        stale_springs=stale,
        escaped=int(outside.sum()),
    )


def _tables(state: State, n: int) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """(n, n) springs, (n, n, 2) recorded forces and (n, n) whether listed, at [smaller index, larger index].

    The tangential spring and force do not change sign when the two disks are exchanged: tangent and slip both turn
    over, and so does the disk the force acts on.
    """
    c = state.pairs
    low, high = np.minimum(c.first, c.second), np.maximum(c.first, c.second)
    spring, recorded, listed = np.zeros((n, n)), np.zeros((n, n, 2)), np.zeros((n, n), bool)
    spring[low, high] = c.spring
    recorded[low, high] = np.stack([c.normal_force, c.tangential_force], axis=1)
    listed[low, high] = True
    return spring, recorded, listed


def _add(total, disk, normal, fn, ft, radius, sign: float) -> None:
    """Add ``sign (f_n n + f_t t)`` and the torque ``-R f_t`` to the disks."""
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    np.add.at(total[:, :2], disk, sign * (fn[:, None] * normal + ft[:, None] * tangent))
    np.add.at(total[:, 2], disk, -radius[disk] * ft)
