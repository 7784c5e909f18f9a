"""Two forces at once against the sum of each alone: Figs. 23 and 24 (Sec. VI.B), claims U1 to U3.

Equal vertical forces act on two disks of the top row, as many places to the left as to the right of the middle
one: on the left one alone, on the right one alone, on both. All three start from the same rest state, and every load
grows from zero. The superposition error is the size of ``both - left - right`` relative to that of ``both``: over
the added forces on the floor, over the added forces at all contacts as vectors, and over those between neighbouring
rows, which tells how it changes with depth. A single load on the middle disk, on a path of its own, tells where the
response of the slab ceases to be linear.

The paper shows one realization; here are several, and where the motion of the disks had a part in a path is stored.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.difference import pair_force_difference
from granular_response.observe.floor import floor_force, smoothed_response
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, common_candidates, variable
from granular_response.sweeps.rest import rest_of
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.superposition.parameters import Parameters
from granular_response_paper.slab_response import by_motion

BoolArray = NDArray[np.bool_]

#: Which forces act.
PARTS = ("left", "right", "both")

#: Relative errors of a floor force or a contact force, with long names.
ERRORS = {
    "floor_error": "root mean square of both - left - right over that of both, floor forces",
    "floor_error_largest": "largest |both - left - right| over largest |both|, floor forces",
    "contact_error": "root mean square of both - left - right over that of both, contact forces as vectors",
    "contact_error_largest": "largest |both - left - right| over largest |both|, contact forces as vectors",
}

#: Worst entries of the certificates of a pair of loads, with long names.
CERTIFIED = {
    "force_residual": f"largest unbalanced force on a disk {FORCE}",
    "torque_residual": "largest unbalanced torque on a disk in mean weight times mean radius",
    "coulomb_excess": f"largest excess of a tangential force over the Coulomb limit {FORCE}",
    "negative_modes": "unstable directions of the tangent stiffness",
}


@dataclass(frozen=True)
class Task:
    """A packing at rest that is to be loaded ``offset`` places to both sides of the middle of the top row."""

    scene: Scene
    rest: State
    offset: int  #: 0 for a single load on the middle disk
    forces: tuple[float, ...]


@dataclass(frozen=True)
class Pair:
    """Two loads on a packing, alone and together."""

    response: FloatArray  #: (forces, parts, floor disks) added floor force per force on one disk
    errors: Mapping[str, FloatArray]  #: ERRORS, each (forces,)
    row_error: FloatArray  #: (forces, rows - 1) root mean square errors between neighbouring rows, from below
    by_motion: BoolArray  #: (forces, parts) as the dataset says
    load_x: FloatArray  #: (2,) rest position of the loaded disks
    certified: Mapping[str, float]  #: CERTIFIED


@dataclass(frozen=True)
class Single:
    """One load on the middle disk."""

    response: FloatArray  #: (forces, floor disks) added floor force per force
    contact_change: FloatArray  #: (forces,) change of the added contact forces per force against the first force
    load_x: float  #: rest position of the loaded disk


def load_pair(task: Task) -> Pair:
    """Left, right and both; raises what the solvers raise."""
    sides = ((-task.offset,), (task.offset,), (-task.offset, task.offset))
    paths, load_x = [], np.empty(0)
    for places in sides:
        states, load_x = _path(task, places)  # the last one gives both positions
        paths.append(states)
    packing = task.scene.packing.build()
    count = len(task.forces)
    flat = [state for path in paths for state in path]
    rest, *flat = common_candidates([task.rest, *flat], packing.radius)
    paths = [flat[part * count : (part + 1) * count] for part in range(len(PARTS))]
    disks = np.flatnonzero(packing.row == 0)
    at_rest = floor_force(rest, disks)
    on_floor = np.array([[floor_force(state, disks) - at_rest for state in path] for path in paths])
    at_contact = np.array([[pair_force_difference(rest, state) for state in path] for path in paths])

    errors = {name: np.empty(count) for name in ERRORS}
    below = np.minimum(packing.row[rest.pairs.first], packing.row[rest.pairs.second])
    between = packing.row[rest.pairs.first] != packing.row[rest.pairs.second]
    row_error = np.empty((count, int(packing.row.max())))
    for f in range(count):
        for name, values in (("floor_error", on_floor[:, f]), ("contact_error", at_contact[:, f])):
            errors[name][f], errors[f"{name}_largest"][f] = superposition_error(*values)
        for row in range(row_error.shape[1]):
            row_error[f, row], _ = superposition_error(*at_contact[:, f, between & (below == row)])
    certificates = [state.certificate for state in flat]
    return Pair(
        response=np.moveaxis(on_floor, 0, 1) / np.array(task.forces)[:, None, None],
        errors=errors,
        row_error=row_error,
        by_motion=np.array([[by_motion(state) for state in path] for path in paths]).T,
        load_x=load_x,
        certified={name: float(max(getattr(c, name) for c in certificates)) for name in CERTIFIED},
    )


def load_single(task: Task) -> Single:
    """One load on the middle disk; raises what the solvers raise."""
    states, load_x = _path(task, (0,))
    packing = task.scene.packing.build()
    rest, *states = common_candidates([task.rest, *states], packing.radius)
    disks = np.flatnonzero(packing.row == 0)
    at_rest = floor_force(rest, disks)
    forces = np.array(task.forces)
    response = np.array([floor_force(state, disks) - at_rest for state in states]) / forces[:, None]
    added = np.array([pair_force_difference(rest, state) for state in states]) / forces[:, None, None]
    change = np.linalg.norm(added - added[0], axis=(1, 2)) / np.linalg.norm(added[0])
    return Single(response, change, float(load_x[0]))


def _path(task: Task, places: Sequence[int]) -> tuple[list[State], FloatArray]:
    """States at all forces, and where the loaded disks are at rest."""
    loads = [{"disk": {"row": "top", "offset": place}, "force": [0.0, -1.0]} for place in places]
    problem = Problem.from_scene(task.scene.updated({"loads": loads})).with_loads(task.rest.position)
    return loaded_states(problem, task.rest, task.forces)[1], task.rest.position[problem.load_disk, 0]


def superposition_error(left: FloatArray, right: FloatArray, both: FloatArray) -> tuple[float, float]:
    """Relative size of ``both - left - right``: root mean square, and largest.

    Forces are (k,) or, as vectors, (k, 2). nan where ``both`` is zero.
    """
    rest, whole = (np.linalg.norm(v.reshape(len(v), -1), axis=1) for v in (both - left - right, both))
    largest = float(whole.max(initial=0.0))
    if not largest > 0.0:
        return float("nan"), float("nan")
    return float(np.linalg.norm(rest) / np.linalg.norm(whole)), float(rest.max() / largest)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``responses``, ``errors`` and ``linear_range``.

    SweepError
        If a realization does not come to rest, at rest or under a load: none is left out in silence.
    """
    base, offsets, with_pairs = parameters.base, parameters.offsets, parameters.pair_realizations
    packing = base.packing.build()

    scenes = [base.updated({"packing.realization": r}) for r in range(parameters.realizations)]
    rests = map_tasks(rest_of, scenes, what="rest")
    settled = list(zip(scenes, rests, strict=True))
    single = [Task(scene, rest, 0, parameters.single_forces) for scene, rest in settled]
    singles = map_tasks(load_single, single, what="single loads")
    both = [Task(scene, rest, offset, parameters.forces) for scene, rest in settled[:with_pairs] for offset in offsets]
    pairs = map_tasks(load_pair, both, what="pairs of loads")

    disks = np.flatnonzero(packing.row == 0)
    x = np.array([rest.position[disks, 0] - one.load_x for rest, one in zip(rests, singles, strict=True)])
    coordinates = {
        "distance": variable(
            "distance",
            2.0 * np.array(offsets),
            "places between the two loaded disks, their distance in mean disk diameters",
        ),
        "force": variable("force", parameters.forces, f"each of the two applied forces {FORCE}"),
    }
    by_pair = [pairs[r * len(offsets) : (r + 1) * len(offsets)] for r in range(with_pairs)]
    datasets = {
        "responses": _responses(by_pair, singles[:with_pairs], x[:with_pairs], disks, coordinates),
        "errors": _errors(by_pair, int(packing.row.max()), coordinates),
        "linear_range": _linear_range(singles, x, parameters.single_forces, parameters.width, parameters.tolerance),
    }
    return labelled(datasets, base)


