"""Motion from any start as labelled data."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..errors import require
from ..scene import Scene, SceneError
from ..scene.errors import show
from ..scene.laboratory import FORCE, LENGTH, MASS, TIME
from ..solvers.idle import idle_in_motion
from ..solvers.motion import trajectory
from ..solvers.solution import Progress
from ..state import State
from ..store import variables
from ..store.result import UNITS
from .result import described
from .terminal import logged, shown

#: Part of the largest energy of motion and springs by which energy may rise without loads until a warning says so:
#: a collision without dashpots is off by up to 4e-4 of it.
MOST_RISE = 0.01
#: What is known of each disk at each time.
_OF_DISKS = ("position", "velocity", "angle", "angular_velocity")


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
    ``loads=[]`` is a scene without one. The time step is ``protocol.time_step``, without one a 600th of the shortest
    collision (a 100th without friction and dashpots) or less: restitution is then right to 1e-3 of the speed. Other
    times change no bit of a trajectory. Preparation and ``stop_`` keys have no effect, and a warning says so.

    Parameters
    ----------
    scene : a scene, nested mappings with its keys, or the path of a scene file.
    times : in sqrt(R/g) since the start, growing, from 0 on.
    start : a state to begin with, such as ``result.rest``, with its springs; its velocities are those of the scene if
        the scene has a motion. Of one under load, loads name their disks by number (``result.loaded_disks``), and go
        from its load factor to 1: a state that ``load_factors`` have taken elsewhere needs a scene with its forces.
    progress : as of :func:`solve`.

    Returns
    -------
    With the dimension ``time``: ``position``, ``velocity`` (time, disk, axis), ``angle``, ``angular_velocity`` (time,
    disk); ``kinetic_energy``, ``rotational_energy``, ``potential_energy`` (in gravity, above the floor) and
    ``elastic_energy`` of all disks, and their sum ``energy``, which dashpots and sliding lower and loads change (of a
    tangential force at Coulomb's limit the part counts that the spring has, without the dashpot's; where it begins to
    stick its spring is as long as the dashpot has made it: a warning says so where energy rises by that);
    ``momentum`` (time, axis), ``angular_momentum`` (time) about the lower left corner of the box, ``contacts`` that are
    closed. With ``radius`` and ``mass``. All in reduced units.

    Raises granular_response.SceneError for times out of order, a motion of another number of disks, a scene for
    ``path`` or ``minimise``; granular_response.SolveError for a motion that blows up, or in which bodies overlap by a
    radius.

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
    rule = f"start: a {type(start).__name__}, must be a state, such as result.rest or result.loaded[-1]"
    require(isinstance(start, State | None), rule, SceneError)
    if start is not None and start.load_factor != 0.0:  # disks have moved, and a selector may find another one
        for k, load in enumerate(asked.loads):
            said = f"loads[{k}].disk = {show(load.disk)}: must be the number of a disk, since start is under load"
            require(isinstance(load.disk, int), f"{said}; result.loaded_disks has it", SceneError)
    for remark in idle_in_motion(asked):
        warnings.warn(remark, stacklevel=2)
    with shown(progress) as report, logged(report):
        found = trajectory(asked, times, start=start, progress=report)
    packing, states = found.problem.packing, found.states
    data = {name: variables.described(name, [getattr(one, name) for one in states], along="time") for name in _OF_DISKS}
    data |= {name: variables.described(name, getattr(packing, name)) for name in ("radius", "mass")}
    factors = [one.load_factor for one in states]
    data["load_factor"] = variables.described("state_load_factor", factors, along="time")
    moved = variables.labelled(xr.Dataset(data))
    sums = found.sums()
    moving = sums["kinetic_energy"] + sums["rotational_energy"] + sums["elastic_energy"]
    rise = float((sums["energy"] - np.minimum.accumulate(sums["energy"])).max())
    if not asked.loads and rise > MOST_RISE * moving.max():
        warnings.warn(
            f"the energy rises by up to {rise:.3g} mg R without a load: dashpots wind up the springs of contacts that "
            "slide, light disks most; a smaller contact.damping_ratio has less of it",
            stacklevel=2,
        )
    work, velocity = f"{FORCE} * {LENGTH}", f"{LENGTH} / {TIME}"
    units = {"momentum": f"{MASS} * {velocity}", "angular_momentum": f"{MASS} * {LENGTH} * {velocity}", "contacts": "1"}
    closed = np.array([one.pairs.touching.sum() + one.walls.touching.sum() for one in states])
    for name, values in {**sums, "contacts": closed}.items():
        labels = {"long_name": name.replace("_", " "), "units": units.get(name, work)}
        moved[name] = ("time", "axis")[: values.ndim], values, labels
    return moved.assign_coords(
        time=("time", found.times, {"long_name": "time", "units": TIME}), axis=["x", "z"]
    ).assign_attrs(
        title="motion of a granular packing",
        scene=asked.to_yaml(),
        width=packing.width,
        sides="periodic" if packing.periodic else "walls",
        time_step=found.time_step,
        units=UNITS,
    )
