"""Elastic moduli of packings from their own stiffness, and the response of the elastic slab that they predict.

A packing at rest is strained as a whole (``solvers.strain``): disks follow the strain (affine), or relax with rotations
suppressed or free. The last moduli are those of the packing, and the elastic slab (``theory.slab``) of the same height
and width with them has a response to a small force on its top with nothing to fit. The packing's own response to small
forces on each disk of the top row is exact in the limit (``solvers.small_loads``); periodic sides make all of them
comparable. ``packings`` has both and what they differ by: for single loads, and for the mean over the loads of a
packing. ``lattice`` has the moduli of lattices beside the closed form, and where the response turns from one peak to
two by the closed form's moduli, by measured ones, and in lattices themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.floor import floor_disks, smoothed_response
from granular_response.scene import Packing, Scene
from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import at_limit, influence
from granular_response.solvers.strain import FOLLOWING, strained
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII
from granular_response.sweeps.rest import rest_state
from granular_response.theory import crossover, lattice
from granular_response.theory.crossover import Body
from granular_response.theory.lattice import Rotations, Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Floor, Slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.moduli.parameters import Parameters
from granular_response_paper.parameters import material
from granular_response_paper.records import axes, column, labels, places, record, stacked, table, variables
from granular_response_paper.survey.crossover import CONFIDENCE
from granular_response_paper.survey.packings import measured
from granular_response_paper.tasks import computed

#: Places at which responses are compared, in heights of the slab from the load.
PLACES = np.linspace(-1.5, 1.5, 121)

#: Disks per row of a lattice that is strained: by symmetry all of a row do the same.
NARROW = 6

#: What slabs are made of: moduli as disks follow the strain, and the isotropic solid nearest to the last ones.
SOLIDS = (*FOLLOWING, "isotropic")

#: How many times the largest size a power is believed at most.
FARTHEST = 100.0

#: Bodies and rotations of the theory's turns from two peaks to one.
BODIES: tuple[Body, ...] = ("half plane", "smooth floor")
ROTATIONS: tuple[Rotations, ...] = ("free", "suppressed")


def symmetric(matrix: FloatArray) -> FloatArray:
    """(..., 4) moduli a, b, c, d of stress per strain (..., 3, 3): what a solid that mirrors itself has of it."""
    mixed = 0.5 * (matrix[..., 0, 1] + matrix[..., 1, 0])
    return np.stack([matrix[..., 0, 0], matrix[..., 1, 1], mixed, matrix[..., 2, 2]], axis=-1)


def nearest_isotropic(moduli: FloatArray) -> FloatArray:
    """(4,) moduli of the isotropic solid with the mean energy that ``moduli`` (4,) have over all directions."""
    a, b, c, d = moduli
    bulk, shear = 0.25 * (a + b + 2.0 * c), 0.125 * (a + b - 2.0 * c) + 0.25 * d
    return np.array([bulk + shear, bulk + shear, bulk - shear, 2.0 * shear])


FRICTION = "friction between disks and of the floor"


@record
class Disordered:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column(FRICTION)
    layers: int = column("number of rows")
    realization: int = column("realization of the disorder")


_PLACES = ("smoothing", "place")
_PER = "per largest pressure of the slab"


@record
class Outcome:
    height: float = column(f"height of the slab {RADII}")  #: distance of the rows times their number
    coordination: float = column("contacts per disk that bears something")  #: floor included
    at_limit: float = column("contacts at the Coulomb limit, taken to stick")
    matrices: FloatArray = column("stress per strain over k_N, as measured", "following", "stress", "strain")
    springs_alone: FloatArray = column(
        "the last of these without the forces that contacts bear at rest", "stress", "strain"
    )
    response: FloatArray = column("mean floor pressure times height per force", *_PLACES)
    predicted: FloatArray = column(
        "floor pressure times height per force of the elastic slab with these moduli", "solid", *_PLACES
    )  #: nan without one
    single: FloatArray = column(f"largest difference of one load to the slab {_PER}, mean", "smoothing")
    difference: FloatArray = column(
        f"largest difference of the mean over loads to the slab {_PER}", "solid", "smoothing"
    )


def compute(scene: Scene, margin: float, width: float, wide: float) -> Outcome:
    """One disordered packing, with responses smoothed over ``width`` radii and ``wide`` heights.

    Raises what ``rest_state`` raises.
    """
    problem = Problem.from_scene(scene)
    rest = rest_state(problem)
    count, period, stiffness = rest.contact_count(), problem.packing.width, problem.stiffness
    matrices = np.stack([strained(problem, rest, how, margin=margin).moduli for how in FOLLOWING]) / stiffness
    alone = strained(problem, rest, "free", margin=margin, prestress=False).moduli / stiffness
    height = slab_height(rest, problem.packing)
    widths = np.array([width, wide * height])
    floor: Floor = "rough" if problem.wall_friction else "smooth"
    each, solids = responses(problem, rest, height, widths), symmetric(matrices)
    mean = each.mean(axis=0)
    solids = np.stack([*solids, nearest_isotropic(solids[-1])])
    predicted = np.stack([prediction(solid, height, period, floor, widths) for solid in solids])
    return Outcome(
        height, float(count[count >= 2].mean()), at_limit(problem, rest), matrices, alone, mean, predicted,
        apart(each, predicted[SOLIDS.index("free")]).mean(axis=0), apart(mean, predicted),
    )  # fmt: skip


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


def apart(found: FloatArray, predicted: FloatArray) -> FloatArray:
    """(...) largest difference over the places of two (..., place) per largest prediction."""
    return np.abs(found - predicted).max(axis=-1) / predicted.max(axis=-1)


def lattice_moduli(scene: Scene, margin: float) -> FloatArray:
    """(following, 4) moduli over k_N of a lattice."""
    problem = Problem.from_scene(scene)
    rest = rest_state(problem)
    found = [strained(problem, rest, how, margin=margin, prestress=False).moduli for how in FOLLOWING]
    return symmetric(np.stack(found)) / problem.stiffness


def middle_curvature(scene: Scene) -> FloatArray:
    """() second difference of a lattice's response on the floor disks beside that below the load, per largest."""
    problem = Problem.from_scene(scene)
    rest, packing = rest_state(problem), problem.packing
    disks, found = on_floor(problem, rest)
    top = packing.n - packing.row_count[-1] + packing.row_count[-1] // 2
    below = int(np.argmin(np.abs(rest.position[disks, 0] - rest.position[top, 0])))
    left, middle, right = found[below - 1 : below + 2, top]
    return np.asarray((left - 2.0 * middle + right) / found[:, top].max())


