"""Incremental moduli of the slab under load, measured from its tangent stiffness, and the elastic slab with them.

The paper expects two peaks where moduli have r < 0 (Sec. V.C) and takes the slab for incrementally elastic (Secs. IV,
VIII). The tangent stiffness K of an equilibrium, with the statuses that its contacts have, answers families of small
loads, ``K u = f``. Stress and strain that these add are averaged with a Gaussian, and moduli fitted to them place by
place; disks move as K wants, so the moduli are not affine. No load of a family is the force on the loaded disk. What a
further unit of that force adds to the floor forces, K gives, and the elastic slab predicts.
"""

from __future__ import annotations

from functools import partial
from itertools import product

import numpy as np
import xarray as xr

from granular_response.observe.floor import floor_force, smoothed_response
from granular_response.observe.peaks import is_double_peaked
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import force_on
from granular_response.state import SLIDING, FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.studies import LoadPath, Measures, two_peaks
from granular_response.theory.moduli import peak_criterion
from granular_response_extensions.moduli.parameters import LoadedSlabs, Parameters
from granular_response_extensions.moduli.simulate.response import apart
from granular_response_extensions.moduli.simulate.solid import Solid, fitted, triangles
from granular_response_paper.records import axes, column, labels, parts, places, record, table
from granular_response_paper.tasks import computed

LOADS = ("body", "surface")
#: Part of the force by which it grows for the check of K.
STEP = 1e-5


@record
class FittedModuli:
    """Moduli by one family of loads and one width of the averages."""

    predicted: FloatArray = column("the same of the elastic slab with the moduli", "floor_disk")
    difference: float = column("largest difference of both, smoothed, per largest one measured")
    predicted_two_peaks: float = column("1 where that of the elastic slab has two peaks")
    reach: float = column("depth down to which r < 0 below the load, per height of the top row above the lowest")


@record
class Step:
    """A loaded state, with its fits by width and loads."""

    force: float = column(f"force {WEIGHTS}")
    measured: FloatArray = column("incremental floor force per small further force", "floor_disk")
    two_peaks: float = column("1 where that has two peaks")
    criterion: FloatArray = column("r by body forces, least width", "triangle")
    sliding: FloatArray = column(f"centres of sliding contacts of disks {RADII}", "contact", "axis")
    tangent_error: float = column("largest lack of K against the next equilibrium, per largest force")
    fits: dict[tuple[int, ...], FittedModuli]


@record
class Loading:
    """A slab along its forces."""

    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    crossover: FloatArray = column(f"force from which on there are two peaks, before and after {WEIGHTS}", "end")
    corners: FloatArray = column(f"corners of the triangles on the lattice {RADII}", "triangle", "corner", "axis")
    steps: tuple[Step, ...]


def loads(problem: Problem, state: State, along_x: int, along_z: int) -> dict[str, list[FloatArray]]:
    """Small loads (dof,) of each family: body forces in up to so many half waves, unit forces on the top row."""
    row = problem.packing.row
    x, z = (np.pi * state.position / [problem.packing.width, state.position[:, 1].max()]).T
    body = []
    for k, m, axis in product(range(along_x + 1), range(along_z + 1), (0, 1)):
        force = np.zeros((problem.freedoms, problem.n))
        force[axis] = np.cos(k * x) * np.cos(m * z)
        body.append(force.ravel())
    top = np.setdiff1d(np.flatnonzero(row == row.max()), problem.load_disk)
    return {"body": body, "surface": [force_on(problem, disk, axis) for disk, axis in product(top, (0, 1))]}


def respond(scene: Scene, loaded: LoadedSlabs, forces: tuple[float, ...]) -> Loading:
    """One slab. Raises what the solvers raise."""
    path = LoadPath.of(scene)
    measures, problem = Measures(path), path.problem
    path.through(forces)
    crossover = np.array(path.first(forces, two_peaks(measures)))
    lattice, disk, inside, disks = problem.packing.position, measures.loaded_disk, measures.interior, measures.disks
    corners, middle = triangles(lattice), np.array([path.rest.position[disk, 0], 0.0])

    def double(response: FloatArray) -> bool:
        return is_double_peaked(measures.x, response, interior=inside)

    def smooth(response: FloatArray) -> FloatArray:
        return smoothed_response(measures.x[inside], measures.x, response, loaded.smoothing)

    def step(state: State, after: State) -> Step:
        solid = Solid(problem, state, corners)
        answer = solid.system.answers(solid.trial)
        measured = solid.floor_forces(answer(problem.load_vector))[disks]
        families = loads(problem, state, loaded.horizontal_waves, loaded.vertical_waves)
        fields = {name: solid.fields(map(answer, family)) for name, family in families.items()}
        fits, criteria = {}, []
        for place, (width, name) in places(loaded.widths, LOADS):
            moduli = fitted(*solid.averaged(fields[name], width))
            criteria.append(peak_criterion(*moduli[:, [0, 1, 0, 2], [0, 1, 1, 2]].T))
            predicted = solid.floor_forces(solid.answer(moduli, disk))[disks]
            depth = solid.reached(criteria[-1], middle[0], measures.lattice_constant)
            difference = float(apart(smooth(predicted), smooth(measured)))
            fits[place] = FittedModuli(predicted, difference, double(predicted), depth)
        pairs, slides = state.pairs, np.abs(state.pairs.status) == SLIDING
        centre = state.position[pairs.first] - 0.5 * state.pair_separation() - middle
        grown = (floor_force(after, disks) - floor_force(state, disks)) / (after.load_factor - state.load_factor)
        error = np.abs(grown - measured).max() / measured.max()
        return Step(state.load_factor, measured, double(measured), criteria[0], centre[slides], error, fits)

    steps = tuple(step(*path.through([force, force * (1.0 + STEP)])) for force in forces)
    return Loading(measures.x, crossover, lattice[corners] - middle, steps)


def loaded_slabs(parameters: Parameters) -> xr.Dataset:
    """Dataset ``slabs``."""
    loaded = parameters.loaded
    scenes = [parameters.lattice.updated({"contact.friction": slab.friction}) for slab in loaded.slabs]
    tasks = {(k,): partial(respond, scenes[k], loaded, slab.forces) for k, slab in enumerate(loaded.slabs)}
    found = computed(tasks, "slabs")
    steps = parts(found, "steps")
    fits = {(*at, *place): fit for at, step in steps.items() for place, fit in step.fits.items()}
    slab = table(found, "slab")
    slab["corners"] = slab["corners"].isel(slab=0)
    tables = (slab, table(steps, "slab", "step"), table(fits, "slab", "step", "width", "loads"))
    coordinates = axes(
        width=(loaded.widths, f"w of the Gaussian over which fields are averaged {RADII}"),
        loads=(LOADS, "small loads to which moduli are fitted"),
        axis=("xz", "component"),
    )
    friction = labels(
        "slab", loaded.slabs, friction="coefficient of friction between disks", shown=f"force of the map {WEIGHTS}"
    )
    return xr.merge(tables).assign_coords(coordinates | friction)
