"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "stability_motion": Caption(
            "Undamped systems, energy change per kinetic energy at first: a kicked slab without friction, with a "
            "twentieth of the largest stable time step, and the same with friction 0.2, which only takes energy. "
            "Collisions without dashpots, largest of all spins and coefficients of friction: the default rule of "
            "friction never gives energy, the paper's equation for the spring taken literally does. Disks set on the "
            "floor with a velocity and a spin, which slide until they roll: lines simulated, symbols in closed form.",
            "Four plots: energy change against time for two systems, energy after a collision over that before, and "
            "velocities of rolling disks.",
        ),
        "stability_scenes": Caption(
            "What became of random scenes: blue have a result, orange an error of one line, and wrong would be a "
            "result that its positions contradict or an error that nobody understands. The largest unbalanced force "
            "of certified results, computed from positions alone (broken line: 1e-9; beyond are stiff scenes, where "
            "the last digit of a position is worth that much). Relative change of a floor response when the rest "
            "state is displaced by 1e-12 of a radius (broken line).",
            "Bars of outcomes and two histograms on logarithmic axes.",
        ),
        "stability_steps": Caption(
            "What becomes of a kicked slab at rest in raw dynamics, for time steps in units of the predicted limit. "
            "One property of the scene is changed in each column.",
            "A grid of marks that change from settled to diverged as the time step grows.",
        ),
    }
