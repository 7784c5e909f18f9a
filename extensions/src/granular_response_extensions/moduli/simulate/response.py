"""Moduli of a packing, its floor response to small loads, and that of the elastic slab with these moduli."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_response.observe.floor import floor_disks, smoothed_response
from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import influence
from granular_response.solvers.strain import FOLLOWING, strained
from granular_response.state import FloatArray, State
from granular_response.sweeps.rest import rest_state
from granular_response.theory.moduli import Moduli, bulk_and_shear
from granular_response.theory.slab import Floor, Slab
from granular_response_paper.records import column, record

#: Places at which responses are compared, in heights of the slab from the load.
PLACES = np.linspace(-1.5, 1.5, 121)

#: What slabs are made of: moduli as disks follow the strain, and the isotropic solid nearest to the last ones.
SOLIDS = (*FOLLOWING, "isotropic")

_PLACES = ("smoothing", "place")


@record
class PackingModuli:
    response: FloatArray = column("mean floor pressure times height per force", *_PLACES)
    predicted: FloatArray = column(
        "floor pressure times height per force of the elastic slab with these moduli", "solid", *_PLACES
    )  #: nan without one
    difference: FloatArray = column(
        "largest difference of the mean over loads to the slab per largest pressure of the slab", "solid", "smoothing"
    )


def symmetric(matrix: FloatArray) -> FloatArray:
    """(..., 4) moduli a, b, c, d of stress per strain (..., 3, 3): what a solid that mirrors itself has of it."""
    mixed = 0.5 * (matrix[..., 0, 1] + matrix[..., 1, 0])
    return np.stack([matrix[..., 0, 0], matrix[..., 1, 1], mixed, matrix[..., 2, 2]], axis=-1)


def nearest_isotropic(moduli: FloatArray) -> FloatArray:
    """(4,) moduli of the isotropic solid with the mean energy that ``moduli`` (4,) have over all directions."""
    bulk, shear = bulk_and_shear(*moduli)
    return np.array([bulk + shear, bulk + shear, bulk - shear, 2.0 * shear])


def slab_height(rest: State, packing: Packing) -> float:
    """Of the elastic slab: distance of rows times their number (``sqrt(3) layers`` in a lattice of radius 1)."""
    z, rows = rest.position[:, 1], int(packing.row.max())
    return float((z[packing.row == rows].mean() - z[packing.row == 0].mean()) * (rows + 1) / rows)


def on_floor(problem: Problem, rest: State) -> tuple[NDArray[np.intp], FloatArray]:
    """Floor disks (k,), and the vertical forces (k, n) on them that unit forces downwards on one disk each add."""
    disks = floor_disks([rest], np.flatnonzero(problem.packing.row == 0))
    return disks, -influence(problem, rest, disks, sliding="stick")[:, :, 1]


def responses(problem: Problem, rest: State, height: float, widths: FloatArray) -> FloatArray:
    """(load, width, place) smoothed floor responses to small forces on the disks of the top row, times height."""
    disks, found = on_floor(problem, rest)
    row, period, result = problem.packing.row, problem.packing.width, []
    for disk in np.flatnonzero((row == row.max()) & (rest.contact_count() >= 2)):
        x = rest.position[disks, 0] - rest.position[disk, 0]
        x -= period * np.round(x / period)
        around, forces = np.concatenate([x - period, x, x + period]), np.tile(found[:, disk], 3)
        result.append([smoothed_response(PLACES * height, around, forces, width) * height for width in widths])
    return np.array(result)


def prediction(moduli: FloatArray, height: float, period: float, floor: Floor, widths: FloatArray) -> FloatArray:
    """(width, place) what :func:`responses` are in the elastic slab; nan for moduli (4,) of no stable solid.

    With a force half-way between smooth walls all is as with periodic sides: mirror images take the place of copies.
    """
    try:
        slab = Slab(height, Moduli(*moduli), floor, period)
    except ValueError:
        return np.full((len(widths), len(PLACES)), np.nan)
    x = PLACES * height - period * np.round(PLACES * height / period)
    # the Gaussian of a smoothed response has a standard deviation of w / sqrt(2)
    return np.stack([-height * slab.stress(x, 0.0, 1.0, width / np.sqrt(2.0))[1] for width in widths])


def apart(one: FloatArray, other: FloatArray) -> FloatArray:
    """(...) largest difference over the places of two responses (..., place) per largest value of the ``other``."""
    return np.asarray(np.abs(one - other).max(axis=-1) / other.max(axis=-1))


def compute(scene: Scene, margin: float, width: float, wide: float) -> PackingModuli:
    """One disordered packing, with responses smoothed over ``width`` radii and ``wide`` heights.

    Raises what ``rest_state`` raises.
    """
    problem = Problem.from_scene(scene)
    rest = rest_state(problem)
    period = problem.packing.width
    matrices = np.stack([strained(problem, rest, how, margin=margin).moduli for how in FOLLOWING]) / problem.stiffness
    height = slab_height(rest, problem.packing)
    widths = np.array([width, wide * height])
    floor: Floor = "rough" if problem.wall_friction else "smooth"
    mean, solids = responses(problem, rest, height, widths).mean(axis=0), symmetric(matrices)
    solids = np.stack([*solids, nearest_isotropic(solids[-1])])
    predicted = np.stack([prediction(solid, height, period, floor, widths) for solid in solids])
    return PackingModuli(mean, predicted, apart(mean, predicted))
