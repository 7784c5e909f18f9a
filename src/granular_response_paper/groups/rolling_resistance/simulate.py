"""What rolling resistance changes (Secs. V.F and VIII): piles without support, a slab's response, couple stresses.

``thresholds`` has the least friction that holds a pile on a flat floor, whose sides nothing supports, and that below
which no forces balance whatever the preparation (:func:`balance`). ``piles`` are those of the paper's friction.
``slabs`` has the response of a slab and its couple stress m, fitted by that of a Cosserat solid, ``m = -B grad(turn)``,
``torques`` how couples and antisymmetric stress share a torque on the loaded disk, line by line between the rows. Where
the contacts of a lattice of equal disks stick, ``B = sqrt(3)/4 k_R`` and ``G = sqrt(3)/4 (k_N + k_T)``.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import linprog, minimize_scalar
from scipy.sparse import block_array, csr_array, diags_array, eye_array
from scipy.spatial import cKDTree

from granular_response.observe import stress as coarse
from granular_response.observe.events import bisect_event
from granular_response.observe.floor import floor_force
from granular_response.observe.peaks import central_dip
from granular_response.scene import Packing, PilePacking, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import NotSettled
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.rest import rest_state
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.rolling_resistance.parameters import Parameters
from granular_response_paper.groups.rolling_resistance.parameters import Slab as SlabParameters
from granular_response_paper.records import axes, column, parts, places, record, table
from granular_response_paper.slab_response import LoadPath, Measures, first_opening, half_maximum_width, two_peaks
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

    @cache
    def held(friction: float) -> Pile | None:
        try:
            pile = settle(unsupported(parameters.pile, layers, friction, rolling, ramp))
        except NotSettled:
            return None
        return pile if pile.moved <= parameters.moved else None

    least, most = parameters.least_friction, parameters.most_friction
    if held(most) is None:
        return Threshold(float("nan"), float("nan"), np.empty(0), np.empty(0), most, float("nan"))
    found = bisect_event(lambda mu: held(mu) is not None, least, most, parameters.tolerance, at_low=False, at_high=True)
    return Threshold(**vars(held(found.high)), low=found.low if found.low > least else 0.0, high=found.high)


def balance(layers: int, rolling: float, most: float, tolerance: float) -> Balance:
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


@record
class Fit:
    """The couple stress that a load adds, as that of a Cosserat solid."""

    modulus: float = column("couple stress per gradient of the rotation, in k_N times radii squared")
    unexplained: float = column("part of the squares of the couple stress that this modulus leaves")
    length: float = column(f"Cosserat length sqrt(B / 4 G) with the lattice's shear modulus {RADII}")


@record
class Loaded(Fit):
    """The slab under one of the forces that are shown."""

    floor_response: FloatArray = column("floor response per force", "floor_disk")
    width: float = column(f"full width at half maximum of the floor response {RADII}")
    couple_stress: FloatArray = column("largest couple stress of the load at a height, in weights", "z")
    vertical_stress: FloatArray = column("largest vertical stress of it there, in weights per radius", "z")
    moment_error: float = column("largest lack of the couples across a vertical line, per largest couple")


@record
class Turned(Fit):
    """The slab under a torque, which couples and antisymmetric stress share on each line between two rows."""

    depth: FloatArray = column(f"depth of a line below the loaded disk {RADII}", "line")
    couple: FloatArray = column("couple that contacts hand down across a line, per torque", "line")
    antisymmetric: FloatArray = column(
        "moment of the antisymmetric stress at the disks of the row above a line, per torque", "line"
    )
    solid: FloatArray = column("that couple in a Cosserat solid with the moduli of the lattice", "line")
    decay_unexplained: float = column("part of the squares of these couples that an exponential of the depth leaves")
    decay_length: float = column(f"Cosserat length sqrt(B / 4 G) by that exponential and the lattice's moduli {RADII}")
    moment_error: float = column("largest lack of moments above a line, torque and couples included, per torque")


@record
class Slab:
    """A slab under a growing force, under each force that is shown, and under each torque on the loaded disk alone."""

    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    opening: FloatArray = column(f"force of the first opening, before and after {WEIGHTS}", "end")
    crossover: FloatArray = column(f"force from which on there are two peaks, before and after {WEIGHTS}", "end")
    loaded: tuple[Loaded, ...]
    turned: tuple[Turned, ...]


def respond(parameters: Parameters, slab: SlabParameters, rolling: float) -> Slab:
    """One slab; stresses are those that the load adds. Raises what the solvers raise."""
    scene = parameters.base.updated({"contact.friction": slab.friction, "contact.rolling_friction": rolling})
    path, width = LoadPath.of(scene), parameters.stress_width
    measures, problem, rest = Measures(path), path.problem, path.rest
    path.through(sorted({*slab.forces, *parameters.shown_forces}))
    opening, crossover = (np.array(path.first(slab.forces, of(measures))) for of in (first_opening, two_peaks))
    packing, top = problem.packing, rest.position[measures.loaded_disk]
    lines = coarse.grid_points(top[0] + measures.x, np.linspace(0.0, top[1], parameters.heights))
    inner = coarse.grid_points(top[0] + measures.x[measures.interior], np.arange(width, top[1] - width, 0.5 * width))

    def under(state: State) -> Loaded:
        response = measures.response(state)
        stress = coarse.coarse_grained_stress(coarse.load_forces(rest, state), lines, width)
        couple = np.linalg.norm(_couple_stress(problem, rest, state, lines, width), axis=-1)
        across, needed = moments(problem, state, state.position[:, 0] < (top[0] + measures.x[1:-1])[:, None])
        largest = float(np.abs(across).max())
        return Loaded(
            *fit(problem, rest, state, inner, width),
            floor_response=response,
            width=half_maximum_width(measures.x, response),
            couple_stress=couple.max(axis=1),
            vertical_stress=np.abs(stress[..., 1, 1]).max(axis=1),
            moment_error=float(np.abs(across - needed).max()) / largest if largest else float("nan"),
        )

    rows = np.arange(packing.row.max() + 1)[::-1]
    above = packing.row > rows[1:, None]
    height = [rest.position[packing.row == row, 1].mean() for row in rows]
    depth = top[1] - 0.5 * np.add(height[:-1], height[1:])
    twist = LoadPath.of(scene.updated({"loads.0.force": [0.0, 0.0], "loads.0.torque": 1.0}), rest)
    before, _ = moments(twist.problem, rest, above)

    def turned(torque: float, state: State) -> Turned:
        across, needed = moments(twist.problem, state, above)
        couple = (before - across) / torque
        moment = above @ (_turning(packing, state) - _turning(packing, rest)) / torque
        return Turned(
            *fit(twist.problem, rest, state, inner, width),
            depth,
            couple,
            np.diff(moment, prepend=0.0),
            *decay(scene, depth, couple),
            moment_error=float(np.abs(across - needed).max(initial=0.0)) / torque,
        )

    torques = parameters.torques
    twisted = tuple(map(turned, torques, twist.through(torques)))
    return Slab(measures.x, opening, crossover, tuple(map(under, map(path.at, parameters.shown_forces))), twisted)


def fit(problem: Problem, rest: State, loaded: State, points: FloatArray, width: float) -> tuple[float, float, float]:
    """The numbers of :class:`Fit` by the stress at ``points`` (..., 2)."""
    contact = problem.scene.contact
    couple = _couple_stress(problem, rest, loaded, points, width)
    gradient = _gradient(rest.position, loaded.angle - rest.angle, points, width)
    share = -float((couple * gradient).sum() / (gradient**2).sum())
    squares = float((couple**2).sum())
    left = float(((couple + share * gradient) ** 2).sum()) / squares if squares else float("nan")
    shear = np.sqrt(3.0) / 4.0 * (1.0 + contact.stiffness_ratio)
    bend = share / contact.normal_stiffness
    return bend, left, float(np.sqrt(max(bend, 0.0) / (4.0 * shear)))


def decay(scene: Scene, depth: FloatArray, couple: FloatArray) -> tuple[FloatArray, float, float]:
    """Couples (k,) at depths (k,) in a Cosserat solid; the part of the squares of ``couple`` (k,) left, and the length.

    Its equations summed along horizontal lines make the couple below a unit torque ``exp(-depth / l)`` with
    ``l = sqrt(B (1 / G + 1 / G_c) / 4)``, where ``2 G_c`` is the antisymmetric stress per turn of its points against
    their surroundings. Where the contacts of a lattice stick, ``G_c = sqrt(3)/2 k_T``. The couples are those with the
    lattice's moduli; ``l`` is fitted from a tenth of a radius on, and stands for ``sqrt(B / 4 G)`` with its ratio of
    moduli. Part and length are nan without couples.
    """
    contact = scene.contact
    ratio = np.sqrt(1.0 + (1.0 + contact.stiffness_ratio) / (2.0 * contact.stiffness_ratio))
    lattice = 0.5 * ratio * np.sqrt(contact.rolling_stiffness_ratio / (1.0 + contact.stiffness_ratio))
    solid, squares = np.exp(-depth / lattice), float((couple**2).sum())
    if not squares:
        return solid, float("nan"), float("nan")

    def left(size: float) -> float:
        return float(((couple - np.exp(-depth / size)) ** 2).sum()) / squares

    found = minimize_scalar(left, bounds=(0.1, float(depth.max())), method="bounded", options={"xatol": 1e-9})
    return solid, float(found.fun), float(found.x / ratio)


def _couple_stress(problem: Problem, rest: State, loaded: State, points: FloatArray, width: float) -> FloatArray:
    """(..., 2) couple stress that the load adds at ``points`` (..., 2)."""
    after, before = (coarse.couple_stress(state, problem.packing.radius, points, width) for state in (loaded, rest))
    return after - before


def _turning(packing: Packing, state: State) -> FloatArray:
    """(n,) moment of the tangential forces between disks that their partners leave to each, clockwise."""
    pairs = state.pairs
    ends = np.concatenate([pairs.first, pairs.second])
    return np.asarray(np.bincount(ends, packing.radius[ends] * np.tile(pairs.tangential_force, 2), packing.n), float)


def _gradient(position: FloatArray, angle: FloatArray, points: FloatArray, width: float) -> FloatArray:
    """(..., 2) gradient of the mean of angles (n,) at ``points`` (..., 2), weighted by the stress's Gaussian."""
    away = points[..., None, :] - position
    weight = np.exp(-(away**2).sum(axis=-1) / width**2)
    mean = (weight * angle).sum(axis=-1) / weight.sum(axis=-1)
    slope = -2.0 / width**2 * away * (weight * (angle - mean[..., None]))[..., None]
    return np.asarray(slope.sum(axis=-2) / weight.sum(axis=-1)[..., None])


