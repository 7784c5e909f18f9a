"""Numerical stability: which time steps settle, cycle or blow up, against the predicted limit.

Random scenes, collisions and rolling in closed form are tests (``tests/stress``).
"""

from __future__ import annotations

from functools import partial
from typing import Any

import xarray as xr

from granular_response.store.variables import WEIGHTS
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.stability import parameters as given
from granular_response_paper.groups.stability.simulate import time_steps
from granular_response_paper.records import table_along
from granular_response_paper.tasks import computed

#: Axes of the time-step maps: what each one changes in the scene, and what it is.
AXES: dict[str, tuple[str, str]] = {
    "normal_stiffness": ("contact.normal_stiffness", "normal stiffness in mean disk weights per mean radius"),
    "stiffness_ratio": ("contact.stiffness_ratio", "tangential over normal stiffness"),
    "damping_ratio": ("contact.damping_ratio", "dashpot over its critical value"),
    "friction": ("contact.friction", "coefficient of friction between disks"),
    "wall_friction": ("wall.friction", "coefficient of friction of the walls"),
    "wall_stiffness": ("wall.normal_stiffness", "normal stiffness of walls in mean disk weights per mean radius"),
    "polydispersity": ("packing.polydispersity", "polydispersity"),
    "load": ("loads", f"applied force {WEIGHTS}"),
}


def simulate(parameters: given.Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``time_step_AXIS`` for each of ``time_steps.axes``."""
    p = parameters.time_steps
    tasks = {}
    for name, values in p.axes.items():
        for k, value in enumerate(values):
            loads = [{"disk": "top-centre", "force": [0.0, -value]}] if value else []
            changes = {AXES[name][0]: loads if name == "load" else value}
            scene = p.scene.updated({**changes, "protocol.time_step": "auto"})  # safe to come to rest with
            tasks[name, k] = partial(time_steps.tried, scene, p.integrators, p.ratios, p.steps, parameters.seed)
    found = computed(tasks, "time steps")

    def along(name: given.Axis) -> xr.Dataset:
        axis, ratio = (p.axes[name], AXES[name][1]), (p.ratios, "time step over the predicted limit")
        several: dict[Any, time_steps.Steps] = {
            (i, k): one for k in range(len(axis[0])) for i, one in enumerate(found[name, k])
        }
        return table_along(several, integrator=(p.integrators, "integrator"), **{name: axis}, ratio=ratio)

    return labelled({f"time_step_{name}": along(name) for name in p.axes})
