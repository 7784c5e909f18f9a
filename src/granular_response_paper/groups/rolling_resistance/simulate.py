"""What rolling resistance changes (Secs. V.F and VIII): piles without support, a slab's response, couple stresses.

``thresholds`` has the least friction that holds a pile on a flat floor, whose sides nothing supports, and that below
which no forces balance whatever the preparation (:func:`balance`). ``piles`` are those of the paper's friction.
``slabs`` has the response of a slab and its couple stress m, fitted by that of a Cosserat solid, ``m = -B grad(turn)``.
Where the contacts of a lattice of equal disks stick, ``B = sqrt(3)/4 k_R`` and ``G = sqrt(3)/4 (k_N + k_T)``.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr
from scipy.optimize import linprog
from scipy.sparse import coo_array, eye_array, hstack, vstack
from scipy.spatial import cKDTree

from granular_response.observe import stress as coarse
from granular_response.observe.floor import floor_force
from granular_response.observe.peaks import central_dip
from granular_response.scene import PilePacking, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import NotSettled
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.rest import rest_state
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.rolling_resistance.parameters import Parameters
from granular_response_paper.records import axes, column, record, table
from granular_response_paper.slab_response import (
    TWO_PEAKS,
    Happening,
    LoadPath,
    Measures,
    first_opening,
    half_maximum_width,
)
from granular_response_paper.tasks import computed

CASES = ("supported", "free", "resisting")


@record
class Pile:
    """A pile that has come to rest."""

    moved: float = column(f"largest displacement of a disk on the way to rest {RADII}")
    floor_dip: float = column(
        "how far the floor force under the apex is below the lower maximum beside it, per largest"
    )
    x: FloatArray = column(f"position of the lowest disks before gravity acts, from the axis {RADII}", "floor_disk")
    floor_force: FloatArray = column(f"vertical floor force {WEIGHTS}", "floor_disk")


@record
class Threshold(Pile):
    """The least friction that holds a pile, between two that were tried; and the pile that the larger one holds."""

    low: float = column("largest coefficient of friction that was seen not to hold the pile; 0 for none")
    high: float = column("least one that was seen to hold it; nan for none")


@record
class Balance:
    """What :func:`balance` finds."""

    balance: float = column("largest coefficient of friction that was seen to let no forces balance")


def unsupported(scene: Scene, layers: int, friction: float, rolling: float, ramp: float = 0.0) -> Scene:
    """The pile on a floor that goes on at both sides by a radius for each layer; floor and disks have one friction."""
    packing = scene.updated({"packing.layers": layers}).packing.build()
    x, room = packing.position[:, 0] + layers, packing.width + 2.0 * layers
    alone = Scene.from_arrays(x, packing.position[:, 1], packing.radius, width=room, scene=scene)
    rough = {f"{at}.friction": friction for at in ("contact", "wall")}
    rolls = {f"{at}.rolling_friction": rolling for at in ("contact", "wall")}
    slow = {"preparation.gravity": "slow", "preparation.ramp_time": ramp} if ramp else {}
    return alone.updated(rough | rolls | slow)


def settle(scene: Scene) -> Pile:
    """The pile at rest; raises what ``rest_state`` raises."""
    problem = Problem.from_scene(scene)
    rest, start = rest_state(problem), problem.packing.position
    bottom = np.flatnonzero(start[:, 1] < start[:, 1].min() + 0.5)
    force, x = floor_force(rest, bottom), start[bottom, 0] - 0.5 * problem.packing.width
    return Pile(float(np.linalg.norm(rest.position - start, axis=1).max()), central_dip(x, force), x, force)


def threshold(parameters: Parameters, layers: int, rolling: float, ramp: float) -> Threshold:
    """Halves the range of friction. A pile that finds no stable equilibrium is not held."""

    def held(friction: float) -> Pile | None:
        try:
            pile = settle(unsupported(parameters.pile, layers, friction, rolling, ramp))
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


def balance(layers: int, rolling: float, most: float, tolerance: float) -> Balance:
    """Friction, up to ``most``, with which no forces balance the weights of the pile of equal disks as it is placed.

    Normal forces that press, tangential and rolling ones within their limits, at all neighbours and the floor: a linear
    program, which knows neither stiffness nor preparation. No such pile can be at rest below it.
    """
    packing = PilePacking(layers=layers).build()
    pairs = cKDTree(packing.position).query_pairs(2.0 + 1e-6, output_type="ndarray")
    floor, n = np.flatnonzero(packing.row == 0), packing.n
    first, second, p = np.concatenate([pairs[:, 0], floor]), pairs[:, 1], len(pairs)
    normal = np.tile([0.0, 1.0], (len(first), 1))
    normal[:p] = 0.5 * (packing.position[first[:p]] - packing.position[second])
    m, ones, arm = len(first), np.ones(len(first)), np.where(np.arange(len(first)) < p, 0.5, 1.0)
    # equation (x, z, turn), unknown (normal, tangential, rolling force), its part on the first disk, on the second
    terms = [
        (0, 0, normal[:, 0], -1.0), (1, 0, normal[:, 1], -1.0), (0, 1, -normal[:, 1], -1.0), (1, 1, normal[:, 0], -1.0),
        (2, 1, -ones, 1.0), (2, 2, arm, -1.0),
    ]  # fmt: skip
    value = np.concatenate([np.concatenate([on, sign * on[:p]]) for _, _, on, sign in terms])
    row = np.concatenate([k * n + np.concatenate([first, second]) for k, *_ in terms])
    place = np.concatenate([k * m + np.concatenate([np.arange(m), np.arange(p)]) for _, k, *_ in terms])
    equations = coo_array((value, (row, place)), shape=(3 * n, 3 * m)).tocsr()
    weight, one, none = np.repeat([0.0, 1.0, 0.0], n), eye_array(m), coo_array((m, m))

    def possible(friction: float) -> bool:
        limits = vstack(
            [hstack([-friction * one, sign * one, none]) for sign in (1.0, -1.0)]
            + [hstack([-rolling * one, none, sign * one]) for sign in (1.0, -1.0)]
        )
        bounds = [(0.0, None)] * m + [(None, None)] * (2 * m)
        found = linprog(np.zeros(3 * m), limits, np.zeros(4 * m), equations, weight, bounds, method="highs")
        return int(found.status) == 0

    low, high = 0.0, most
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if possible(middle) else (middle, high)
    return Balance(low)


@record
class Slab:
    """A slab under a growing force; along ``load`` under the small and the large force that are shown."""

    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    opening: FloatArray = column(f"force of the first opening, before and after {WEIGHTS}", "end")
    crossover: FloatArray = column(f"force from which on there are two peaks, before and after {WEIGHTS}", "end")
    floor_response: FloatArray = column("floor response per force", "load", "floor_disk")
    width: FloatArray = column(f"full width at half maximum of the floor response {RADII}", "load")
    couple_stress: FloatArray = column("largest couple stress of the load at a height, in weights", "load", "z")
    vertical_stress: FloatArray = column("largest vertical stress of it there, in weights per radius", "load", "z")
    modulus: FloatArray = column("couple stress per gradient of the rotation, in k_N times radii squared", "load")
    unexplained: FloatArray = column("part of the squares of the couple stress that this modulus leaves", "load")
    length: FloatArray = column(f"Cosserat length sqrt(B / 4 G) with the lattice's shear modulus {RADII}", "load")
    moment_error: FloatArray = column("largest lack of the couples across a vertical line, per largest couple", "load")


def respond(scene: Scene, forces: tuple[float, ...], shown: tuple[float, float], width: float, heights: int) -> Slab:
    """``scene`` has one load, of unit force; stresses are those that the load adds. Raises what the solvers raise."""
    path = LoadPath.of(scene)
    measures, contact = Measures(path), scene.contact
    path.through(sorted({*forces, *shown}))
    asked = first_opening(measures), Happening(measures.double_peaked, TWO_PEAKS)
    events = [np.array(path.first(forces, happening)) for happening in asked]
    rest, radius, top = path.rest, path.problem.packing.radius, path.rest.position[measures.loaded_disk]
    lines = coarse.grid_points(top[0] + measures.x, np.linspace(0.0, top[1], heights))
    step = 0.5 * width
    inner = coarse.grid_points(top[0] + measures.x[measures.interior], np.arange(width, top[1] - width, step))
    found = []
    for loaded in map(path.at, shown):
        response = measures.response(loaded)

        def couples(at: FloatArray, loaded: State = loaded) -> FloatArray:
            return coarse.couple_stress(loaded, radius, at, width) - coarse.couple_stress(rest, radius, at, width)

        stress = coarse.coarse_grained_stress(coarse.load_forces(rest, loaded), lines, width)
        couple, gradient = couples(inner), _gradient(rest.position, loaded.angle - rest.angle, inner, width)
        share = -float((couple * gradient).sum() / (gradient**2).sum())
        squares = float((couple**2).sum())
        left = float(((couple + share * gradient) ** 2).sum()) / squares if squares else float("nan")
        shear = np.sqrt(3.0) / 4.0 * (1.0 + contact.stiffness_ratio)
        bend = share / contact.normal_stiffness
        length = float(np.sqrt(max(bend, 0.0) / (4.0 * shear)))
        largest = np.linalg.norm(couples(lines), axis=-1).max(axis=1), np.abs(stress[..., 1, 1]).max(axis=1)
        lack = moment_error(path.problem, loaded, top[0] + measures.x[1:-1])
        found.append((response, half_maximum_width(measures.x, response), *largest, bend, left, length, lack))
    return Slab(measures.x, *events, *map(np.array, zip(*found, strict=True)))


def _gradient(position: FloatArray, angle: FloatArray, points: FloatArray, width: float) -> FloatArray:
    """(..., 2) gradient of the mean of angles (n,) at ``points`` (..., 2), weighted by the stress's Gaussian."""
    away = points[..., None, :] - position
    weight = np.exp(-(away**2).sum(axis=-1) / width**2)
    mean = (weight * angle).sum(axis=-1) / weight.sum(axis=-1)
    slope = -2.0 / width**2 * away * (weight * (angle - mean[..., None]))[..., None]
    return np.asarray(slope.sum(axis=-2) / weight.sum(axis=-1)[..., None])


