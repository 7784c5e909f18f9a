"""Coarse-grained stress of a contact network (Secs. V.C, V.D, V.F; Figs. 14 and 17; refs. [29, 85] there).

With ``f`` the force on the first partner of a contact, ``r`` that partner's centre, ``d`` the branch vector
from the second partner to it, and the Gaussian ``phi(r) = exp(-|r|^2/w^2) / (pi w^2)``,

    sigma_ab(R) = sum_contacts f_a d_b integral_0^1 phi(R - r + s d) ds .

The first index is the force's, the second the branch's. Compression is positive: the sign is opposite to that
of elasticity textbooks (and of the cited references), as in a plot of the pressure on the floor. For a wall
contact the second partner is the contact point on the wall.

Balance. Differentiating under the integral gives, exactly and for every w,

    d sigma_ab / d R_b = sum_disks F_a phi(R - r) + sum_wall_contacts f_a phi(R - c) ,

where F is the force on a disk that is not a contact force (gravity, load) and c the point where a wall
pushes with f. Away from the walls that is the coarse-grained body force. So the integral of sigma_zz over a
horizontal line that is a few w away from load and floor is the vertical load above the line.

Forces in mean disk weights, lengths in mean radii, so stress in weights per radius.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import check_positive
from ..state import FloatArray, State
from .difference import pair_force_difference, wall_force_difference
from .floor import smoothed_response

#: Evaluations of a contact at a point that are held in memory at once.
_CHUNK = 2_000_000


@dataclass(frozen=True)
class ContactForces:
    """Contacts as the stress sees them, arrays of shape (c, 2)."""

    point: FloatArray  #: centre of the disk the force acts on
    branch: FloatArray  #: from the partner (centre of the other disk, or point on the wall) to ``point``
    force: FloatArray  #: force on that disk
    period: float | None = None  #: of x, with periodic sides


def contact_forces(state: State) -> ContactForces:
    """All touching contacts of a state, walls included."""
    return given_forces(state, state.pair_force(), state.wall_force())


def load_forces(rest: State, loaded: State) -> ContactForces:
    """The forces that the load adds, at the contacts of the loaded geometry (Fig. 14).

    Gravity is subtracted as a vector at each contact. Points and branch vectors are those of the loaded state, so the
    balance with the load alone is exact; the difference of the two states' stresses is another field, by the product of
    rest forces and displacements. Raises ``ValueError`` if the states list different candidates.
    """
    return given_forces(loaded, pair_force_difference(rest, loaded), wall_force_difference(rest, loaded))


def given_forces(state: State, pair_force: FloatArray, wall_force: FloatArray) -> ContactForces:
    """Forces (m, 2) and (w, 2) on the first partners of the contacts of ``state``, not its own; zeros are left out."""
    position, pairs, walls = state.position, state.pairs, state.walls
    at_wall = position[walls.first]
    on_wall = state.box.on_wall(at_wall, walls.second)
    force = np.concatenate([pair_force, wall_force])
    carries = np.any(force != 0.0, axis=1)
    point = np.concatenate([position[pairs.first], at_wall])[carries]
    branch = np.concatenate([state.pair_separation(), at_wall - on_wall])[carries]
    return ContactForces(point=point, branch=branch, force=force[carries], period=state.box.period)


def _images(contacts: ContactForces, period: float, reach: float) -> tuple[ContactForces, int]:
    """The contacts with their images that are nearer than ``reach`` to a point of one period, and how many of each."""
    copies = range(-math.ceil(reach / period), math.ceil(reach / period) + 1)
    inside = np.stack([np.mod(contacts.point[:, 0], period), contacts.point[:, 1]], axis=1)
    whole = ContactForces(
        point=np.concatenate([inside + np.array([copy * period, 0.0]) for copy in copies]),
        branch=np.tile(contacts.branch, (len(copies), 1)),
        force=np.tile(contacts.force, (len(copies), 1)),
    )
    return whole, len(copies)


def coarse_grained_stress(
    contacts: ContactForces, points: FloatArray, width: float = 2.0, cutoff: float = 4.0
) -> FloatArray:
    """Stress tensor at ``points``, (..., 2) to (..., 2, 2), compression positive.

    ``width`` is that of the Gaussian (w, two mean radii in the paper). Contacts more than ``cutoff`` widths
    away from a point are left out; each would contribute less than exp(-cutoff^2) of its peak.
    Raises ``ValueError`` unless both are positive.
    """
    from scipy.special import erf  # importing takes a twentieth of a second at the start of every process

    check_positive(width=width, cutoff=cutoff)
    flat = points.reshape(-1, 2)
    length = np.linalg.norm(contacts.branch, axis=1)
    if contacts.period is not None:
        flat = np.stack([np.mod(flat[:, 0], contacts.period), flat[:, 1]], axis=1)
        contacts, count = _images(contacts, contacts.period, cutoff * width + float(length.max(initial=0.0)))
        length = np.tile(length, count)
    direction = contacts.branch / np.where(length > 0.0, length, 1.0)[:, None]
    # Outer product with the unit branch vector: the length is in the line integral.
    tensor = contacts.force[:, :, None] * direction[:, None, :]
    stress = np.zeros((flat.shape[0], 4))
    components = tensor.reshape(-1, 4)
    middle, reach = contacts.point - 0.5 * contacts.branch, cutoff * width + 0.5 * length
    for at, c in _near(flat, middle, reach):
        offset = flat[at] - contacts.point[c]
        along = np.einsum("ij,ij->i", offset, direction[c])
        across2 = np.einsum("ij,ij->i", offset, offset) - along**2
        # integral over the branch of the Gaussian, times the length of the branch
        weight = np.exp(-across2 / width**2) * (erf((along + length[c]) / width) - erf(along / width))
        weight /= 2.0 * np.sqrt(np.pi) * width
        for k in range(4):
            stress[:, k] += np.bincount(at, weights=weight * components[c, k], minlength=flat.shape[0])
    return stress.reshape(*points.shape[:-1], 2, 2)


def virial_stress(state: State, radius: FloatArray, pair_force: FloatArray, wall_force: FloatArray) -> FloatArray:
    """(n, 2, 2) stress of each disk from forces (m, 2) and (w, 2) at its contacts, compression positive.

        sigma_ab = - sum_contacts f_a (c - r)_b / (pi R^2)

    with ``f`` the force on the disk, ``r`` its centre and ``c`` the point of contact, in the middle of the overlap, so
    that the two arms of a contact between disks add up to its branch vector. ``radius`` (n,) : of the disks.
    """
    pairs, walls = state.pairs, state.walls
    normal, overlap = state.pair_normal(), 0.5 * pairs.overlap
    # from the point of contact to the centre, of both disks of a pair, and of disks at walls
    arms = [(radius[pairs.first] - overlap)[:, None] * normal, (overlap - radius[pairs.second])[:, None] * normal]
    at_wall = state.position[walls.first]
    arms.append(at_wall - state.box.on_wall(at_wall, walls.second))
    disks = pairs.first, pairs.second, walls.first
    total = np.zeros((len(radius), 2, 2))
    for disk, force, arm in zip(disks, (pair_force, -pair_force, wall_force), arms, strict=True):
        np.add.at(total, disk, force[:, :, None] * arm[:, None, :])
    return total / (np.pi * radius**2)[:, None, None]


def couple_stress(
    state: State, radius: FloatArray, points: FloatArray, width: float = 2.0, cutoff: float = 4.0
) -> FloatArray:
    """Couple stress at ``points``, (..., 2) to (..., 2), in mean disk weights, of all touching contacts of a state.

    What contacts hand on of couples, as the stress is what they hand on of forces (Goldhirsch, Granular Matter 12, 239
    (2010)), with the branch vector ``d`` and the couple about the middle between what both bodies feel,

        m_b(R) = sum_contacts c d_b integral_0^1 phi(R - r + s d) ds ,     c = M - (R_i - R_j) f_t / 2 ,

    where ``M`` is the couple of the rolling resistance on the first disk, reduced radius times rolling force, ``f_t``
    the force along the tangent, and ``R_j`` is 0 at a wall. Away from walls and loads its divergence is the torque that
    the tangential forces leave to the two disks, ``-(R_i + R_j) f_t``, half of it at each centre, which the
    antisymmetric part of the stress shows. Between equal disks without rolling resistance it is 0.

    ``radius`` (n,) is that of the disks; ``width`` and ``cutoff`` as for the stress, with its errors.
    """
    pairs, walls = state.pairs, state.walls
    first, second, at_wall = radius[pairs.first], radius[pairs.second], radius[walls.first]
    left = (first - second) * pairs.tangential_force, at_wall * walls.tangential_force
    each = zip(state.couples(radius), left, strict=True)
    pair, wall = (np.stack([m - 0.5 * rest, np.zeros_like(m)], axis=1) for m, rest in each)
    return coarse_grained_stress(given_forces(state, pair, wall), points, width, cutoff)[..., 0, :]


def line_forces(contacts: ContactForces, height: float) -> tuple[FloatArray, FloatArray]:
    """(k,) places along x and vertical forces of the contacts whose branch crosses the horizontal line at ``height``.

    Positive where the contact hands force down. Their sum is, exactly, the vertical load on the disks with their
    centres above the line, less what side walls bear of it.
    """
    top, bottom = contacts.point[:, 1], contacts.point[:, 1] - contacts.branch[:, 1]
    crossing = (top > height) != (bottom > height)
    point, branch, force = contacts.point[crossing], contacts.branch[crossing], contacts.force[crossing]
    at = point[:, 0] - branch[:, 0] * (point[:, 1] - height) / branch[:, 1]
    return at, force[:, 1] * np.sign(branch[:, 1])


def line_stress(contacts: ContactForces, height: float, x: FloatArray, width: float = 2.0) -> FloatArray:
    """(len(x),) vertical stress on the horizontal line at ``height``, compression positive, coarse-grained along x.

    The forces that cross the line (:func:`line_forces`) under the Gaussian ``exp(-(x/width)^2) / (width sqrt(pi))``:
    the stress above, averaged over no height. Raises ``ValueError`` unless ``width`` is positive.
    """
    return smoothed_response(x, *line_forces(contacts, height), width, contacts.period)


def grid_points(x: FloatArray, z: FloatArray) -> FloatArray:
    """(len(z), len(x), 2) points of a rectangular grid."""
    return np.stack(np.meshgrid(x, z), axis=-1)


def pressure(stress: FloatArray) -> FloatArray:
    """Half the trace of ``stress`` (..., 2, 2); positive in compression."""
    return 0.5 * (stress[..., 0, 0] + stress[..., 1, 1])


def antisymmetric_part(stress: FloatArray) -> FloatArray:
    """``(sigma_xz - sigma_zx) / 2`` of ``stress`` (..., 2, 2), which tangential forces cause (Sec. V.C)."""
    return 0.5 * (stress[..., 0, 1] - stress[..., 1, 0])


def _near(
    points: FloatArray, centre: FloatArray, reach: FloatArray
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Index pairs (point, centre) within ``reach`` of each centre, about ``_CHUNK`` at a time."""
    if points.size == 0 or centre.size == 0:
        return
    from scipy.spatial import cKDTree  # importing takes a twentieth of a second at the start of every process

    tree = cKDTree(points)
    counts = np.asarray(tree.query_ball_point(centre, reach, return_length=True))
    group = np.cumsum(counts) // _CHUNK
    edges = [0, *(np.flatnonzero(np.diff(group)) + 1).tolist(), counts.size]
    for low, high in pairwise(edges):
        near = tree.query_ball_point(centre[low:high], reach[low:high], return_sorted=False)
        at = np.concatenate([np.asarray(p, dtype=np.intp) for p in near])
        yield at, np.repeat(np.arange(low, high), counts[low:high])
