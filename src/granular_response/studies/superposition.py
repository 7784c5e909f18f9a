"""Two forces at once against the sum of each alone: Figs. 23 and 24 (Sec. VI.B), claims U1 to U3.

Equal vertical forces act on two disks of the top row, as many places to the left as to the right of the middle
one: on the left one alone, on the right one alone, on both. All start from the same rest state, and every load
grows from zero. The superposition error is the size of ``both - left - right`` relative to that of ``both``, over
the added forces on the floor or over the added forces at all contacts, as vectors. A third single load, on the
middle disk, tells where the response of the slab ceases to be linear.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.difference import pair_force_difference
from granular_response.observe.floor import floor_disks, floor_force, smoothed_response
from granular_response.result import FORCE, LENGTH, certificates_dataset, common_candidates, variable
from granular_response.scene import Scene
from granular_response.solve import Problem, State, loaded_states, rest_state
from granular_response.solve.staircase import climb
from granular_response.sweep import Progress, map_tasks

FloatArray = NDArray[np.float64]

#: Which forces act.
PARTS = ("left", "right", "both")

#: Relative errors, with long names.
ERRORS = {
    "floor_error": "root mean square of both - left - right over that of both, floor forces",
    "floor_error_largest": "largest |both - left - right| over largest |both|, floor forces",
    "contact_error": "root mean square of both - left - right over that of both, contact forces as vectors",
    "contact_error_largest": "largest |both - left - right| over largest |both|, contact forces as vectors",
}


@dataclass(frozen=True)
class Loading:
    """A load path on a packing at rest."""

    scene: Scene
    rest: State
    forces: tuple[float, ...]


def settle(scene: Scene) -> State:
    """The rest state of a slab; raises what the solvers raise."""
    return rest_state(Problem.from_scene(scene))


def load(task: Loading) -> list[State]:
    """States at all forces, in stages unless the scene asks for a method; raises what the solvers raise."""
    problem = Problem.from_scene(task.scene).with_loads(task.rest.position)
    if task.scene.protocol.method != "auto":
        return loaded_states(problem, task.rest, task.forces)[1]
    states = [task.rest]
    for force in task.forces:
        states.append(climb(problem, states[-1], force)[0])
    return states[1:]


def simulate(
    parameters: Mapping[str, Any], *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``responses``, ``errors`` and ``linear_range``.

    Parameters
    ----------
    parameters
        ``method`` (of ``protocol``); ``scene``, changes to the default scene by paths of keys; ``realizations``
        of the radii; ``offsets`` of the loaded disks from the middle of the top row, in places; ``forces``,
        growing, of each load; ``width`` of the Gaussian and ``tolerance`` that tell the end of the linear range.
    workers, progress
        As of ``map_tasks``.

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    forces = tuple(float(force) for force in parameters["forces"])
    if len(forces) < 2 or not forces[0] > 0.0 or not np.all(np.diff(forces) > 0.0):
        raise ValueError(f"forces = {list(forces)}: must be two or more increasing numbers above 0")
    offsets = [int(offset) for offset in parameters["offsets"]]
    if not offsets or min(offsets) < 1:
        raise ValueError(f"offsets = {offsets}: must be places from 1 on")
    realizations = int(parameters["realizations"])
    if realizations < 1:
        raise ValueError(f"realizations = {realizations}: must be at least 1")
    base = Scene().updated({"protocol.method": parameters["method"], **parameters.get("scene", {})})
    scenes = [base.updated({"packing.realization": r, "loads": []}) for r in range(realizations)]
    rests = map_tasks(settle, scenes, workers=workers, progress=progress, what="rest")
    places = [[(0,)], *([(-k,), (k,), (-k, k)] for k in offsets)]
    tasks = [
        Loading(scene.updated({"loads": [_push(place) for place in at]}), rest, forces)
        for scene, rest in zip(scenes, rests, strict=True)
        for group in places
        for at in group
    ]
    found = iter(map_tasks(load, tasks, workers=workers, progress=progress, what="load paths"))

    packing = scenes[0].packing.build()
    disks = floor_disks([rests[0]], np.flatnonzero(packing.row == 0))
    shape = (realizations, len(offsets), len(forces))
    response = np.full((*shape, len(PARTS), len(disks)), np.nan)
    errors = {name: np.full(shape, np.nan) for name in ERRORS}
    x, position = np.empty((realizations, len(disks))), np.empty((realizations, len(offsets), 2))
    centre, change = np.empty(shape[::2]), np.empty(shape[::2])
    every: list[State] = []
    middle = int(Problem.from_scene(tasks[0].scene).with_loads(rests[0].position).load_disk[0])
    for r, (scene, rest) in enumerate(zip(scenes, rests, strict=True)):
        packing = scene.packing.build()
        x[r] = rest.position[disks, 0] - rest.position[middle, 0]
        alone = next(found)
        every += alone
        centre[r], change[r] = _linearity(rest, alone, packing, disks, x[r], forces, float(parameters["width"]))
        for o, offset in enumerate(offsets):
            position[r, o] = rest.position[[middle - offset, middle + offset], 0] - rest.position[middle, 0]
            paths = [next(found) for _ in PARTS]
            for f, force in enumerate(forces):
                start, *loaded = common_candidates(
                    [rest, *(path[f] for path in paths)], packing.radius, packing.width
                )
                every += loaded
                added = [floor_force(state, disks) - floor_force(start, disks) for state in loaded]
                response[r, o, f] = np.array(added) / force
                contact = [pair_force_difference(start, state) for state in loaded]
                for name, values in (("floor_error", added), ("contact_error", contact)):
                    errors[name][r, o, f], errors[f"{name}_largest"][r, o, f] = superposition_error(*values)
    return _datasets(base, offsets, forces, disks, x, position, response, errors, centre, change, every, parameters)


def _push(place: int) -> dict[str, Any]:
    return {"disk": {"row": "top", "offset": place}, "force": [0.0, -1.0]}


def superposition_error(left: FloatArray, right: FloatArray, both: FloatArray) -> tuple[float, float]:
    """Relative size of ``both - left - right``: root mean square, and largest.

    Forces are (k,) or, as vectors, (k, 2). nan where ``both`` is zero.
    """
    rest, whole = (np.linalg.norm(v.reshape(len(v), -1), axis=1) for v in (both - left - right, both))
    largest = float(whole.max())
    if not largest > 0.0:
        return float("nan"), float("nan")
    return float(np.linalg.norm(rest) / np.linalg.norm(whole)), float(rest.max() / largest)


def _linearity(rest, alone, packing, disks, x, forces, width) -> tuple[FloatArray, FloatArray]:
    """Smoothed response at x = 0, and the change of all contact forces per force, against the smallest force."""
    centre, change = [], []
    first = None
    for state, force in zip(alone, forces, strict=True):
        start, loaded = common_candidates([rest, state], packing.radius, packing.width)
        response = (floor_force(loaded, disks) - floor_force(start, disks)) / force
        centre.append(float(smoothed_response([0.0], x, response, width)[0]))
        added = _by_pair(start, pair_force_difference(start, loaded) / force, packing.n)
        first = added if first is None else first
        keys = first.keys() | added.keys()
        none = np.zeros(2)
        differ = sum(float(np.sum((added.get(k, none) - first.get(k, none)) ** 2)) for k in sorted(keys))
        change.append(np.sqrt(differ / sum(float(np.sum(v**2)) for v in first.values())))
    return np.array(centre), np.array(change)


def _by_pair(state: State, force: FloatArray, n: int) -> dict[int, FloatArray]:
    """Forces (m, 2) by a number of the pair that does not depend on the list of candidates."""
    keys = state.pairs.first.astype(np.int64) * n + state.pairs.second
    return {int(key): value for key, value in zip(keys, force, strict=True)}


def _datasets(
    base, offsets, forces, disks, x, position, response, errors, centre, change, every, parameters
) -> dict[str, xr.Dataset]:
    spacing = 2.0
    coordinates = {
        "distance": variable(
            ("distance",),
            spacing * np.array(offsets, dtype=float),
            "places between the two loaded disks, that is their distance in mean disk diameters",
        ),
        "force": variable(("force",), np.array(forces), f"each of the applied forces {FORCE}"),
    }
    dims = ("realization", "distance", "force")
    responses = xr.Dataset(
        {
            "floor_response": variable(
                (*dims, "part", "floor_disk"),
                response,
                "vertical floor force that the load adds, per force on one disk",
            ),
            "x": variable(
                ("realization", "floor_disk"), x, f"rest position of a floor disk from the middle disk on top {LENGTH}"
            ),
            "load_x": variable(
                ("realization", "distance", "side"), position, f"rest position of the loaded disks {LENGTH}"
            ),
        },
        coords={
            **coordinates,
            "floor_disk": variable(("floor_disk",), disks, "index of the floor disk"),
            "part": variable(("part",), list(PARTS), "which of the forces act"),
            "side": variable(("side",), list(PARTS[:2]), "which of the loaded disks"),
        },
    )
    table = xr.Dataset({name: variable(dims, errors[name], text) for name, text in ERRORS.items()}, coords=coordinates)
    worst = certificates_dataset(every)
    table = table.assign(
        {
            f"{name}_of_all": variable((), float(np.abs(values.values).max()), f"{values.attrs['long_name']}, any state")
            for name, values in worst.data_vars.items()
            if name != "certificate_smallest_normal_force"
        }
    )
    tolerance = float(parameters["tolerance"])
    away = np.abs(centre / centre[:, :1] - 1.0) > tolerance
    first = np.where(away.any(axis=1), away.argmax(axis=1), len(forces))
    after = np.append(forces, np.nan)[first]
    before = np.asarray(forces)[first - 1]
    linear = xr.Dataset(
        {
            "response_at_centre": variable(
                ("realization", "force"),
                centre,
                "smoothed response to one force on the middle disk at x = 0, stress per applied force in 1/mean radius",
            ),
            "contact_change": variable(
                ("realization", "force"),
                change,
                "root mean square change of the added contact forces per force, relative to the smallest force",
            ),
            "linear_until": variable(
                ("realization",), before, f"last force {FORCE} at which the response at x = 0 is that to the smallest"
            ),
            "nonlinear_from": variable(("realization",), after, f"first force {FORCE} at which it is not; nan for none"),
        },
        coords={"force": coordinates["force"]},
        attrs={"width": float(parameters["width"]), "tolerance": tolerance},
    )
    datasets = {"responses": responses, "errors": table, "linear_range": linear}
    for dataset in datasets.values():
        dataset.attrs.update(scene=base.to_yaml(), units="reduced: mean disk radius, mean disk mass, g")
    return datasets