def _responses(
    pairs: Sequence[Sequence[Pair]],
    singles: Sequence[Single],
    x: FloatArray,
    disks: NDArray[np.intp],
    coordinates: Mapping[str, xr.Variable],
) -> xr.Dataset:
    load_x = np.array([[pair.load_x - one.load_x for pair in row] for row, one in zip(pairs, singles, strict=True)])
    return xr.Dataset(
        {
            "floor_response": variable(
                ("realization", "distance", "force", "part", "floor_disk"),
                [[pair.response for pair in row] for row in pairs],
                "vertical floor force that the load adds, per force on one disk",
            ),
            "by_motion": variable(
                ("realization", "distance", "force", "part"),
                np.array([[pair.by_motion for pair in row] for row in pairs], dtype=np.int8),
                "1 where the motion of the disks had a part in what led here from the force before",
            ),
            "x": variable(
                ("realization", "floor_disk"), x, f"rest position of a floor disk from the middle disk on top {LENGTH}"
            ),
            "load_x": variable(
                ("realization", "distance", "side"),
                load_x,
                f"rest position of the loaded disks from the middle disk on top {LENGTH}",
            ),
        },
        coords={
            **coordinates,
            "floor_disk": variable("floor_disk", disks, "index of the floor disk"),
            "part": variable("part", list(PARTS), "which of the forces act"),
            "side": variable("side", list(PARTS[:2]), "which of the loaded disks"),
        },
    )