def moment_error(problem: Problem, state: State, lines: FloatArray) -> float:
    """Largest lack of the couples across vertical lines (k,), per largest couple; nan where none are handed on.

    The disks left of a line are at rest, so the couples of the contacts that cross it equal the moments of all other
    forces on these disks: their weights and loads, walls, contact forces across the line, where the tangential ones act
    at the rim of the disk; a contact among them leaves what its overlap takes from the arms of its tangential force.
    """
    at, pairs, walls, radius = state.position, state.pairs, state.walls, problem.packing.radius
    pair, wall = state.pair_force(), state.wall_force()
    disk = at[:, 0] * -problem.weight
    k, load = problem.load_disk, state.load_factor * problem.load
    np.add.at(disk, k, at[k, 0] * load[:, 1] - at[k, 1] * load[:, 0] + load[:, 2])
    turn = radius[walls.first] * (walls.rolling_force - walls.tangential_force)
    np.add.at(disk, walls.first, _cross(at[walls.first], wall) + turn)
    i, j = pairs.first, pairs.second
    on_first = _cross(at[i], pair) - radius[i] * pairs.tangential_force
    on_second = -_cross(at[j], pair) - radius[j] * pairs.tangential_force
    couple = problem.pair_arms(i, j) * pairs.rolling_force
    across, needed = [], []
    for line in lines:
        left = at[:, 0] < line
        one, other = left[i], left[j]
        needed.append(-disk[left].sum() - on_first[one].sum() - on_second[other].sum())
        across.append(couple[one & ~other].sum() - couple[other & ~one].sum())
    largest = float(np.abs(across).max())
    return float(np.abs(np.subtract(across, needed)).max()) / largest if largest else float("nan")


