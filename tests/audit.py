"""A state checked from its positions alone: every contact force summed anew, with none of the solver's code.

Each pair of disks and each wall is looked at, whether the solver listed it or not, so a contact that was overlooked
shows as an unbalanced force. The only thing taken from the solver is the history of friction: the springs of each
contact along the tangent and along the rolling. The loops are dense (n, n) arrays: this is for packings of up to a few
hundred disks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granular_response.state import OPEN, Contacts, FloatArray, State

#: Inward normals of floor, left and right wall.
_NORMALS = np.array([[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0]])
#: Force, as a part of what a disk bears, that moves one which nothing holds.
FALLS = 1e-6


@dataclass(frozen=True)
class ContactRule:
    """Static contact law: stiffnesses in weights per radius, coefficient of friction (0: no tangential force).

    ``power`` 3/2 is the law of Hertz, ``normal_stiffness`` then the one at a force of one mean disk weight between
    bodies of the reduced radius ``reference``. Without ``rolling_friction`` nothing resists rolling.
    """

    normal_stiffness: float
    tangential_stiffness: float
    friction: float
    power: float = 1.0
    reference: float = 1.0
    rolling_stiffness: float = 0.0
    rolling_friction: float = 0.0

    def normal_force(self, overlap: FloatArray, reduced_radius: FloatArray) -> FloatArray:
        """Forces at ``overlap`` > 0, of any shape.

        From f = A xi^(3/2) and df/dxi = k at f = 1 follows A = (2 k / 3)^(3/2).
        """
        if self.power == 1.0:
            return self.normal_stiffness * overlap
        factor = (self.normal_stiffness / self.power) ** self.power
        return factor * np.sqrt(reduced_radius / self.reference) * overlap**self.power

    def spring_forces(self, springs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tangential and rolling forces (m,) of springs (m, 2)."""
        tangential = self.tangential_stiffness if self.friction > 0 else 0.0
        rolling = self.rolling_stiffness if self.rolling_friction > 0 else 0.0
        return -tangential * springs[:, 0], -rolling * springs[:, 1]


@dataclass(frozen=True)
class Audit:
    """What a state is, by its positions and springs; forces in mean disk weights.

    ``force_residual``, ``torque_residual``: largest on any disk. ``coulomb_excess``: largest ``|f_t| - mu f_n`` of a
    closed contact, ``rolling_excess``: the same of ``|f_r| - mu_r f_n``. ``relative_residual``: largest unbalanced
    force beyond ``rounding``, as a part of what the disk bears: its weight, its load and the contact forces on it.
    ``force_mismatch``: largest difference between a recorded contact force and the one found here. ``unlisted``: closed
    contacts that the state does not list. ``stale_springs``: open contacts that kept a spring, of either kind.
    ``escaped``: disks with their centre outside of the box. ``in_flight``: disks out of balance that no chain of
    contacts joins to a wall.
    """

    force_residual: float
    torque_residual: float
    coulomb_excess: float
    rolling_excess: float
    relative_residual: float
    force_mismatch: float
    unlisted: int
    stale_springs: int
    escaped: int
    in_flight: int


