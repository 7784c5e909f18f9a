"""Motion from any start as labelled data."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..scene import Scene
from ..scene.laboratory import FORCE, LENGTH, MASS, TIME
from ..solvers.motion import trajectory
from ..solvers.solution import Progress
from ..state import State
from ..store.result import UNITS
from . import compiling
from .result import described
from .terminal import shown


def motion(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    times: Sequence[float] | np.ndarray,
    *,
    start: State | None = None,
    progress: Progress | bool = True,
) -> xr.Dataset:
    """The motion of the disks of a scene at given times, by dynamics, from the start that the scene describes.

    Disks begin where the packing has them, with the velocities and spins of ``scene.motion``, and move under gravity,
    their contacts and the loads, which grow to their values over ``protocol.ramp_time``. ``Scene()`` has a load:
    ``loads=[]`` is a scene without one. The time step is ``protocol.time_step``; other times change no trajectory.

    Parameters
    ----------
    scene : a scene, nested mappings with its keys, or the path of a scene file.
    times : in sqrt(R/g) since the start, growing, from 0 on.
    start : a state to begin with, such as ``result.rest``, with its springs; its velocities are those of the scene if
        the scene has a motion.
    progress : as of :func:`solve`.

    Returns
    -------
    With the dimension ``time``: ``position``, ``velocity`` (time, disk, axis), ``angle``, ``angular_velocity`` (time,
    disk); ``kinetic_energy``, ``rotational_energy``, ``potential_energy`` (in gravity, above the floor) and
    ``elastic_energy`` of all disks, and their sum ``energy``, which dashpots and sliding lower and loads change;
    ``momentum`` (time, axis), ``angular_momentum`` (time) about the lower left corner of the box, ``contacts`` that are
    closed. With ``radius`` and ``mass``. All in reduced units.

    Raises
    ------
    granular_response.SceneError
        For times out of order, a motion of another number of disks, a scene for ``path`` or ``minimise``.
    granular_response.SolveError
        For a motion that blows up.

    Examples
    --------
    >>> ball = gr.Scene.from_arrays(x=[5.0], z=[3.0], radius=1.0, width=10.0, vx=0.5, scene={"loads": []})
    >>> fall = gr.motion(ball, [0.0, 1.0])
    >>> [round(float(value), 6) for value in fall["position"].isel(time=1, disk=0)]
    [5.5, 2.5]
    >>> bool(abs(fall["energy"].diff("time")) < 1e-9)
    True
    """
    asked = described(scene)
    with shown(progress) as report, compiling.logged(report):
        found = trajectory(asked, times, start=start, progress=report)
    packing, states = found.problem.packing, found.states
    work, of_disks = f"{FORCE} * {LENGTH}", ("time", "disk")
    energies = {
        "kinetic_energy": found.translation,
        "rotational_energy": found.rotation,
        "potential_energy": found.height,
        "elastic_energy": found.elastic,
    }
    energies["energy"] = np.sum(list(energies.values()), axis=0)
    touching = [int(s.pairs.touching.sum() + s.walls.touching.sum()) for s in states]
    velocity = f"{LENGTH} / {TIME}"

    def of(name: str) -> np.ndarray:
        return np.stack([getattr(state, name) for state in states])

    data: dict[str, tuple[Any, np.ndarray, str]] = {
        "position": ((*of_disks, "axis"), of("position"), LENGTH),
        "velocity": ((*of_disks, "axis"), of("velocity"), velocity),
        "angle": (of_disks, of("angle"), "radian"),
        "angular_velocity": (of_disks, of("angular_velocity"), f"radian / {TIME}"),
        **{name: ("time", values, work) for name, values in energies.items()},
        "momentum": (("time", "axis"), found.momentum, f"{MASS} * {velocity}"),
        "angular_momentum": ("time", found.angular_momentum, f"{MASS} * {LENGTH} * {velocity}"),
        "contacts": ("time", np.array(touching), "1"),
        "load_factor": ("time", np.array([state.load_factor for state in states]), "1"),
        "radius": ("disk", packing.radius, LENGTH),
        "mass": ("disk", packing.mass, MASS),
    }
    labels = {name: name.replace("_", " ") for name in data} | {"contacts": "closed contacts"}
    return xr.Dataset(
        {name: (dims, one, {"long_name": labels[name], "units": unit}) for name, (dims, one, unit) in data.items()},
        {"time": ("time", found.times, {"long_name": "time", "units": TIME}), "axis": ["x", "z"]},
        {
            "title": "motion of a granular packing",
            "scene": asked.to_yaml(),
            "width": packing.width,
            "sides": "periodic" if packing.periodic else "walls",
            "time_step": found.time_step,
            "units": UNITS,
        },
    )