def _errors(pairs: Sequence[Sequence[Pair]], gaps: int, coordinates: Mapping[str, xr.Variable]) -> xr.Dataset:
    dims = ("realization", "distance", "force")
    data = {
        name: variable(dims, [[pair.errors[name] for pair in row] for row in pairs], text)
        for name, text in ERRORS.items()
    }
    data["row_error"] = variable(
        (*dims, "gap"),
        [[pair.row_error[:, ::-1] for pair in row] for row in pairs],
        "root mean square of both - left - right over that of both, contact forces between two rows, as vectors",
    )
    for name, text in CERTIFIED.items():
        values = np.array([[pair.certified[name] for pair in row] for row in pairs])
        data[f"certificate_{name}"] = variable(dims[:2], values, f"{text}, any force and part")
    depth = np.sqrt(3.0) * (np.arange(gaps) + 0.5)
    return xr.Dataset(
        data,
        coords={**coordinates, "gap": variable("gap", depth, f"depth below the top row, on the lattice {LENGTH}")},
    )


def _linear_range(
    singles: Sequence[Single], x: FloatArray, forces: Sequence[float], width: float, tolerance: float
) -> xr.Dataset:
    centre = np.array(
        [smoothed_response([0.0], at, one.response, width)[:, 0] for at, one in zip(x, singles, strict=True)]
    )
    away = np.abs(centre / centre[:, :1] - 1.0) > tolerance
    first = np.where(away.any(axis=1), away.argmax(axis=1), len(forces))
    return xr.Dataset(
        {
            "response_at_centre": variable(
                ("realization", "force"),
                centre,
                "smoothed response to one force on the middle disk at x = 0, stress per applied force in 1/mean radius",
            ),
            "contact_change": variable(
                ("realization", "force"),
                [one.contact_change for one in singles],
                "change of the contact forces per force that one force adds, root mean square, relative to those "
                "at the smallest force",
            ),
            "linear_until": variable(
                "realization",
                np.array(forces)[first - 1],
                f"last force {FORCE} up to which the response at x = 0 is that to the smallest force",
            ),
            "nonlinear_from": variable(
                "realization", np.append(forces, np.nan)[first], f"first force {FORCE} at which it is not; nan for none"
            ),
        },
        coords={"force": variable("force", forces, f"force on the middle disk {FORCE}")},
        attrs={"width": width, "tolerance": tolerance},
    )
