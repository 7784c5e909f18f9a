"""Couples that contacts with rolling resistance hand on in a slab.

The couple stress m that a load adds is fitted by that of a Cosserat solid, ``m = -B grad(turn)``. Where the contacts
of a lattice of equal disks stick, ``B = sqrt(3)/4 k_R`` and ``G = sqrt(3)/4 (k_N + k_T)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from granular_response.observe import stress as coarse
from granular_response.observe.widths import half_maximum_width
from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.studies import LoadPath, Measures, first_opening, two_peaks
from granular_response_extensions.rolling_resistance.parameters import Parameters
from granular_response_paper.parameters import Loading
from granular_response_paper.records import column, record


@record
class CosseratFit:
    """The couple stress that a load adds, as that of a Cosserat solid."""

    modulus: float = column("couple stress per gradient of the rotation, in k_N times radii squared")
    unexplained: float = column("part of the squares of the couple stress that this modulus leaves")
    length: float = column(f"Cosserat length sqrt(B / 4 G) with the lattice's shear modulus {RADII}")


@record
class LoadedStress(CosseratFit):
    """The slab under one of the forces that are shown."""

    floor_response: FloatArray = column("floor response per force", "floor_disk")
    width: float = column(f"full width at half maximum of the floor response {RADII}")
    couple_stress: FloatArray = column("largest couple stress of the load at a height, in weights", "z")
    vertical_stress: FloatArray = column("largest vertical stress of it there, in weights per radius", "z")
    moment_error: float = column("largest lack of the couples across a vertical line, per largest couple")


@record
class Turned(CosseratFit):
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
class RollingSlab:
    """A slab under a growing force, under each force that is shown, and under each torque on the loaded disk alone."""

    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    opening: FloatArray = column(f"force of the first opening, before and after {WEIGHTS}", "end")
    crossover: FloatArray = column(f"force from which on there are two peaks, before and after {WEIGHTS}", "end")
    loaded: tuple[LoadedStress, ...]
    turned: tuple[Turned, ...]


def respond(parameters: Parameters, slab: Loading, rolling: float) -> RollingSlab:
    """One slab; stresses are those that the load adds. Raises what the solvers raise."""
    scene = parameters.base.updated({"contact.friction": slab.friction, "contact.rolling_friction": rolling})
    path, width = LoadPath.of(scene), parameters.stress_width
    measures, problem, rest = Measures(path), path.problem, path.rest
    path.through(sorted({*slab.forces, *parameters.shown_forces}))
    opening, crossover = (np.array(path.first(slab.forces, of(measures))) for of in (first_opening, two_peaks))
    packing, top = problem.packing, rest.position[measures.loaded_disk]
    lines = coarse.grid_points(top[0] + measures.x, np.linspace(0.0, top[1], parameters.heights))
    inner = coarse.grid_points(top[0] + measures.x[measures.interior], np.arange(width, top[1] - width, 0.5 * width))

    def under(state: State) -> LoadedStress:
        response = measures.response(state)
        stress = coarse.coarse_grained_stress(coarse.load_forces(rest, state), lines, width)
        couple = np.linalg.norm(_couple_stress(problem, rest, state, lines, width), axis=-1)
        across, needed = moments(problem, state, state.position[:, 0] < (top[0] + measures.x[1:-1])[:, None])
        largest = float(np.abs(across).max())
        return LoadedStress(
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

    twisted = tuple(map(turned, parameters.torques, twist.through(parameters.torques)))
    return RollingSlab(
        measures.x, opening, crossover, tuple(map(under, map(path.at, parameters.shown_forces))), twisted
    )


def fit(problem: Problem, rest: State, loaded: State, points: FloatArray, width: float) -> tuple[float, float, float]:
    """The numbers of :class:`CosseratFit` by the stress at ``points`` (..., 2)."""
    contact = problem.scene.contact
    couple = _couple_stress(problem, rest, loaded, points, width)
    # gradient of the mean turn of the disks, weighted by the stress's Gaussian
    away, turn = points[..., None, :] - rest.position, loaded.angle - rest.angle
    weight = np.exp(-(away**2).sum(axis=-1) / width**2)
    mean = (weight * turn).sum(axis=-1) / weight.sum(axis=-1)
    slope = -2.0 / width**2 * away * (weight * (turn - mean[..., None]))[..., None]
    gradient = slope.sum(axis=-2) / weight.sum(axis=-1)[..., None]
    share = -float((couple * gradient).sum() / (gradient**2).sum())
    squares = float((couple**2).sum())
    left = float(((couple + share * gradient) ** 2).sum()) / squares if squares else float("nan")
    bend, shear = share / contact.normal_stiffness, np.sqrt(3.0) / 4.0 * (1.0 + contact.stiffness_ratio)
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
    i, j, w = pairs.first, pairs.second, walls.first
    turn = radius[w] * (walls.rolling_force - walls.tangential_force)
    np.add.at(disk, w, (at[w, 0] * wall[:, 1] - at[w, 1] * wall[:, 0]) + turn)
    on_first = (at[i, 0] * pair[:, 1] - at[i, 1] * pair[:, 0]) - radius[i] * pairs.tangential_force
    on_second = -(at[j, 0] * pair[:, 1] - at[j, 1] * pair[:, 0]) - radius[j] * pairs.tangential_force
    couple = problem.pair_arms(i, j) * pairs.rolling_force
    across = [couple[part[i] & ~part[j]].sum() - couple[part[j] & ~part[i]].sum() for part in parts]
    needed = [-disk[part].sum() - on_first[part[i]].sum() - on_second[part[j]].sum() for part in parts]
    return np.array(across), np.array(needed)
