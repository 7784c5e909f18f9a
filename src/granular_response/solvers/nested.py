"""A start near the rest state of a large slab: that of a slab of half the size, and so on down.

A slab of half as many layers and columns whose contacts are a quarter as stiff sinks by the same lengths under
gravity, place by place, and in the limit of many layers the same contacts open. So nearly all of the search for the
contacts that bear is done on slabs that cost little: without, the rest state of 230,520 disks takes 49 iterations in
place of 28 and 1.5 times as long, that of 102,480 disks 1.25 times, but that of 57,660 disks 0.87 times.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import EquilibriumError
from ..scene.packing import Packing
from ..state import FloatArray, State
from .energy import OPTIONS, minimise
from .problem import Problem


def rest_start(problem: Problem) -> State:
    """A state from which the rest state of a packing without friction is found in few iterations.

    For slabs of more than ``MinimiseOptions.large`` equal disks that touch; else, or where the smaller slab has no rest
    state, the packing as built.
    """
    bare, packing = problem.bare_state(), problem.packing
    touching = packing.lattice_constant == 2.0 * packing.radius[0]
    half = problem.scene.packing.half()
    if half is None or not (packing.ordered and touching and problem.n > OPTIONS.large):
        return bare
    coarse = half.build()
    part = len(coarse.row_count) / len(packing.row_count)
    smaller = replace(
        problem,
        scene=problem.scene.model_copy(update={"packing": half}),
        packing=coarse,
        pair_law=problem.pair_law.softened(part),
        wall_law=problem.wall_law.softened(part),
    )
    try:
        rest = minimise(smaller, rest_start(smaller))
    except EquilibriumError:
        return bare
    displacement = prolonged(rest.position - smaller.packing.position, smaller.packing, packing)
    return problem.with_static_forces(replace(bare, position=bare.position + displacement))


def prolonged(displacement: FloatArray, coarse: Packing, fine: Packing) -> FloatArray:
    """(fine.n, 2) displacements (coarse.n, 2) of one slab at the places of another, linear in both directions.

    Places are parts of width and height. The floor does not sink, the side walls do not give way.
    """
    rows = len(coarse.row_count)
    begin = np.concatenate([[0], np.cumsum(coarse.row_count)])
    columns = np.linspace(0.0, 1.0, 2 * int(coarse.row_count[0]) + 1)
    field = np.zeros((rows + 1, len(columns), 2))
    for row in range(rows):
        disks = slice(begin[row], begin[row + 1])
        x = coarse.position[disks, 0] / coarse.width
        along, across = displacement[disks].T
        field[row + 1, :, 0] = np.interp(columns, np.r_[0.0, x, 1.0], np.r_[0.0, along, 0.0])
        k, part = _between(columns, x)
        field[row + 1, :, 1] = (1.0 - part) * across[k] + part * across[k + 1]
    height = np.concatenate([[0.0], coarse.position[begin[:-1], 1] / rows])
    slope = (field[2, :, 0] - field[1, :, 0]) / (height[2] - height[1])
    field[0, :, 0] = field[1, :, 0] - slope * height[1]
    wanted_x = fine.position[:, 0] / fine.width
    wanted_z = fine.position[:, 1] / len(fine.row_count)
    j, u = _between(wanted_x, columns)
    i, v = _between(wanted_z, height)
    u, v = u[:, None], v[:, None]
    lower = (1.0 - u) * field[i, j] + u * field[i, j + 1]
    upper = (1.0 - u) * field[i + 1, j] + u * field[i + 1, j + 1]
    return (1.0 - v) * lower + v * upper


def _between(x: FloatArray, nodes: FloatArray) -> tuple[np.ndarray, FloatArray]:
    """The interval of ``nodes`` that holds each ``x``, or is next to it, and the place in its units."""
    k = np.clip(np.searchsorted(nodes, x) - 1, 0, len(nodes) - 2)
    return k, (x - nodes[k]) / (nodes[k + 1] - nodes[k])
