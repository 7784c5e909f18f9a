"""An elastic solid with the incremental moduli of a loaded packing, in linear triangles whose corners are its disks.

Displacements of the disks, linear in each triangle, have a gradient there, and every touching contact of a lattice is
an edge. With the forces ``df`` that small displacements add, positive on the first disk, and branch vectors ``d`` from
the second disk to the first,

    sigma_ab = -1 / A  sum_edges share df_a d_b ,     share 1/2, or 1 for an edge of one triangle alone,

is the stress (tension positive) whose virtual work, ``sum A sigma : grad v``, is that of the contacts exactly, for any
displacements v of the disks. So the solid bears the same loads, on the same springs of floor and walls, as the packing,
and what it gets wrong is due to its moduli alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay, cKDTree

from granular_response.errors import SolveError
from granular_response.solvers.small_loads import added_forces
from granular_response.solvers.system import StaticSystem, Trial
from granular_response.state import FLOOR, FloatArray, State

#: Gaussian widths beyond which triangles do not count.
CUTOFF = 3.5
#: Least eigenvalue of moduli, per largest: without one, an open region without friction has none in one direction.
LEAST = 1e-4
#: A symmetric matrix of stress per strain has these components of both: xx, zz, sqrt(2) xz.
SHEAR = np.sqrt(2.0)


def triangles(position: FloatArray) -> NDArray[np.intp]:
    """(t, 3) disks of the triangles of a lattice of centres (n, 2), counterclockwise. SolveError for a single row."""
    if np.ptp(position[:, 1]) == 0.0:
        raise SolveError("a single row of disks has no triangles")
    corners = np.asarray(Delaunay(position).simplices, dtype=np.intp)
    area = _area(position[corners])
    corners[area < 0.0] = corners[area < 0.0][:, [0, 2, 1]]
    return corners[np.abs(area) > 1e-6 * np.abs(area).max()]  # without slivers along a straight rim


def _area(corner: FloatArray) -> FloatArray:
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return np.asarray(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))


@dataclass(frozen=True)
class Solid:
    """The triangles of a loaded state."""

    system: StaticSystem
    trial: Trial  #: of the state; its statuses are kept
    corners: NDArray[np.intp]  #: (t, 3)
    area: FloatArray  #: (t,)
    centre: FloatArray  #: (t, 2)
    strain_of: FloatArray  #: (t, 3, 6) strain per displacement (x, z) of each corner
    stress_of: sp.csr_array  #: (t, m) contacts to triangles
    branch: FloatArray  #: (m, 2)

    @classmethod
    def of(cls, system: StaticSystem, state: State, corners: NDArray[np.intp]) -> Solid:
        """Raises SolveError for a contact that is no edge."""
        corner = state.position[corners]
        area = _area(corner)
        after, before = np.roll(corner, -1, axis=1), np.roll(corner, -2, axis=1)
        slope = (
            np.stack([after[..., 1] - before[..., 1], before[..., 0] - after[..., 0]], -1) / (2 * area)[:, None, None]
        )
        strain = np.zeros((len(corners), 3, 3, 2))
        strain[:, 0, :, 0], strain[:, 1, :, 1] = slope[..., 0], slope[..., 1]
        strain[:, 2] = slope[..., ::-1] / SHEAR
        n = system.problem.n
        edge = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], -1), -1) @ [n, 1]
        pair = np.minimum(system.first, system.second) * n + np.maximum(system.first, system.second)
        order = np.argsort(pair)
        place = order[np.minimum(np.searchsorted(pair, edge, sorter=order), len(pair) - 1)]
        listed = pair[place] == edge
        owner, contact = np.nonzero(listed)[0], place[listed]
        times = np.bincount(contact, minlength=len(pair))
        if (state.pairs.touching & (times == 0)).any():
            raise SolveError("a contact is no edge of the lattice")
        share = sp.csr_array((-1.0 / (times[contact] * area[owner]), (owner, contact)), (len(corners), len(pair)))
        return cls(
            system, system.at(state), corners, area, corner.mean(axis=1), strain.reshape(-1, 3, 6), share,
            state.pair_separation(),
        )  # fmt: skip

    def fields(self, moved: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Strain (t, 3), stress (t, 3) and (sigma_xz - sigma_zx) / sqrt(2) (t,) of displacements (dof,)."""
        u = moved.reshape(-1, self.system.problem.n)[:2].T
        strain = np.einsum("tai,ti->ta", self.strain_of, u[self.corners].reshape(-1, 6))
        force = added_forces(self.system, self.trial, moved)[0]
        xx, zz, xz, zx = (
            self.stress_of @ (force[:, a] * self.branch[:, b]) for a, b in ((0, 0), (1, 1), (0, 1), (1, 0))
        )
        return strain, np.stack([xx, zz, (xz + zx) / SHEAR], axis=-1), (xz - zx) / SHEAR

    def averages(self, width: float) -> sp.csr_array:
        """(t, t) means over triangles, weighted by area and by ``exp(-(distance / width)^2)``."""
        tree = cKDTree(self.centre)
        near = tree.sparse_distance_matrix(tree, CUTOFF * width, output_type="coo_matrix")
        weight = np.exp(-((near.data / width) ** 2)) * self.area[near.col]
        total = np.bincount(near.row, weight, len(self.area))
        return sp.csr_array((weight / total[near.row], (near.row, near.col)), near.shape)

    def answer(self, moduli: FloatArray, disk: int) -> FloatArray:
        """(2 n,) displacements under a unit force downwards on a disk, with ``moduli`` (t, 3, 3)."""
        n, walls = self.system.problem.n, self._walls
        stiffness = np.einsum("tai,tab,tbj,t->tij", self.strain_of, moduli, self.strain_of, self.area)
        parts = (stiffness, (self.corners[..., None] + [0, n]).reshape(-1, 6)), (-walls, self._at_walls)
        data = np.concatenate([matrix.ravel() for matrix, _ in parts])
        row = np.concatenate([np.repeat(at, at.shape[1], axis=1).ravel() for _, at in parts])
        column = np.concatenate([np.tile(at, at.shape[1]).ravel() for _, at in parts])
        load = np.zeros(2 * n)
        load[n + disk] = -1.0
        return np.asarray(splu(sp.csc_array((data, (row, column)), (2 * n, 2 * n))).solve(load))

    def floor_forces(self, moved: FloatArray) -> FloatArray:
        """(n,) what displacements (dof,) add to the vertical floor force on each disk; the floor is smooth."""
        force = np.einsum("wb,wb->w", self._walls[:, 1], moved[self._at_walls])
        on_floor = force * (self.system.wall == FLOOR)
        return np.asarray(np.bincount(self.system.wall_disk, on_floor, self.system.problem.n), dtype=float)

    @property
    def _walls(self) -> FloatArray:
        """(w, 2, 2) what displacements add to the forces of smooth walls."""
        return self.system.split(self.trial.tangent)[1][:, :2, :2]

    @property
    def _at_walls(self) -> NDArray[np.intp]:
        """(w, 2) the displacements of the disks at walls."""
        return np.asarray(self.system.wall_disk[:, None] + [0, self.system.problem.n], dtype=np.intp)


