"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import WEIGHT, Caption, values

from .draw import AXES
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    steps, drift, rounding = parameters.time_steps, parameters.drift, parameters.rounding
    scenes = datasets["random_scenes"].sizes["scene"]
    axes = [name for name in AXES if f"time_step_{name}" in datasets]
    return {
        "stability_steps": Caption(
            f"Not in the paper: (a) to ({'abcdefgh'[len(axes) - 1]}) up to which time step, in units of the "
            "predicted limit, a kicked slab at rest settles in raw dynamics, for three integrators. One property of "
            "the scene is changed in each panel. Bars reach from the last step up to which all settle to the first "
            f"that does not, of {values(steps.ratios)} tried; crosses are the smallest steps at which the energy "
            "grows without end.",
            "Eight panels. The bars of every integrator lie at or above the predicted limit for all values, those of "
            "velocity Verlet up to half above it; crosses lie mostly at twice the limit and more.",
        ),
        "stability_motion": Caption(
            "Not in the paper. Change of the energy per kinetic energy at first of an undamped slab that is kicked, "
            f"(a) without friction, with {drift.part_of_limit:g} of the largest stable time step, and (b) with "
            f"friction {drift.friction:g}, which only takes energy; the three curves cover each other. (c) "
            "Collisions without dashpots, largest of all spins and coefficients of friction: the default rule of "
            "friction never gives energy, the paper's equation for the spring taken literally does. (d) Disks set on "
            "the floor with a velocity and a spin, which slide until they roll: lines simulated, symbols in closed "
            "form, full for the velocity, hollow for the speed of the rim.",
            "Four plots: energy that drifts by thousandths, energy that friction takes, energies after a collision per "
            "those before, at most 1 for the default rule, and velocities that meet when disks roll.",
        ),
        "stability_scenes": Caption(
            f"Not in the paper. (a) What became of {scenes} random scenes: plain bars have a result, hatched ones an "
            "error of one line, and wrong would be a result that its positions contradict or an error that nobody "
            "understands. (b) Largest unbalanced force of certified results, computed from positions alone (broken "
            f"line: 1e-9 {WEIGHT}; beyond are stiff scenes, where the last digit of a position is worth that much). "
            f"(c) Relative change of a floor response when the rest state is displaced by {rounding.displacement:g} "
            f"of a radius (broken line), {rounding.kicks} times each.",
            "Bars of outcomes, a histogram of unbalanced forces on a logarithmic axis, and for each of some packings "
            "points of the change, which is largest after a collapse.",
        ),
    }
