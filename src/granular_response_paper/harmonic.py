"""The harmonic lattice: what an ordered packing would do if its contacts could not open (Fig. 14, Sec. V.F)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from granular_response.observe.stress import ContactForces
from granular_response.scene import Packing
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL, WALL_NORMAL, FloatArray


def harmonic_lattice(
    packing: Packing, load: FloatArray, normal_stiffness: float, wall_stiffness: float
) -> ContactForces:
    """Contact forces of a ``load`` (n, 2) in mean weights on a lattice of two-sided springs without friction.

    All bonds are alike, so the medium is isotropic, and none can open. Floor and side walls hold the disks nearest to
    them by springs too. Solved to first order in the displacements. Bonds come first, as ``packing.neighbour_pairs``
    has them, then the contacts with the floor, with the left wall, with the right one.
    """
    pairs = packing.neighbour_pairs()
    if pairs is None:
        raise ValueError("packing: must be a lattice, a packing from a file has no lattice bonds")
    n, position = packing.n, packing.position
    first, second = pairs[:, 0], pairs[:, 1]
    branch = position[first] - position[second]
    half = 0.5 * float(packing.lattice_constant or 2.0)
    (x, z), within = position.T, half + 1e-6
    which, wall_disk = np.nonzero([z < within, x < within, x > packing.width - within])
    wall = np.array([FLOOR, LEFT_WALL, RIGHT_WALL])[which]
    normal = branch / np.linalg.norm(branch, axis=1, keepdims=True)

    def compression(*ends: tuple[NDArray, FloatArray]) -> sp.csr_array:
        """Maps displacements [x | z] to the changes of distances, given disks and directions at the ends of these."""
        count = len(ends[0][0])
        parts = [(np.arange(count), disks + axis * n, along[:, axis]) for disks, along in ends for axis in range(2)]
        rows, columns, values = map(np.concatenate, zip(*parts, strict=True))
        return sp.csr_array((values, (rows, columns)), shape=(count, 2 * n))

    bonds = compression((first, normal), (second, -normal))
    holds = compression((wall_disk, WALL_NORMAL[wall]))
    stiffness = normal_stiffness * (bonds.T @ bonds) + wall_stiffness * (holds.T @ holds)
    displacement = spsolve(sp.csc_array(stiffness), load.T.ravel())
    force = -normal_stiffness * (bonds @ displacement)
    wall_force = -wall_stiffness * (holds @ displacement)
    return ContactForces(
        point=np.concatenate([position[first], position[wall_disk]]),
        branch=np.concatenate([branch, half * WALL_NORMAL[wall]]),
        force=np.concatenate([force[:, None] * normal, wall_force[:, None] * WALL_NORMAL[wall]]),
    )
