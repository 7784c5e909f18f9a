"""What rolling resistance changes (Secs. V.F and VIII): piles without support, a slab's response, couple stresses.

``thresholds`` has the least friction that holds a pile on a flat floor, whose sides nothing supports, for each rolling
friction; ``piles`` the piles of the paper's friction with and without support; ``slabs`` the response of a slab and
what its contacts hand on of forces and couples.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response.observe import stress as coarse
from granular_response.observe.floor import floor_force
from granular_response.observe.peaks import central_dip
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import NotSettled
from granular_response.solvers.small_loads import influence
from granular_response.state import FloatArray
from granular_response.store.result import FORCE, LENGTH
from granular_response.sweeps.rest import rest_state
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.rolling.parameters import Parameters
from granular_response_paper.records import axes, column, record, table
from granular_response_paper.slab_response import TWO_PEAKS, Happening, LoadPath, Measures, first_opening
from granular_response_paper.tasks import computed

CASES = ("supported", "free", "resisting")


@record
class Pile:
    """A pile that has come to rest."""

    moved: float = column(f"largest displacement of a disk on the way to rest {LENGTH}")
    floor_dip: float = column(
        "how far the floor force under the apex is below the lower maximum beside it, per largest"
    )
    x: FloatArray = column(f"position of the lowest disks before gravity acts, from the axis {LENGTH}", "floor_disk")
    floor_force: FloatArray = column(f"vertical floor force {FORCE}", "floor_disk")


@record
class Threshold(Pile):
    """The least friction that holds a pile, between two that were tried; and the pile that the larger one holds."""

    low: float = column("largest coefficient of friction that was seen not to hold the pile; 0 for none")
    high: float = column("least one that was seen to hold it; nan for none")


def unsupported(scene: Scene, layers: int, friction: float, rolling: float) -> Scene:
    """The pile on a floor that goes on at both sides, by its number of layers in radii, with the same coefficients of friction everywhere."""
    packing = scene.updated({"packing.layers": layers}).packing.build()
    x, room = packing.position[:, 0] + layers, packing.width + 2.0 * layers
    alone = Scene.from_arrays(x, packing.position[:, 1], packing.radius, width=room, scene=scene)
    rolls = {"contact.rolling_friction": rolling, "wall.rolling_friction": rolling}
    return alone.updated({"contact.friction": friction, "wall.friction": friction, **rolls})


def settle(scene: Scene) -> Pile:
    """The pile at rest; raises what ``rest_state`` raises."""
    problem = Problem.from_scene(scene)
    rest, start = rest_state(problem), problem.packing.position
    bottom = np.flatnonzero(start[:, 1] < start[:, 1].min() + 0.5)
    force, x = floor_force(rest, bottom), start[bottom, 0] - 0.5 * problem.packing.width
    return Pile(float(np.linalg.norm(rest.position - start, axis=1).max()), central_dip(x, force), x, force)


def threshold(parameters: Parameters, layers: int, rolling: float) -> Threshold:
    """Halves the range of friction. A pile that finds no stable equilibrium is not held."""

    def held(friction: float) -> Pile | None:
        try:
            pile = settle(unsupported(parameters.pile, layers, friction, rolling))
        except NotSettled:
            return None
        return pile if pile.moved <= parameters.moved else None

    low, high = parameters.least_friction, parameters.most_friction
    if (last := held(high)) is None:
        return Threshold(float("nan"), float("nan"), np.empty(0), np.empty(0), high, float("nan"))
    while high - low > parameters.tolerance:
        middle = 0.5 * (low + high)
        if pile := held(middle):
            high, last = middle, pile
        else:
            low = middle
    return Threshold(**vars(last), low=low if low > parameters.least_friction else 0.0, high=high)


@record
class Slab:
    """A slab under a growing force."""

    x: FloatArray = column(f"position from the loaded disk {LENGTH}", "floor_disk")
    elastic_response: FloatArray = column(
        "floor response to a small load, all contacts sticking, per applied force", "floor_disk"
    )
    floor_response: FloatArray = column("floor response under the force that is shown, per force", "floor_disk")
    opening: FloatArray = column(f"force of the first opening, before and after {FORCE}", "end")
    crossover: FloatArray = column(f"force from which on there are two peaks, before and after {FORCE}", "end")
    couple_stress: FloatArray = column("largest couple stress at a height under that force, in weights", "z")
    antisymmetric: FloatArray = column("largest antisymmetric part of the stress there, in weights per radius", "z")
    vertical_stress: FloatArray = column("largest vertical stress there, in weights per mean radius", "z")


def respond(scene: Scene, forces: tuple[float, ...], shown: float, width: float, heights: int) -> Slab:
    """``scene`` has one load, of unit force; stresses are those that the load adds. Raises what the solvers raise."""
    path = LoadPath.of(scene)
    measures = Measures(path)
    path.through(sorted({*forces, shown}))
    asked = first_opening(measures), Happening(measures.double_peaked, TWO_PEAKS)
    events = [np.array(path.first(forces, happening)) for happening in asked]
    elastic = -influence(path.problem, path.rest, measures.disks, sliding="stick")[:, measures.loaded_disk, 1]
    loaded, rest, radius = path.at(shown), path.rest, path.problem.packing.radius
    top = path.rest.position[measures.loaded_disk]
    points = coarse.grid_points(top[0] + measures.x, np.linspace(0.0, top[1], heights))
    stress = coarse.coarse_grained_stress(coarse.load_forces(rest, loaded), points, width)
    couples = coarse.couple_stress(loaded, radius, points, width) - coarse.couple_stress(rest, radius, points, width)
    fields = np.linalg.norm(couples, axis=-1), np.abs(coarse.antisymmetric_part(stress)), np.abs(stress[..., 1, 1])
    return Slab(measures.x, elastic, measures.response(loaded), *events, *(field.max(axis=1) for field in fields))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``thresholds``, ``piles`` and ``slabs``."""
    p, pile, rolling = parameters, parameters.pile, parameters.rolling_frictions
    tries, piles, slabs = {}, {}, {}
    for n, size in enumerate(p.layers):
        tries |= {(n, k): partial(threshold, p, size, mu) for k, mu in enumerate(rolling)}
        scenes = [pile.updated({"packing.layers": size})]
        scenes += [unsupported(pile, size, pile.contact.friction, mu) for mu in (min(rolling), max(rolling))]
        piles |= {(n, k): partial(settle, scene) for k, scene in enumerate(scenes)}
    for n, slab in enumerate(p.slabs):
        for k, mu in enumerate(p.slab_rolling_frictions):
            scene = p.base.updated({"contact.friction": slab.friction, "contact.rolling_friction": mu})
            slabs[n, k] = partial(respond, scene, slab.forces, p.shown_force, p.stress_width, p.heights)
    sizes = axes(layers=(p.layers, "number of layers"))
    cases = axes(case=(CASES, "with side walls; without; without, and with the largest rolling friction"))
    of_rolling = axes(rolling_friction=(rolling, "coefficient of rolling friction"))
    of_slabs = axes(
        friction=([slab.friction for slab in p.slabs], "coefficient of friction between disks"),
        rolling_friction=(p.slab_rolling_frictions, "coefficient of rolling friction between disks"),
        z=(np.linspace(0.0, 1.0, p.heights), "height above the floor per that of the loaded disk"),
    )
    found = {
        "thresholds": table(computed(tries, "tries"), "layers", "rolling_friction").assign_coords(sizes | of_rolling),
        "piles": table(computed(piles, "piles"), "layers", "case").assign_coords(sizes | cases),
    }
    responses = table(computed(slabs, "slabs"), "friction", "rolling_friction").assign_coords(of_slabs)
    return labelled(found, pile) | labelled({"slabs": responses}, p.base)