def fitted(strain: FloatArray, stress: FloatArray) -> tuple[FloatArray, float]:
    """Moduli (t, 3, 3) of fields (t, 3, k) under k loads by least squares; part of the stress they leave, the median.

    Symmetric, each load with the weight of its strain; with M the moduli, e the strains and s the stresses so weighted,
    ``M e e' + e e' M = s e' + e s'``. Eigenvalues below ``LEAST`` of the largest are raised to it.
    """
    size = np.linalg.norm(strain, axis=1, keepdims=True)
    e, s = strain / size, stress / size
    square, turn = np.linalg.eigh(e @ np.swapaxes(e, 1, 2))
    product = np.swapaxes(turn, 1, 2) @ (s @ np.swapaxes(e, 1, 2)) @ turn
    moduli = (product + np.swapaxes(product, 1, 2)) / (square[:, :, None] + square[:, None, :])
    value, vector = np.linalg.eigh(turn @ moduli @ np.swapaxes(turn, 1, 2))
    value = np.maximum(value, LEAST * value[:, -1:])
    definite = (vector * value[:, None, :]) @ np.swapaxes(vector, 1, 2)
    left = np.linalg.norm(s - definite @ e, axis=(1, 2)) / np.linalg.norm(s, axis=(1, 2))
    return definite, float(np.median(left))


def peak_criterion(moduli: FloatArray) -> FloatArray:
    """(t,) ``r = [a b - c (c + d)] / (b d)`` of moduli (t, 3, 3): two peaks are expected for r < 0 (Sec. V.C)."""
    a, b, c, d = moduli[:, 0, 0], moduli[:, 1, 1], moduli[:, 0, 1], moduli[:, 2, 2]
    return np.asarray((a * b - c * (c + d)) / (b * d))
