"""What rolling resistance changes (Secs. V.F and VIII): piles without support, a slab's response, couple stresses.

``thresholds`` has the least friction that holds a pile on a flat floor, whose sides nothing supports, and that below
which no forces balance whatever the preparation. ``piles`` are those of the paper's friction. ``slabs`` has the
response of a slab and how a Cosserat solid fits its couple stress, ``torques`` the same of a torque on the loaded disk,
whose couples go down line by line between the rows.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import xarray as xr
from scipy.optimize import linprog
from scipy.sparse import block_array, csr_array, diags_array, eye_array
from scipy.spatial import cKDTree

from granular_response.observe.floor import floor_force
from granular_response.observe.peaks import central_dip
from granular_response.scene import PilePacking, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import NotSettled
from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.studies import bisect_event
from granular_response.sweeps.rest import rest_state
from granular_response_extensions.rolling_resistance.parameters import Parameters
from granular_response_extensions.rolling_resistance.simulate.couples import respond
from granular_response_paper.datasets import labelled
from granular_response_paper.records import axes, column, parts, places, record, table, table_along
from granular_response_paper.tasks import computed

CASES = ("supported", "free", "resisting")


@record
class RestingPile:
    """A pile that has come to rest."""

    moved: float = column(f"largest displacement of a disk on the way to rest {RADII}")
    loose_disks: float = column("disks that have fewer than two contacts when the others have come to rest")
    floor_dip: float = column(
        "how far the floor force under the apex is below the lower maximum beside it, per largest"
    )
    x: FloatArray = column(f"position of the lowest disks before gravity acts, from the axis {RADII}", "floor_disk")
    floor_force: FloatArray = column(f"vertical floor force {WEIGHTS}", "floor_disk")


@record
class Threshold(RestingPile):
    """The least friction that holds a pile, between two that were tried; and the pile that the larger one holds."""

    low: float = column("largest coefficient of friction that was seen not to hold the pile; 0 for none")
    high: float = column("least one that was seen to hold it; nan for none")


def standing(scene: Scene, layers: int, friction: float, rolling: float | None, ramp: float = 0.0) -> Scene:
    """The pile on a floor wider by a radius for each layer at each side; with ``rolling`` None between its walls."""
    supported = scene.updated({"packing.layers": layers})
    if rolling is None:
        return supported
    packing = supported.packing.build()
    x, room = packing.position[:, 0] + layers, packing.width + 2.0 * layers
    alone = Scene.from_arrays(x, packing.position[:, 1], packing.radius, width=room, scene=scene)
    rough = {f"{at}.friction": friction for at in ("contact", "wall")}
    rolls = {f"{at}.rolling_friction": rolling for at in ("contact", "wall")}
    slow = {"preparation.gravity": "slow", "preparation.ramp_time": ramp} if ramp else {}
    return alone.updated(rough | rolls | slow)


def settle(scene: Scene) -> RestingPile:
    """The pile at rest; raises what ``rest_state`` raises."""
    problem = Problem.from_scene(scene)
    rest, start = rest_state(problem), problem.packing.position
    bottom = np.flatnonzero(start[:, 1] < start[:, 1].min() + 0.5)
    force, x = floor_force(rest, bottom), start[bottom, 0] - 0.5 * problem.packing.width
    moved, loose = np.linalg.norm(rest.position - start, axis=1).max(), (rest.contact_count() < 2).sum()
    return RestingPile(float(moved), float(loose), central_dip(x, force), x, force)


def threshold(parameters: Parameters, layers: int, rolling: float, ramp: float) -> Threshold:
    """Halves the range of friction. A pile that finds no stable equilibrium is not held."""

    @cache
    def held(friction: float) -> RestingPile | None:
        try:
            pile = settle(standing(parameters.pile, layers, friction, rolling, ramp))
        except NotSettled:
            return None
        return pile if pile.moved <= parameters.moved else None

    least, most = parameters.least_friction, parameters.most_friction
    if held(most) is None:
        nan = float("nan")
        return Threshold(nan, nan, nan, np.empty(0), np.empty(0), most, nan)
    found = bisect_event(lambda mu: held(mu) is not None, least, most, parameters.tolerance, at_low=False, at_high=True)
    return Threshold(**vars(held(found.high)), low=found.low if found.low > least else 0.0, high=found.high)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``thresholds``, ``piles``, ``slabs`` and ``torques``."""
    p, pile, rolling = parameters, parameters.pile, parameters.rolling_frictions
    tries = {place: partial(threshold, p, *one) for place, one in places(p.layers, rolling, p.ramps)}
    most, within = p.most_friction, 0.25 * p.tolerance
    balances = {at: partial(balanced, size, mu, most, within) for at, (size, mu) in places(p.layers, rolling)}
    own, kinds = pile.contact.friction, (None, min(rolling), max(rolling))
    cases = {at: partial(settle, standing(pile, size, own, mu)) for at, (size, mu) in places(p.layers, kinds)}
    slabs = {place: partial(respond, p, *one) for place, one in places(p.slab_frictions, p.slab_rolling_frictions)}
    held = table(computed(tries, "tries", work=lambda place: place[0]), "layers", "rolling_friction", "ramp")
    least = table(computed(balances, "balances", work=lambda place: place[0]), "layers", "rolling_friction")
    settled, found = computed(cases, "piles"), computed(slabs, "slabs")
    sizes = {"layers": (p.layers, "number of layers")}
    of_piles = sizes | {
        "rolling_friction": (rolling, "coefficient of rolling friction"),
        "ramp": (p.ramps, "time over which gravity grows, in sqrt(R/g); 0: at once"),
    }
    sides = "with side walls; without; without, and with the largest rolling friction"
    of_slabs = {
        "friction": (p.slab_frictions, "coefficient of friction between disks"),
        "rolling_friction": (p.slab_rolling_frictions, "coefficient of rolling friction between disks"),
    }
    torque = p.torques, "torque in mean disk weights times mean radius, counter-clockwise"
    loaded = axes(**of_slabs, load=(p.slab_forces, f"force {WEIGHTS}"))
    of_pile = {
        "thresholds": held.merge(least).assign_coords(axes(**of_piles)),
        "piles": table_along(settled, **sizes, case=(CASES, sides)),
    }
    of_slab = {
        "slabs": table(found, *of_slabs).merge(table(parts(found, "loaded"), *of_slabs, "load")).assign_coords(loaded),
        "torques": table_along(parts(found, "turned"), **of_slabs, torque=torque),
    }
    return labelled(of_pile, pile) | labelled(of_slab, p.base)


