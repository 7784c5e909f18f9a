"""Incremental moduli of the slab under load, measured from its tangent stiffness, and the elastic slab with them.

The paper expects two peaks where moduli have r < 0 (Sec. V.C) and takes the slab for incrementally elastic (Secs. IV,
VIII). The tangent stiffness K of an equilibrium, with the statuses that its contacts have, answers families of small
loads, ``K u = f``. Stress and strain that these add are averaged with a Gaussian, and moduli fitted to them place by
place; disks move as K wants, so the moduli are not affine. No load of a family is the force on the loaded disk. What a
further unit of that force adds to the floor forces, K gives, and the elastic slab predicts.

The elastic slab is made of linear triangles whose corners are the disks: displacements of the disks have a gradient in
each, and every touching contact of a lattice is an edge. With the forces ``df`` that small displacements add, on the
first disk, and branch vectors ``d`` from the second disk to the first,

    sigma_ab = -1 / A  sum_edges share df_a d_b ,     share 1/2, or 1 for an edge of one triangle alone,

is the stress (tension positive) whose virtual work, ``sum A sigma : grad v``, is that of the contacts exactly, for any
displacements v of the disks. So the solid bears the same loads, on the same springs of floor and walls, as the packing,
and what it gets wrong is due to its moduli alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import scipy.sparse as sp
import xarray as xr
from numpy.typing import NDArray
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay, cKDTree

from granular_response.errors import SolveError
from granular_response.observe.floor import floor_force, smoothed_response
from granular_response.observe.peaks import is_double_peaked
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import added_forces, force_on
from granular_response.solvers.system import StaticSystem, Trial
from granular_response.state import FLOOR, SLIDING, FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.theory.moduli import peak_criterion
from granular_response_paper.datasets import labelled
from granular_response_paper.records import axes, column, labels, parts, places, record, table
from granular_response_paper.slab_response import LoadPath, Measures, two_peaks
from granular_response_paper.tasks import computed

from .parameters import Parameters

LOADS = ("body", "surface")
#: Part of the force by which it grows for the check of K.
STEP = 1e-5
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
        opposite = np.roll(corner, -1, axis=1) - np.roll(corner, -2, axis=1)
        slope = opposite[..., ::-1] * [1.0, -1.0] / (2.0 * area)[:, None, None]
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
        xx, xz, zx, zz = (self.stress_of @ (force[:, :, None] * self.branch[:, None]).reshape(-1, 4)).T
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


@record
class Fit:
    """Moduli by one family of loads and one width of the averages."""

    predicted: FloatArray = column("the same of the elastic slab with the moduli", "floor_disk")
    difference: float = column("largest difference of both, smoothed, per largest one measured")
    predicted_two_peaks: float = column("1 where that of the elastic slab has two peaks")
    unexplained: float = column("part of the stress of the loads that the moduli leave, median over places")
    antisymmetric: float = column("antisymmetric part of the stress of the loads")
    reach: float = column("depth down to which r < 0 below the load, per height of the top row above the lowest")


@record
class Step:
    """A loaded state, with its fits by width and loads."""

    force: float = column(f"force {WEIGHTS}")
    measured: FloatArray = column("floor force that a small further force adds, per force", "floor_disk")
    two_peaks: float = column("1 where that has two peaks")
    criterion: FloatArray = column("r by body forces, least width", "triangle")
    sliding: FloatArray = column(f"centres of sliding contacts of disks {RADII}", "contact", "axis")
    tangent_error: float = column("largest lack of K against the next equilibrium, per largest force")
    fits: dict[tuple[int, ...], Fit]


@record
class Outcome:
    """A slab along its forces."""

    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    crossover: FloatArray = column(f"force from which on there are two peaks, before and after {WEIGHTS}", "end")
    corners: FloatArray = column(f"corners of the triangles on the lattice {RADII}", "triangle", "corner", "axis")
    steps: tuple[Step, ...]


def loads(problem: Problem, state: State, waves: tuple[int, int]) -> dict[str, list[FloatArray]]:
    """Small loads (dof,) of each family: body forces in half waves, unit forces on the top row."""
    row = problem.packing.row
    x, z = (np.pi * state.position / [problem.packing.width, state.position[:, 1].max()]).T
    body = []
    for k, m, axis in product(range(waves[0] + 1), range(waves[1] + 1), (0, 1)):
        force = np.zeros((problem.freedoms, problem.n))
        force[axis] = np.cos(k * x) * np.cos(m * z)
        body.append(force.ravel())
    top = np.setdiff1d(np.flatnonzero(row == row.max()), problem.load_disk)
    return {"body": body, "surface": [force_on(problem, disk, axis) for disk, axis in product(top, (0, 1))]}


def reached(criterion: FloatArray, solid: Solid, row: NDArray[Any], x: float, spacing: float) -> float:
    """Down to where, of all rows of triangles, most of those within ``spacing`` of ``x`` have r < 0."""
    layer = row[solid.corners].min(axis=1)
    below = np.abs(solid.centre[:, 0] - x) < 0.6 * spacing
    low = [k for k in np.unique(layer[below]) if np.median(criterion[below & (layer == k)]) < 0.0]
    return 1.0 - min(low) / float(row.max()) if low else 0.0


def respond(parameters: Parameters, friction: float, forces: tuple[float, ...]) -> Outcome:
    """One slab. Raises what the solvers raise."""
    p = parameters
    path = LoadPath.of(p.base.updated({"contact.friction": friction}))
    measures, problem = Measures(path), path.problem
    path.through(forces)
    crossover = np.array(path.first(forces, two_peaks(measures)))
    packing, loaded, inside, disks = problem.packing, measures.loaded_disk, measures.interior, measures.disks
    corners, middle = triangles(packing.position), np.array([path.rest.position[loaded, 0], 0.0])

    def double(response: FloatArray) -> bool:
        return is_double_peaked(measures.x, response, interior=inside)

    def smooth(response: FloatArray) -> FloatArray:
        return smoothed_response(measures.x[inside], measures.x, response, p.smoothing)

    def step(state: State, after: State) -> Step:
        system = StaticSystem(problem, state)
        solid = Solid.of(system, state, corners)
        answer = system.answers(solid.trial)
        measured = solid.floor_forces(answer(problem.load_vector()))[disks]
        largest = smooth(measured).max()
        fields = {
            name: [np.stack(one, axis=-1) for one in zip(*map(solid.fields, map(answer, family)), strict=True)]
            for name, family in loads(problem, state, p.waves).items()
        }
        fits, criteria = {}, []
        for place, (width, name) in places(p.widths, LOADS):
            mean = solid.averages(width)
            strain, stress, turning = (
                (mean @ one.reshape(len(corners), -1)).reshape(one.shape) for one in fields[name]
            )
            moduli, left = fitted(strain, stress)
            criteria.append(peak_criterion(moduli[:, 0, 0], moduli[:, 1, 1], moduli[:, 0, 1], moduli[:, 2, 2]))
            predicted = solid.floor_forces(solid.answer(moduli, loaded))[disks]
            part = np.linalg.norm(turning) / np.hypot(np.linalg.norm(turning), np.linalg.norm(stress))
            depth = reached(criteria[-1], solid, packing.row, middle[0], measures.lattice_constant)
            difference = np.abs(smooth(predicted) - smooth(measured)).max() / largest
            fits[place] = Fit(predicted, difference, double(predicted), left, part, depth)
        pairs, slides = state.pairs, np.abs(state.pairs.status) == SLIDING
        centre = state.position[pairs.first] - 0.5 * state.pair_separation() - middle
        grown = (floor_force(after, disks) - floor_force(state, disks)) / (after.load_factor - state.load_factor)
        error = np.abs(grown - measured).max() / measured.max()
        return Step(state.load_factor, measured, double(measured), criteria[0], centre[slides], error, fits)

    steps = tuple(step(*path.through([force, force * (1.0 + STEP)])) for force in forces)
    return Outcome(measures.x, crossover, packing.position[corners] - middle, steps)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``slabs``."""
    p, slabs = parameters, parameters.slabs
    found = computed({(k,): partial(respond, p, s.friction, s.forces) for k, s in enumerate(slabs)}, "slabs")
    steps = parts(found, "steps")
    fits = {(*at, *place): fit for at, step in steps.items() for place, fit in step.fits.items()}
    slab = table(found, "slab")
    slab["corners"] = slab["corners"].isel(slab=0)
    tables = (slab, table(steps, "slab", "step"), table(fits, "slab", "step", "width", "loads"))
    coordinates = axes(
        width=(p.widths, f"w of the Gaussian over which fields are averaged {RADII}"),
        loads=(LOADS, "small loads to which moduli are fitted"),
        axis=("xz", "component"),
    )
    friction = labels(
        "slab", slabs, friction="coefficient of friction between disks", shown=f"force of the map {WEIGHTS}"
    )
    return labelled({"slabs": xr.merge(tables).assign_coords(coordinates | friction)}, p.base)