def audit(
    state: State,
    radius: FloatArray,
    mass: FloatArray,
    width: float,
    pair: ContactRule,
    wall: ContactRule,
    load: FloatArray,
    *,
    periodic: bool = False,
    rounding: float = 0.0,
) -> Audit:
    """Check a static state.

    Parameters
    ----------
    state : positions, springs, and the recorded forces to compare with.
    radius, mass : (n,).
    width : distance of the side walls, or the period.
    pair, wall : laws of the contacts between disks and with walls.
    load : (n, 3) external force and torque on each disk, gravity left out.
    periodic : x and x + width are the same place, and there are no side walls.
    rounding : force that a last digit of a position is worth (mean disk weights).
    """
    n = len(radius)
    x = state.position
    total = np.array(load, float)
    total[:, 1] -= mass
    borne = np.abs(mass) + np.hypot(load[:, 0], load[:, 1])
    excess, beyond, mismatch, unlisted = 0.0, 0.0, 0.0, 0

    def compare(forces: FloatArray, rule: ContactRule, recorded: FloatArray, known: np.ndarray) -> None:
        """Note what is beyond its limit, recorded otherwise or not listed; ``forces``: normal, tangential, rolling."""
        nonlocal excess, beyond, mismatch, unlisted
        fn, ft, fr = forces.T
        excess = max(excess, float((np.abs(ft) - rule.friction * fn).max(initial=0.0)))
        beyond = max(beyond, float((np.abs(fr) - rule.rolling_friction * fn).max(initial=0.0)))
        mismatch = max(mismatch, float(np.abs(forces - recorded)[known].max(initial=0.0)))
        unlisted += int((~known).sum())

    # disks: upper triangle of all pairs. The tangential spring and force do not change sign when the two disks are
    # exchanged: tangent and slip both turn over, and so does the disk the force acts on. Those along the rolling do:
    # the couple of the force is that on the first disk, and what rolls is its spin less that of the second.
    low, high = (which(state.pairs.first, state.pairs.second) for which in (np.minimum, np.maximum))
    turned = np.where(state.pairs.first > state.pairs.second, -1.0, 1.0)
    springs, recorded, listed = _tables(state.pairs, low, high, (n, n), turned)
    i, j = np.triu_indices(n, 1)
    d = x[i] - x[j]
    if periodic:  # the nearest of the images
        d[:, 0] -= width * np.floor(d[:, 0] / width + 0.5)
    distance = np.hypot(d[:, 0], d[:, 1])
    overlap = radius[i] + radius[j] - distance
    touch = overlap > 0
    i, j, d, overlap, distance = i[touch], j[touch], d[touch], overlap[touch], distance[touch]
    normal = d / distance[:, None]
    arm = radius[i] * radius[j] / (radius[i] + radius[j])
    fn = pair.normal_force(overlap, arm)
    ft, fr = pair.spring_forces(springs[i, j])
    _add(total, i, normal, fn, ft, radius, 1.0)
    _add(total, j, normal, fn, ft, radius, -1.0)
    for disk, sign in ((i, 1.0), (j, -1.0)):
        np.add.at(total[:, 2], disk, sign * arm * fr)
        np.add.at(borne, disk, np.hypot(fn, ft))
    compare(np.stack([fn, ft, fr], axis=1), pair, recorded[i, j], listed[i, j])

    # walls
    springs, recorded, listed = _tables(state.walls, state.walls.first, state.walls.second, (n, 3))
    held = np.zeros(n, bool)
    for side, gap in enumerate((x[:, 1],) if periodic else (x[:, 1], x[:, 0], width - x[:, 0])):
        k = np.flatnonzero(gap < radius)
        held[k] = True
        fn = wall.normal_force(radius[k] - gap[k], radius[k])
        ft, fr = wall.spring_forces(springs[k, side])
        _add(total, k, np.broadcast_to(_NORMALS[side], (len(k), 2)), fn, ft, radius, 1.0)
        total[k, 2] += radius[k] * fr
        borne[k] += np.hypot(fn, ft)
        compare(np.stack([fn, ft, fr], axis=1), wall, recorded[k, side], listed[k, side])

    stale = sum(
        int(((c.status == OPEN) & ((c.spring != 0) | (c.rolling_spring != 0))).sum())
        for c in (state.pairs, state.walls)
    )
    outside = (x[:, 1] < 0) | ~np.isfinite(x).all(axis=1)
    if not periodic:
        outside |= (x[:, 0] < 0) | (x[:, 0] > width)
    reached = -1
    while held.sum() > reached:  # from disk to disk along closed contacts
        reached = int(held.sum())
        both = held[i] | held[j]
        held[i[both]] = held[j[both]] = True
    turning = pair.friction > 0 or wall.friction > 0
    unbalanced = np.abs(total[:, :2]).max(axis=1)
    return Audit(
        force_residual=float(unbalanced.max()),
        torque_residual=float(np.abs(total[:, 2]).max()) if turning else 0.0,
        coulomb_excess=excess,
        rolling_excess=beyond,
        relative_residual=float((np.maximum(unbalanced - rounding, 0.0) / borne).max()),
        force_mismatch=mismatch,
        unlisted=unlisted,
        stale_springs=stale,
        escaped=int(outside.sum()),
        in_flight=int((~held & (unbalanced > FALLS * borne)).sum()),
    )


def _tables(
    c: Contacts, row: np.ndarray, column: np.ndarray, shape: tuple[int, int], turned: FloatArray | float = 1.0
) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Springs (..., 2), recorded forces (..., 3) and whether listed, in tables where each contact has its place.

    ``turned`` (m,): sign of what rolls there.
    """
    springs, recorded, listed = np.zeros((*shape, 2)), np.zeros((*shape, 3)), np.zeros(shape, bool)
    springs[row, column] = np.stack([c.spring, turned * c.rolling_spring], axis=1)
    recorded[row, column] = np.stack([c.normal_force, c.tangential_force, turned * c.rolling_force], axis=1)
    listed[row, column] = True
    return springs, recorded, listed


def _add(total, disk, normal, fn, ft, radius, sign: float) -> None:
    """Add ``sign (f_n n + f_t t)`` and the torque ``-R f_t`` to the disks."""
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    np.add.at(total[:, :2], disk, sign * (fn[:, None] * normal + ft[:, None] * tangent))
    np.add.at(total[:, 2], disk, -radius[disk] * ft)