@record
class Balance:
    balance: float = column("largest coefficient of friction that was seen to let no forces balance")


def balanced(layers: int, rolling: float, most: float, tolerance: float) -> Balance:
    """Friction, up to ``most``, with which no forces balance the weights of the pile of equal disks as it is placed.

    Normal forces that press, tangential and rolling ones within their limits, at all neighbours and the floor: a linear
    program, which knows neither stiffness nor preparation. No such pile can be at rest below it.
    """
    packing = PilePacking(layers=layers).build()
    pairs = cKDTree(packing.position).query_pairs(2.0 + 1e-6, output_type="ndarray")
    floor, n, p = np.flatnonzero(packing.row == 0), packing.n, len(pairs)
    first, second, m = np.concatenate([pairs[:, 0], floor]), pairs[:, 1], p + len(floor)
    normal = np.tile([0.0, 1.0], (m, 1))
    normal[:p] = 0.5 * (packing.position[first[:p]] - packing.position[second])
    on_first = csr_array((np.ones(m), (first, np.arange(m))), (n, m))
    on_second = csr_array((np.ones(p), (second, np.arange(p))), (n, m))
    apart, one = on_first - on_second, eye_array(m)
    x, z, arm = (diags_array(along) for along in (*normal.T, np.where(np.arange(m) < p, 0.5, 1.0)))
    # forces along x, along z, and turns of the disks by normal, tangential and rolling forces
    equations = block_array(
        [[apart @ x, -apart @ z, None], [apart @ z, apart @ x, None], [None, -on_first - on_second, apart @ arm]]
    )
    weight, bounds = np.repeat([0.0, 1.0, 0.0], n), [(0.0, None)] * m + [(None, None)] * (2 * m)

    def possible(friction: float) -> bool:
        tangential = [[-friction * one, sign * one, None] for sign in (1.0, -1.0)]
        limits = block_array(tangential + [[-rolling * one, None, sign * one] for sign in (1.0, -1.0)])
        found = linprog(np.zeros(3 * m), limits, np.zeros(4 * m), equations, weight, bounds, method="highs")
        return int(found.status) == 0

    return Balance(bisect_event(possible, 0.0, most, tolerance, at_low=False, at_high=True).low)
