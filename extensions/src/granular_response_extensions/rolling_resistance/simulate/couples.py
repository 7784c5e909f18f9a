"""Couples that contacts with rolling resistance hand on in a slab.

The couple stress m that a load adds is fitted by that of a Cosserat solid, ``m = -B grad(turn)``. Where the contacts
of a lattice of equal disks stick, ``B = sqrt(3)/4 k_R`` and ``G = sqrt(3)/4 (k_N + k_T)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from granular_response.observe import stress as coarse
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII
from granular_response.studies import LoadPath, Measures
from granular_response_extensions.rolling_resistance.parameters import Parameters
from granular_response_paper.records import column, record


@record
class CosseratFit:
    """The couple stress that a load adds, as that of a Cosserat solid."""

    modulus: float = column("couple stress per gradient of the rotation, in k_N times radii squared")
    unexplained: float = column("part of the squares of the couple stress that this modulus leaves")
    length: float = column(f"Cosserat length sqrt(B / 4 G) with the lattice's shear modulus {RADII}")


@record
class Loaded(CosseratFit):
    """The slab under one of the forces."""

    floor_response: FloatArray = column("floor response per force", "floor_disk")


@record
class Turned(CosseratFit):
    """The slab under a torque, of which contacts hand down couples across each line between two rows."""

    couple: FloatArray = column("couple that contacts hand down across a line, per torque", "line")
    decay_unexplained: float = column("part of the squares of these couples that an exponential of the depth leaves")
    decay_length: float = column(f"Cosserat length sqrt(B / 4 G) by that exponential and the lattice's moduli {RADII}")


@record
class RollingSlab:
    """A slab under each force, and under each torque on the loaded disk alone."""

    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    loaded: tuple[Loaded, ...]
    turned: tuple[Turned, ...]


def respond(parameters: Parameters, friction: float, rolling: float) -> RollingSlab:
    """One slab; stresses are those that the load adds. Raises what the solvers raise."""
    scene = parameters.base.updated({"contact.friction": friction, "contact.rolling_friction": rolling})
    path, width = LoadPath.of(scene), parameters.stress_width
    measures, problem, rest = Measures(path), path.problem, path.rest
    packing, top = problem.packing, rest.position[measures.loaded_disk]
    inner = coarse.grid_points(top[0] + measures.x[measures.interior], np.arange(width, top[1] - width, 0.5 * width))

    def under(state: State) -> Loaded:
        return Loaded(*fit(problem, rest, state, inner, width), measures.response(state))

    rows = np.arange(packing.row.max() + 1)[::-1]
    above = packing.row > rows[1:, None]
    height = [rest.position[packing.row == row, 1].mean() for row in rows]
    depth = top[1] - 0.5 * np.add(height[:-1], height[1:])
    twist = LoadPath.of(scene.updated({"loads.0.force": [0.0, 0.0], "loads.0.torque": 1.0}), rest)
    before = couples(twist.problem, rest, above)

    def turned(torque: float, state: State) -> Turned:
        couple = (before - couples(twist.problem, state, above)) / torque
        return Turned(*fit(twist.problem, rest, state, inner, width), couple, *decay(scene, depth, couple))

    twisted = tuple(map(turned, parameters.torques, twist.through(parameters.torques)))
    return RollingSlab(measures.x, tuple(map(under, map(path.at, parameters.slab_forces))), twisted)


def fit(problem: Problem, rest: State, loaded: State, points: FloatArray, width: float) -> tuple[float, float, float]:
    """The numbers of :class:`CosseratFit` by the stress at ``points`` (..., 2)."""
    contact = problem.scene.contact
    after, before = (coarse.couple_stress(state, problem.packing.radius, points, width) for state in (loaded, rest))
    couple = after - before
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


def decay(scene: Scene, depth: FloatArray, couple: FloatArray) -> tuple[float, float]:
    """Part of the squares of couples (k,) at depths (k,) that those of a Cosserat solid leave, and the length of that.

    Its equations summed along horizontal lines make the couple below a unit torque ``exp(-depth / l)`` with
    ``l = sqrt(B (1 / G + 1 / G_c) / 4)``, where ``2 G_c`` is the antisymmetric stress per turn of its points against
    their surroundings. Where the contacts of a lattice stick, ``G_c = sqrt(3)/2 k_T``. ``l`` is fitted from a tenth of
    a radius on, and stands for ``sqrt(B / 4 G)`` with the lattice's ratio of moduli. nan without couples.
    """
    ratio = np.sqrt(1.0 + (1.0 + scene.contact.stiffness_ratio) / (2.0 * scene.contact.stiffness_ratio))
    squares = float((couple**2).sum())
    if not squares:
        return float("nan"), float("nan")

    def left(size: float) -> float:
        return float(((couple - np.exp(-depth / size)) ** 2).sum()) / squares

    found = minimize_scalar(left, bounds=(0.1, float(depth.max())), method="bounded", options={"xatol": 1e-9})
    return float(found.fun), float(found.x / ratio)


def couples(problem: Problem, state: State, parts: NDArray[np.bool_]) -> FloatArray:
    """(k,) couples on parts of the packing, (k, n), by the contacts across their borders."""
    i, j = state.pairs.first, state.pairs.second
    couple, _ = state.couples(problem.packing.radius)
    return np.array([couple[part[i] & ~part[j]].sum() - couple[part[j] & ~part[i]].sum() for part in parts])
