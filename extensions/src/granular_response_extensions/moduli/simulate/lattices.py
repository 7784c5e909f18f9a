"""Moduli of lattices beside the closed form, and where their response turns from one peak to two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple
from functools import partial

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.strain import FOLLOWING, strained
from granular_response.state import FloatArray
from granular_response.sweeps.rest import rest_state
from granular_response.theory import crossover, lattice
from granular_response.theory.crossover import Body
from granular_response.theory.lattice import Rotations, Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab
from granular_response_extensions.moduli.parameters import Parameters
from granular_response_extensions.moduli.simulate.response import on_floor, symmetric
from granular_response_paper.records import axes, places, stacked, variables
from granular_response_paper.tasks import computed

#: Disks per row of a lattice that is strained: by symmetry all of a row do the same.
NARROW = 6

#: Bodies and rotations of the theory's turns from two peaks to one.
BODIES: tuple[Body, ...] = ("half plane", "smooth floor")
ROTATIONS: tuple[Rotations, ...] = ("free", "suppressed")


def slab_scene(parameters: Parameters, layers: int, disks_per_row: int, spacing: float | str, others: Mapping) -> Scene:
    """The base scene with periodic sides, of this size and lattice constant, with ``others`` changed."""
    size = {"packing.sides": "periodic", "packing.layers": layers, "packing.disks_per_row": disks_per_row}
    return parameters.base.updated({**size, "packing.lattice_constant": spacing, **others})


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


def lattice_study(parameters: Parameters) -> xr.Dataset:
    """Dataset ``lattice``."""
    p, group = parameters, parameters.lattice
    ratios, near = np.array(group.stiffness_ratios), np.array(group.responding_ratios)

    def scene(spacing: float, layers: int, row: int, ratio: float) -> Scene:
        springs = {"contact.friction": group.friction, "contact.stiffness_ratio": ratio, "wall.friction": 0.0}
        return slab_scene(p, layers, row, spacing, springs)

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