def _cross(arm: FloatArray, force: FloatArray) -> FloatArray:
    return np.asarray(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``thresholds``, ``piles`` and ``slabs``."""
    p, pile, rolling = parameters, parameters.pile, parameters.rolling_frictions
    tries: dict[tuple[int, ...], partial[Threshold]] = {}
    piles: dict[tuple[int, ...], partial[Pile]] = {}
    balances, slabs = {}, {}
    for n, size in enumerate(p.layers):
        for k, mu in enumerate(rolling):
            tries |= {(n, k, r): partial(threshold, p, size, mu, ramp) for r, ramp in enumerate(p.ramps)}
            balances[n, k] = partial(balance, size, mu, p.most_friction, 0.25 * p.tolerance)
        scenes = [pile.updated({"packing.layers": size})]
        scenes += [unsupported(pile, size, pile.contact.friction, mu) for mu in (min(rolling), max(rolling))]
        piles |= {(n, k): partial(settle, scene) for k, scene in enumerate(scenes)}
    for n, slab in enumerate(p.slabs):
        for k, mu in enumerate(p.slab_rolling_frictions):
            scene = p.base.updated({"contact.friction": slab.friction, "contact.rolling_friction": mu})
            slabs[n, k] = partial(respond, scene, slab.forces, p.shown_forces, p.stress_width, p.heights)
    sizes = axes(layers=(p.layers, "number of layers"))
    of_rolling = axes(rolling_friction=(rolling, "coefficient of rolling friction"))
    of_ramps = axes(ramp=(p.ramps, "time over which gravity grows, in sqrt(R/g); 0: at once"))
    cases = axes(case=(CASES, "with side walls; without; without, and with the largest rolling friction"))
    of_slabs = axes(
        friction=([slab.friction for slab in p.slabs], "coefficient of friction between disks"),
        rolling_friction=(p.slab_rolling_frictions, "coefficient of rolling friction between disks"),
        load=(p.shown_forces, f"force {WEIGHTS}"),
        z=(np.linspace(0.0, 1.0, p.heights), "height above the floor per that of the loaded disk"),
    )
    held = table(computed(tries, "tries", work=lambda place: place[0]), "layers", "rolling_friction", "ramp")
    least = table(computed(balances, "balances", work=lambda place: place[0]), "layers", "rolling_friction")
    found = {
        "thresholds": held.merge(least).assign_coords(sizes | of_rolling | of_ramps),
        "piles": table(computed(piles, "piles"), "layers", "case").assign_coords(sizes | cases),
    }
    responses = table(computed(slabs, "slabs"), "friction", "rolling_friction").assign_coords(of_slabs)
    return labelled(found, pile) | labelled({"slabs": responses}, p.base)
