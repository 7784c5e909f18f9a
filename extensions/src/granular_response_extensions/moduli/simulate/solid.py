"""The elastic slab that stands for a loaded state.

It is made of linear triangles whose corners are the disks: displacements of the disks have a gradient in
each, and every touching contact of a lattice is an edge. With the forces ``df`` that small displacements add, on the
first disk, and branch vectors ``d`` from the second disk to the first,

    sigma_ab = -1 / A  sum_edges share df_a d_b ,     share 1/2, or 1 for an edge of one triangle alone,

is the stress (tension positive) whose virtual work, ``sum A sigma : grad v``, is that of the contacts exactly, for any
displacements v of the disks. So the solid bears the same loads, on the same springs of floor and walls, as the packing,
and what it gets wrong is due to its moduli alone.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay, cKDTree

from granular_response.errors import SolveError
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import added_forces
from granular_response.solvers.system import StaticSystem
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


class Solid:
    """The triangles of a loaded state, whose contacts keep their statuses."""

    def __init__(self, problem: Problem, state: State, corners: NDArray[np.intp]):
        """With ``corners`` (t, 3). Raises SolveError for a contact that is no edge."""
        self.system = system = StaticSystem(problem, state)
        self.trial, self.branch = system.at(state), state.pair_separation()
        corner = state.position[corners]
        self.corners, self.centre, self.area = corners, corner.mean(axis=1), _area(corner)
        opposite = np.roll(corner, -1, axis=1) - np.roll(corner, -2, axis=1)
        slope = opposite[..., ::-1] * [1.0, -1.0] / (2.0 * self.area)[:, None, None]
        strain = np.zeros((len(corners), 3, 3, 2))
        strain[:, 0, :, 0], strain[:, 1, :, 1] = slope[..., 0], slope[..., 1]
        strain[:, 2] = slope[..., ::-1] / SHEAR
        self.strain_of = strain.reshape(-1, 3, 6)  #: per displacement (x, z) of each corner
        n = problem.n
        edge = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], -1), -1) @ [n, 1]
        pair = np.minimum(system.first, system.second) * n + np.maximum(system.first, system.second)
        order = np.argsort(pair)
        place = order[np.minimum(np.searchsorted(pair, edge, sorter=order), len(pair) - 1)]
        listed = pair[place] == edge
        owner, contact = np.nonzero(listed)[0], place[listed]
        times = np.bincount(contact, minlength=len(pair))
        if (state.pairs.touching & (times == 0)).any():
            raise SolveError("a contact is no edge of the lattice")
        share = -1.0 / (times[contact] * self.area[owner])
        self.stress_of = sp.csr_array((share, (owner, contact)), (len(corners), len(pair)))  #: per force of a contact

    def fields(self, moved: Iterable[FloatArray]) -> list[FloatArray]:
        """Strain (t, 3, k) and stress (t, 3, k) of k displacements (dof,)."""
        each = []
        for one in moved:
            u = one.reshape(-1, self.system.problem.n)[:2].T
            strain = np.einsum("tai,ti->ta", self.strain_of, u[self.corners].reshape(-1, 6))
            force = added_forces(self.system, self.trial, one)[0]
            xx, xz, zx, zz = (self.stress_of @ (force[:, :, None] * self.branch[:, None]).reshape(-1, 4)).T
            each.append((strain, np.stack([xx, zz, (xz + zx) / SHEAR], axis=-1)))
        return [np.stack(field, axis=-1) for field in zip(*each, strict=True)]

    def averaged(self, fields: Iterable[FloatArray], width: float) -> list[FloatArray]:
        """Means of fields (t, ...) over triangles, weighted by area and by ``exp(-(distance / width)^2)``."""
        tree = cKDTree(self.centre)
        near = tree.sparse_distance_matrix(tree, CUTOFF * width, output_type="coo_matrix")
        weight = np.exp(-((near.data / width) ** 2)) * self.area[near.col]
        total = np.bincount(near.row, weight, len(self.area))
        mean = sp.csr_array((weight / total[near.row], (near.row, near.col)), near.shape)
        return [(mean @ one.reshape(len(self.area), -1)).reshape(one.shape) for one in fields]

    def answer(self, moduli: FloatArray, disk: int) -> FloatArray:
        """(2 n,) displacements under a unit force downwards on a disk, with ``moduli`` (t, 3, 3)."""
        n, wall_disk = self.system.problem.n, self.system.wall_disk
        walls = self.system.split(self.trial.tangent)[1][:, :2, :2]
        stiffness = np.einsum("tai,tab,tbj,t->tij", self.strain_of, moduli, self.strain_of, self.area)
        blocks = (stiffness, (self.corners[..., None] + [0, n]).reshape(-1, 6)), (-walls, wall_disk[:, None] + [0, n])
        data = np.concatenate([block.ravel() for block, _ in blocks])
        row = np.concatenate([np.repeat(at, at.shape[1], axis=1).ravel() for _, at in blocks])
        across = np.concatenate([np.tile(at, at.shape[1]).ravel() for _, at in blocks])
        load = np.zeros(2 * n)
        load[n + disk] = -1.0
        return np.asarray(splu(sp.csc_array((data, (row, across)), (2 * n, 2 * n))).solve(load))

    def floor_forces(self, moved: FloatArray) -> FloatArray:
        """(n,) what displacements (dof,) add to the vertical floor force on each disk; the floor is smooth."""
        force = added_forces(self.system, self.trial, moved)[1][:, 1] * (self.system.wall == FLOOR)
        return np.asarray(np.bincount(self.system.wall_disk, force, self.system.problem.n), dtype=float)

    def reached(self, criterion: FloatArray, x: float, spacing: float) -> float:
        """Down to where, of all rows of triangles, most of those within ``spacing`` of ``x`` have r < 0."""
        row = self.system.problem.packing.row
        layer = row[self.corners].min(axis=1)
        below = np.abs(self.centre[:, 0] - x) < 0.6 * spacing
        low = [k for k in np.unique(layer[below]) if np.median(criterion[below & (layer == k)]) < 0.0]
        return 1.0 - min(low) / float(row.max()) if low else 0.0


def fitted(strain: FloatArray, stress: FloatArray) -> FloatArray:
    """Moduli (t, 3, 3) of fields (t, 3, k) under k loads by least squares.

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
    return np.asarray((vector * value[:, None, :]) @ np.swapaxes(vector, 1, 2))
