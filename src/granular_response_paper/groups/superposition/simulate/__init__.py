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

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.difference import pair_force_difference
from granular_response.observe.floor import floor_force, smoothed_response
from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.state import Contacts, FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.studies import by_motion, linear_end
from granular_response.sweeps.rest import rest_of
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.superposition.parameters import Parameters
from granular_response_paper.records import axes, column, places, record, table, variables
from granular_response_paper.tasks import computed


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``responses``, ``errors`` and ``linear_range``.

    SweepError
        If a realization does not come to rest, at rest or under a load: none is left out in silence.
    """
    asked, offsets, drawn = parameters, parameters.offsets, range(parameters.realizations)
    scenes = {r: asked.base.updated({"packing.realization": r}) for r in drawn}
    rests = computed({r: partial(rest_of, scene) for r, scene in scenes.items()}, "rest")
    singles = computed({r: partial(load_single, scene, rests[r], asked) for r, scene in scenes.items()}, "single loads")
    two = places(drawn, offsets)
    both = {at: partial(load_pair, scenes[r], rests[r], offset, asked.forces) for at, (r, offset) in two}
    pairs = computed(both, "pairs of loads")

    packing, middle = asked.base.packing.build(), f"from the middle disk on top {RADII}"
    load_x = [[pairs[r, k].load_x - singles[r].load_x for k in range(len(offsets))] for r in drawn]
    where = variables(
        x=("realization floor_disk", [singles[r].x for r in drawn], f"rest position of a floor disk {middle}"),
        load_x=("realization distance side", load_x, f"rest position of the loaded disks {middle}"),
    )
    apart = "places between the two loaded disks, their distance in mean disk diameters"
    coordinates = axes(
        distance=(2.0 * np.array(offsets), apart), force=(asked.forces, f"each of the two applied forces {WEIGHTS}")
    )
    further = axes(
        floor_disk=(np.flatnonzero(packing.row == 0), "index of the floor disk"),
        part=(PARTS, "which of the forces act"),
        side=(PARTS[:2], "which of the loaded disks"),
    )
    gaps = np.sqrt(3.0) * (np.arange(int(packing.row.max())) + 0.5)
    depth = axes(gap=(gaps, f"depth below the top row, on the lattice {RADII}"))
    found, responses = table(pairs, "realization", "distance"), ["floor_response", "by_motion"]
    linear = table(list(singles.values()), "realization").assign_coords(
        axes(force=(asked.single_forces, f"force on the middle disk {WEIGHTS}"))
    )
    datasets = {
        "responses": found[responses].assign(where).assign_coords(coordinates | further),
        "errors": found.drop_vars(responses).assign_coords(coordinates | depth),
        "linear_range": linear.assign_attrs(width=asked.width, tolerance=asked.tolerance),
    }
    return labelled(datasets, asked.base)


#: Which forces act.
PARTS = ("left", "right", "both")
#: Sizes of an error, what of, and over which states the worst of a certificate is taken.
TYPICAL = "root mean square of both - left - right over that of both"
LARGEST = "largest |both - left - right| over largest |both|"
VECTORS, ANY = "as vectors", "any force and part"


@record
class Pair:
    """What two loads on a packing add, alone and together; relative errors of the sum, and the worst certificates."""

    load_x: FloatArray  #: (2,) rest position of the loaded disks
    floor_response: FloatArray = column(
        "vertical floor force that the load adds, per force on one disk", "force", "part", "floor_disk"
    )
    by_motion: NDArray[np.int8] = column(
        "1 where the motion of the disks had a part in what led here from the force before", "force", "part"
    )
    floor_error: FloatArray = column(f"{TYPICAL}, floor forces", "force")
    floor_error_largest: FloatArray = column(f"{LARGEST}, floor forces", "force")
    contact_error: FloatArray = column(f"{TYPICAL}, contact forces {VECTORS}", "force")
    contact_error_largest: FloatArray = column(f"{LARGEST}, contact forces {VECTORS}", "force")
    row_error: FloatArray = column(
        f"{TYPICAL}, contact forces between two rows, {VECTORS}", "force", "gap"
    )  #: from above
    certificate_force_residual: float = column(f"largest unbalanced force on a disk {WEIGHTS}, {ANY}")
    certificate_torque_residual: float = column(
        f"largest unbalanced torque on a disk in mean weight times mean radius, {ANY}"
    )
    certificate_coulomb_excess: float = column(
        f"largest excess of a tangential force over the Coulomb limit {WEIGHTS}, {ANY}"
    )
    certificate_negative_modes: float = column(f"unstable directions of the tangent stiffness, {ANY}")


@record
class Single:
    """One load on the middle disk."""

    response_at_centre: FloatArray = column(
        "smoothed response to one force on the middle disk at x = 0, stress per applied force in 1/mean radius", "force"
    )
    contact_change: FloatArray = column(
        "change of the contact forces per force that one force adds, root mean square, relative to those "
        "at the smallest force",
        "force",
    )
    linear_until: float = column(
        f"last force {WEIGHTS} up to which the response at x = 0 is that to the smallest force"
    )
    nonlinear_from: float = column(f"first force {WEIGHTS} at which it is not; nan for none")
    load_x: float  #: rest position of the loaded disk
    x: FloatArray  #: rest positions of the floor disks from there


def load_pair(scene: Scene, rest: State, offset: int, forces: Sequence[float]) -> Pair:
    """Left, right and both, ``offset`` places from the middle of the top row; raises what the solvers raise."""
    paths = [_path(scene, rest, places, forces) for places in ((-offset,), (offset,), (-offset, offset))]
    states = [state for path, _ in paths for state in path]
    packing, grid = scene.packing.build(), (len(PARTS), len(forces))
    pairs, *added = _added(packing, rest, states)
    on_floor, at_contact = (one.reshape(*grid, *one.shape[1:]) for one in added)

    def errors(of: FloatArray) -> FloatArray:
        """(2, force) of forces (part, force, ...)."""
        return np.array([superposition_error(*of[:, f]) for f in range(len(forces))]).T

    first, second = packing.row[pairs.first], packing.row[pairs.second]
    gap = np.where(first == second, -1, np.minimum(first, second))  # the row below it
    rows = [errors(at_contact[:, :, gap == row])[0] for row in reversed(range(int(packing.row.max())))]
    entries = ("force_residual", "torque_residual", "coulomb_excess", "negative_modes")
    worst = {f"certificate_{name}": max(getattr(one.certificate, name) for one in states) for name in entries}
    moved = np.array([by_motion(state) for state in states], np.int8).reshape(grid).T
    response = np.moveaxis(on_floor, 0, 1) / np.array(forces)[:, None, None]
    found = (*errors(on_floor), *errors(at_contact), np.stack(rows, axis=1))
    return Pair(paths[-1][1], response, moved, *found, **worst)


def load_single(scene: Scene, rest: State, asked: Parameters) -> Single:
    """One load on the middle disk. Raises what the solvers raise."""
    states, (load_x,) = _path(scene, rest, (0,), asked.single_forces)
    packing, per = scene.packing.build(), np.array(asked.single_forces)
    _, on_floor, at_contact = _added(packing, rest, states)
    response, added = on_floor / per[:, None], at_contact / per[:, None, None]
    change = np.linalg.norm(added - added[0], axis=(1, 2)) / np.linalg.norm(added[0])
    x = rest.position[packing.row == 0, 0] - load_x
    centre = smoothed_response([0.0], x, response, asked.width)[:, 0]
    return Single(centre, change, *linear_end(per, centre, asked.tolerance), load_x, x)


def _path(scene: Scene, rest: State, places: Sequence[int], forces: Sequence[float]) -> tuple[list[State], FloatArray]:
    """States at all forces, and where the loaded disks are at rest."""
    loads = [{"disk": {"row": "top", "offset": place}, "force": [0.0, -1.0]} for place in places]
    problem = Problem.from_scene(scene.updated({"loads": loads})).with_loads(rest.position)
    return loaded_states(problem, rest, forces)[1], rest.position[problem.load_disk, 0]


def _added(packing: Packing, rest: State, states: Sequence[State]) -> tuple[Contacts, FloatArray, FloatArray]:
    """The contacts (m,) of all states, and what is added at rest: on the floor (state, disk), at them (state, m, 2)."""
    rest, *loaded = common_candidates([rest, *states], packing.radius)
    disks = np.flatnonzero(packing.row == 0)
    on_floor = np.array([floor_force(state, disks) for state in loaded]) - floor_force(rest, disks)
    return rest.pairs, on_floor, np.array([pair_force_difference(rest, state) for state in loaded])


def superposition_error(left: FloatArray, right: FloatArray, both: FloatArray) -> tuple[float, float]:
    """Relative size of ``both - left - right``: root mean square, and largest.

    Forces are (k,) or, as vectors, (k, 2). nan where ``both`` is zero.
    """
    rest, whole = (np.linalg.norm(v.reshape(len(v), -1), axis=1) for v in (both - left - right, both))
    largest = float(whole.max(initial=0.0))
    if not largest > 0.0:
        return float("nan"), float("nan")
    return float(np.linalg.norm(rest) / np.linalg.norm(whole)), float(rest.max() / largest)