def root(x: FloatArray, y: FloatArray) -> float:
    """Where ``y`` changes its sign first, on the cubic through the four points around it; nan where it does not."""
    change = np.flatnonzero(np.sign(y[1:]) != np.sign(y[:-1]))
    if not change.size:
        return float("nan")
    first = int(np.clip(change[0] - 1, 0, max(len(x) - 4, 0)))
    # x as a function of y: monotonous where a sign changes once
    u, v = y[first : first + 4], x[first : first + 4]
    others = [np.delete(u, i) for i in range(len(u))]
    return float(sum(v * [np.prod(-other / (one - other)) for one, other in zip(u, others, strict=True)]))


def at_infinity(layers: FloatArray, values: FloatArray) -> FloatArray:
    """(estimate,) what ``values`` (size,) tend to: a line in 1 / layers through the two largest, or a parabola.

    NaN where there are not as many.
    """
    order = np.argsort(-layers)
    inverse, values = 1.0 / layers[order], values[order]
    return np.array([np.polyfit(inverse[:k], values[:k], k - 1)[-1] if len(order) >= k else np.nan for k in (2, 3)])


def needed(layers: FloatArray, difference: FloatArray, tolerances: FloatArray, draws: int, seed: int) -> FloatArray:
    """(tolerance, 3) layers from which on the difference is below a tolerance, and the 95 % interval of that.

    A power of the number of ``layers`` (size,) goes through the means of ``difference`` (size, realization); the
    interval is that of ``draws`` bootstrap draws over the realizations of each size. Infinite beyond ``FARTHEST`` times
    the largest size, and where the power does not fall; all nan with less than two sizes of three realizations.
    """
    enough = np.isfinite(difference).sum(axis=1) >= 3
    if enough.sum() < 2:
        return np.full((len(tolerances), 3), np.nan)
    generator, layers = np.random.default_rng(seed), layers[enough]
    each = [one[np.isfinite(one)] for one in difference[enough]]
    drawn = [np.append(one.mean(), one[generator.integers(0, one.size, (draws, one.size))].mean(1)) for one in each]
    slope, offset = np.polyfit(np.log(layers), np.log(np.stack(drawn)), 1)
    # logarithm of the size, at most that of FARTHEST, beyond which it counts as infinite; flat is infinite too
    farthest = np.log(FARTHEST * layers.max())
    flat = slope > -1e-2
    place = np.where(flat, np.inf, (np.log(tolerances)[:, None] - offset) / np.where(flat, -1.0, slope))
    size = np.where(place > farthest, np.inf, np.exp(np.minimum(place, farthest)))
    low, high = np.quantile(size[:, 1:], CONFIDENCE, axis=1, method="nearest")
    return np.stack([size[:, 0], low, high], axis=1)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``packings`` and ``lattice``."""
    return labelled({"packings": _packings(parameters), "lattice": _lattices(parameters)}, parameters.base)


def packings(parameters: Parameters, *, surveyed: bool) -> dict[tuple[int, int, int], Disordered]:
    """The packings of the survey, or all others, by their places: of the case, of its size, and the realization."""
    return {
        (c, s, r): Disordered(case.polydispersity, case.friction, case.layers[s], r)
        for c, case in enumerate(parameters.cases)
        for s, (own, further) in enumerate(zip(case.realizations, case.further, strict=True))
        for r in (range(own, own + further) if surveyed else range(own))
    }


def _slab(parameters: Parameters, layers: int, disks_per_row: int, spacing: float | str, others: Mapping) -> Scene:
    """The base scene with periodic sides, of this size and lattice constant, with ``others`` changed."""
    size = {"packing.sides": "periodic", "packing.layers": layers, "packing.disks_per_row": disks_per_row}
    return parameters.base.updated({**size, "packing.lattice_constant": spacing, **others})


def task(parameters: Parameters, one: Disordered) -> partial[Outcome]:
    """One of these packings."""
    p, changes = parameters, material(one.polydispersity, one.realization, one.friction)
    scene = _slab(p, one.layers, p.disks_per_layer * one.layers, TOUCHING_LARGEST, changes)
    return partial(compute, scene, p.margin, p.width, p.wide)


def _packings(parameters: Parameters) -> xr.Dataset:
    cases = parameters.cases
    # the largest first: two workers then end together
    outcomes = measured(parameters, "packings", packings, task, Outcome, work=lambda at: cases[at[0]].layers[at[1]])
    found = table(outcomes, "case", "size", "realization").rename(matrices="stiffness")
    layers = stacked({(c,): case.layers for c, case in enumerate(cases)}, float)
    surveyed = np.nan_to_num(stacked({(c,): case.further for c, case in enumerate(cases)}, float))
    loads = {"one": found["single"].values, "mean": found["difference"].values[:, :, :, SOLIDS.index("free")]}
    differences = np.moveaxis(np.stack(list(loads.values())), (1, 0, 4), (0, 1, 2))
    tolerances = np.array(parameters.tolerances)
    sizes_needed = {
        at: needed(layers[at[0]], differences[at], tolerances, parameters.draws, parameters.seed)
        for at in np.ndindex(differences.shape[:3])
    }
    matrices = found["stiffness"].values
    prestress = symmetric(matrices[..., -1, :, :] - found["springs_alone"].values)
    mirrored = "moduli over k_N, what a solid that mirrors itself has of them"
    added = "what the forces that contacts bear at rest add to the moduli over k_N, rotations free"
    below = "number of rows from which on the difference is below the tolerance, by a power of it"
    derived = variables(
        layers=("case size", layers, "number of rows"),
        surveyed=("case size", surveyed, "realizations that are the survey's"),
        moduli=("case size realization following modulus", symmetric(matrices), mirrored),
        prestress=("case size realization modulus", prestress, added),
        needed=("case loads smoothing tolerance end", stacked(sizes_needed), below),
    )
    components = ["xx", "zz", "xz"]
    coordinates = axes(
        following=(FOLLOWING, "how displacements and rotations follow the strain"),
        solid=(SOLIDS, "moduli of the elastic slab"),
        modulus=("abcd", "modulus of eq. (6)"),
        stress=(components, "component of the stress"),
        strain=(components, "component of the strain"),
        smoothing=([f"{parameters.width:g} radii", f"{parameters.wide:.3g} heights"], "w of the Gaussian"),
        loads=(loads, "one load, or the mean over the loads of a packing"),
        tolerance=(tolerances, "difference to the elastic slab"),
        end=(["value", "low", "high"], "value, and the 95 % interval of the bootstrap"),
        place=(PLACES, "distance from the load over the height of the slab"),
    )
    named = labels("case", cases, polydispersity="polydispersity", friction=FRICTION)
    return found.drop_vars("springs_alone").assign(derived).assign_coords(named | coordinates)


def _lattices(parameters: Parameters) -> xr.Dataset:
    p, group = parameters, parameters.lattice
    ratios, near = np.array(group.stiffness_ratios), np.array(group.responding_ratios)

    def scene(spacing: float, layers: int, row: int, ratio: float) -> Scene:
        springs = {"contact.friction": group.friction, "contact.stiffness_ratio": ratio, "wall.friction": 0.0}
        return _slab(p, layers, row, spacing, springs)

    strains = {
        at: partial(lattice_moduli, scene(spacing, group.layers, NARROW, ratio), p.margin)
        for at, (spacing, ratio) in places((group.closed, group.open), group.stiffness_ratios)
    }
    loads = {
        at: partial(middle_curvature, scene(group.open, layers, p.disks_per_layer * layers, ratio))
        for at, (layers, ratio) in places(group.responding, group.responding_ratios)
    }
    own, bends = stacked(computed(strains, "strained lattices")), stacked(computed(loads, "loaded lattices"))
    expected = {
        place: astuple(lattice.moduli(Springs(closed, 1.0, closed * ratio, ratio), rotations))
        for place, (closed, ratio, rotations) in places((1.0, 0.0), ratios, ROTATIONS)
    }

    def turn(body: Body, rotations: Rotations) -> float:
        solids = [Moduli(*m) for m in own[1, :, FOLLOWING.index(rotations)]]
        if body == "half plane":
            return root(ratios, np.array([-solid.peak_criterion for solid in solids]))
        return root(ratios, np.array([Slab(1.0, solid, "smooth").curvature_below_force() for solid in solids]))

    turns = [[turn(body, rotations) for rotations in ROTATIONS] for body in BODIES]
    theory = [[crossover.stiffness_ratio(body, rotations) for rotations in ROTATIONS] for body in BODIES]
    found = np.array([root(near, bend) for bend in bends])
    limits = at_infinity(np.array(group.responding), found)
    bend = "second difference of the response below the load, per largest response"
    limit = "the same for infinitely many layers, from these by polynomials in 1 / layers"
    return xr.Dataset(
        variables(
            moduli=("contacts stiffness_ratio following modulus", own, "moduli over k_N, as measured"),
            closed_form=(
                "contacts stiffness_ratio rotations modulus",
                stacked(expected),
                "moduli over k_N, eqs. (7)-(10)",
            ),
            turn=("body rotations", turns, "k_T / k_N at which two peaks end, by measured moduli"),
            turn_closed_form=("body rotations", theory, "the same by the closed form"),
            middle=("size responding_ratio", bends, bend),
            turn_response=("size", found, "k_T / k_N at which it changes its sign"),
            turn_limit=("estimate", limits, limit),
            layers=("size", group.responding, "number of rows of the lattices that respond"),
        ),
        coords=axes(
            contacts=(["closed", "open"], "horizontal contacts"),
            stiffness_ratio=(ratios, "k_T / k_N"),
            responding_ratio=(near, "k_T / k_N"),
            following=(FOLLOWING, "how displacements and rotations follow the strain"),
            rotations=(ROTATIONS, "rotations of the disks"),
            modulus=("abcd", "modulus of eq. (6)"),
            body=(BODIES, "elastic body"),
            estimate=(("line", "parabola"), "polynomial in 1 / layers"),
        ),
    )