def moments(problem: Problem, state: State, parts: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray]:
    """(k,) couples on parts of the packing, (k, n), by the contacts across their borders; and what balance needs.

    The disks of a part are at rest, so these couples equal the opposite moments of all other forces on them: their
    weights and loads, walls, contact forces across the border, where the tangential ones act at the rim of the disk;
    a contact among them leaves what its overlap takes from the arms of its tangential force.
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
    for part in parts:
        one, other = part[i], part[j]
        needed.append(-disk[part].sum() - on_first[one].sum() - on_second[other].sum())
        across.append(couple[one & ~other].sum() - couple[other & ~one].sum())
    return np.array(across), np.array(needed)


def _cross(arm: FloatArray, force: FloatArray) -> FloatArray:
    return np.asarray(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``thresholds``, ``piles``, ``slabs`` and ``torques``."""
    p, pile, rolling = parameters, parameters.pile, parameters.rolling_frictions
    tries = {place: partial(threshold, p, *one) for place, one in places(p.layers, rolling, p.ramps)}
    balances = {
        place: partial(balance, size, mu, p.most_friction, 0.25 * p.tolerance)
        for place, (size, mu) in places(p.layers, rolling)
    }
    slabs = {place: partial(respond, p, *one) for place, one in places(p.slabs, p.slab_rolling_frictions)}

    def scene(size: int, mu: float | None) -> Scene:
        if mu is None:
            return pile.updated({"packing.layers": size})
        return unsupported(pile, size, pile.contact.friction, mu)

    cases = {place: scene(*one) for place, one in places(p.layers, (None, min(rolling), max(rolling)))}
    held = table(computed(tries, "tries", work=lambda place: place[0]), "layers", "rolling_friction", "ramp")
    least = table(computed(balances, "balances", work=lambda place: place[0]), "layers", "rolling_friction")
    settled = table(computed({at: partial(settle, one) for at, one in cases.items()}, "piles"), "layers", "case")
    found, along = computed(slabs, "slabs"), ("friction", "rolling_friction")
    loaded, turned = table(parts(found, "loaded"), *along, "load"), table(parts(found, "turned"), *along, "torque")
    sizes = axes(layers=(p.layers, "number of layers"))
    of_piles = axes(
        rolling_friction=(rolling, "coefficient of rolling friction"),
        ramp=(p.ramps, "time over which gravity grows, in sqrt(R/g); 0: at once"),
    )
    of_slabs = axes(
        friction=([slab.friction for slab in p.slabs], "coefficient of friction between disks"),
        rolling_friction=(p.slab_rolling_frictions, "coefficient of rolling friction between disks"),
    )
    of_cases = axes(case=(CASES, "with side walls; without; without, and with the largest rolling friction"))
    torques = axes(torque=(p.torques, "torque in mean disk weights times mean radius, counter-clockwise"))
    heights = np.linspace(0.0, 1.0, p.heights)
    of_loads = axes(
        load=(p.shown_forces, f"force {WEIGHTS}"), z=(heights, "height above the floor per that of the loaded disk")
    )
    return labelled(
        {
            "thresholds": held.merge(least).assign_coords(sizes | of_piles),
            "piles": settled.assign_coords(sizes | of_cases),
        },
        pile,
    ) | labelled(
        {
            "slabs": table(found, *along).merge(loaded).assign_coords(of_slabs | of_loads),
            "torques": turned.assign_coords(of_slabs | torques),
        },
        p.base,
    )
