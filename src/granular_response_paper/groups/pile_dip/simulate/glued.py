"""The frictionless pile with contacts that cannot open: two-sided springs in place of one-sided ones (Sec. V.F).

With lattice neighbours as the contacts, small displacements u solve the linear equations

    sum over contacts of k n n . (u_i - u_j) + k_wall n n . u_i = m_i g ,

k the normal stiffness and n the direction of a contact. What the pile lacks beside the real one is the opening alone.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from granular_response.scene import Packing, Scene
from granular_response.state import FloatArray


def floor_forces(packing: Packing, scene: Scene) -> FloatArray:
    """(floor_disk,) vertical forces on the lowest disks, in their order (mean weights).

    Raises ValueError for a packing without a lattice.
    """
    pairs = packing.neighbour_pairs()
    if pairs is None:
        raise ValueError("only a lattice has neighbours before it is settled")
    position, n = packing.position, packing.n
    stiffness, wall = scene.contact.normal_stiffness, 2.0 * scene.contact.normal_stiffness
    bottom = np.flatnonzero(packing.row == 0)
    along = position[pairs[:, 0]] - position[pairs[:, 1]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    ends, walls = (bottom[0], bottom[-1]), np.concatenate([bottom, [bottom[0], bottom[-1]]])
    axis = np.array([1] * len(bottom) + [0] * len(ends))
    # a row for each contact: how much it is stretched by displacements (x and z of disk 0, of disk 1, ...)
    count = len(pairs)
    rows = np.concatenate([np.repeat(np.arange(count), 4), count + np.arange(len(walls))])
    columns = np.concatenate([(2 * pairs[:, [0, 0, 1, 1]] + [0, 1, 0, 1]).ravel(), 2 * walls + axis])
    values = np.concatenate([np.concatenate([along, -along], axis=1).ravel(), np.ones(len(walls))])
    stretch = coo_array((values, (rows, columns)), shape=(count + len(walls), 2 * n)).tocsr()
    springs = np.concatenate([np.full(count, stiffness), np.full(len(walls), wall)])
    weight = np.zeros(2 * n)
    weight[1::2] = -packing.mass
    displacement = spsolve((stretch.T * springs @ stretch).tocsc(), weight)
    return -wall * displacement[2 * bottom + 1]
