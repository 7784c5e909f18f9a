"""A packing strained as a whole: what its own tangent stiffness answers to uniform strain.

The layers at the bottom and at the top move with the uniform strain, the disks between them as equilibrium wants; with
periodic sides strain along x is exact, since what crosses the sides is one period farther. Away from the two layers
stress and strain are averaged, the strain as it is there, so a packing that is softer below the top is not mistaken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..errors import require
from ..state import FLOOR, FloatArray, State
from .held import Held
from .problem import Problem
from .small_loads import sticking
from .system import StaticSystem

#: How displacements follow the strain.
Following = Literal["affine", "suppressed", "free"]
FOLLOWING: tuple[Following, ...] = ("affine", "suppressed", "free")

#: Uniform strains eps_xx, eps_zz, eps_xz of size 1, in the order of ``theory.moduli.Moduli.matrix``.
UNIT_STRAINS = np.array([[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [1.0, 0.0]]])


@dataclass(frozen=True)
class Strained:
    """Answers of a packing to the three unit strains, averaged between two heights."""

    stress: FloatArray  #: (3, 3) xx, zz, xz (tension positive, weights per radius) of each strain (columns)
    strain: FloatArray  #: (3, 3) as it is there, of each strain that is imposed

    @property
    def moduli(self) -> FloatArray:
        """(3, 3) stress per strain, in the order of ``theory.moduli.Moduli.matrix``."""
        return self.stress @ np.linalg.inv(self.strain)


def strained(
    problem: Problem, state: State, following: Following = "free", *, margin: float = 0.25, prestress: bool = True
) -> Strained:
    """Stress and strain in the middle of a packing with periodic sides that is strained as a whole.

    Parameters
    ----------
    problem : of the state, a packing in rows between periodic sides.
    state : a stable state of static equilibrium; contacts at the Coulomb limit are taken to stick.
    following : "affine", every disk moves with the strain and none turns; or those between the lowest and the highest
        row relax, with rotations "suppressed" or "free".
    margin : part of the rows that is left out at either end of the averages (one at least), below 1/2.
    prestress : whether the turn of the contacts under the forces that they bear counts. The stress is the change of
        force per area as it was before the strain.

    Raises
    ------
    ValueError
        For another ``following`` or ``margin``, and a packing without rows or without periodic sides.
    EquilibriumError
        For a state that is not certified as stable.
    """
    require(following in FOLLOWING, f"following = {following!r}: must be one of {', '.join(FOLLOWING)}")
    require(0.0 <= margin < 0.5, f"margin = {margin}: must be from 0 to below 0.5")
    packing, kind, rows = problem.packing, problem.scene.packing.kind, len(problem.packing.row_count)
    rule = f"packing.kind = {kind}: must be slab to be strained as a whole, with packing.sides: periodic"
    require(kind == "slab", rule)
    require(packing.periodic, "packing.sides = walls: must be periodic for a packing to be strained as a whole")
    require(rows >= 3, f"packing.layers = {rows}: must be 3 or greater for a packing to be strained as a whole")
    require(2 * _left_out(rows, margin) < rows, f"margin = {margin}: leaves none of {rows} rows")
    n = problem.n
    system, trial = sticking(_moved_by_hand(problem, state, following), state, "stick")
    if not prestress:
        trial = system.without_prestress(trial)
    separation = state.pair_separation()
    affine = np.zeros((3, len(separation), 3))
    affine[:, :, :2] = np.einsum("kab,cb->kca", UNIT_STRAINS, separation)
    moved = np.zeros((3, 3, n))
    if following != "affine":
        force = _on_disks(system, np.einsum("cab,kcb->kca", system.split(trial.tangent)[0], affine))
        moved[:, : problem.freedoms] = np.stack(list(map(system.answers(trial), force))).reshape(3, -1, n)
    first, second, radius = system.first, system.second, packing.radius
    relative = affine.copy()
    relative[:, :, :2] += np.swapaxes(moved[:, :2, first] - moved[:, :2, second], 1, 2)
    relative[:, :, 2] = radius[first] * moved[:, 2, first] + radius[second] * moved[:, 2, second]
    added = np.einsum("cab,kcb->kca", system.split(trial.tangent)[0], relative)[:, :, :2]
    return _averaged(state, packing.row, separation, added, moved, margin)


def _left_out(rows: int, margin: float) -> int:
    """Rows at either end over which nothing is averaged."""
    return max(1, round(margin * rows))


def _moved_by_hand(problem: Problem, state: State, following: Following) -> Problem:
    """The problem with the disks of both ends held, those on the floor too, and every angle where none may turn."""
    n, row = problem.n, problem.packing.row
    ends = (row == 0) | (row == row.max())
    ends[state.walls.first[(state.walls.second == FLOOR) & state.walls.touching]] = True
    unknowns = [axis * n + np.flatnonzero(ends) for axis in (0, 1)]
    if problem.rotations and following == "suppressed":
        unknowns.append(2 * n + np.arange(n))
    place = np.concatenate(unknowns)
    nothing = np.zeros(len(place))
    return replace(problem, held=Held(np.zeros(len(place), np.int64), place % n, place // n, nothing, nothing))


def _on_disks(system: StaticSystem, added: FloatArray) -> FloatArray:
    """(3, dof) what contacts push and turn disks with, of forces ``added`` (3, m, 3) on the first disk of each."""
    n, radius = system.problem.n, system.problem.packing.radius
    force = np.zeros((3, 3, n))
    for k in range(3):
        for axis in (0, 1):
            force[k, axis] = np.bincount(system.first, added[k, :, axis], n)
            force[k, axis] -= np.bincount(system.second, added[k, :, axis], n)
        for side in (system.first, system.second):
            force[k, 2] -= radius * np.bincount(side, added[k, :, 2], n)
    return force[:, : system.problem.freedoms].reshape(3, -1)


def _averaged(
    state: State, row: np.ndarray, separation: FloatArray, added: FloatArray, moved: FloatArray, margin: float
) -> Strained:
    """Averages between the two ends of contact forces ``added`` (3, m, 2) and displacements ``moved`` (3, 3, n)."""
    z = state.position[:, 1]
    # between rows, so that a lattice has as many contacts there as its area asks for
    height_of_row = np.bincount(row, z) / np.bincount(row)
    between = 0.5 * (height_of_row[1:] + height_of_row[:-1])
    left_out = _left_out(len(height_of_row), margin)
    low, high = between[left_out - 1], between[-left_out]
    top = z[state.pairs.first]
    bottom = top - separation[:, 1]
    low_end, high_end = np.minimum(top, bottom), np.maximum(top, bottom)
    length = high_end - low_end
    level = length < 1e-12
    inside = np.clip(np.minimum(high_end, high) - np.maximum(low_end, low), 0.0, None) / np.where(level, 1.0, length)
    part = np.where(level, (low <= top) & (top < high), inside)
    # the force on the first disk pulls it back: tension along the separation
    tensor = -np.einsum("c,kca,cb->kab", part, added, separation) / (state.box.width * (high - low))
    stress = np.stack([tensor[:, 0, 0], tensor[:, 1, 1], 0.5 * (tensor[:, 0, 1] + tensor[:, 1, 0])])
    bears = (state.contact_count() >= 2) & (low <= z) & (z < high)
    height = z[bears] - z[bears].mean()
    slope = moved[:, :2, bears] @ height / (height @ height)
    strain = np.eye(3)
    strain[1] += slope[:, 1]
    strain[2] += 0.5 * slope[:, 0]
    return Strained(stress, strain)
