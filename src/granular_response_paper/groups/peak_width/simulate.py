"""How wide the response is at every depth of a slab, and on the floor of slabs of many heights.

An elastic body knows no length, so under a force its response is as wide as it is deep. Where force diffuses through
disorder, from disk to disk, it is as wide as the root of the depth. Where forces run along rays, there are two peaks
whose distance grows as the depth, each as wide as its root. (Sec. II.)

The stress inside is that on horizontal lines between the rows (``observe.stress.line_stress``), of what the load adds;
the floor is the last of these lines. Depth is that below the surface of the elastic slab that stands for the packing,
half a row above the centres of the top row. ``inside`` has the profiles of the highest slab of each case, ``floors``
those on the floor of all of them, each beside an elastic slab of the same height, of the moduli of the lattice of the
same contacts.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.floor import interior_mask
from granular_response.observe.stress import ContactForces, given_forces, line_forces, line_stress, load_forces
from granular_response.observe.widths import DEFINITIONS, FITS, lengths, powers
from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import contact_answers
from granular_response.solvers.solution import loaded_states
from granular_response.state import FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.sweeps.rest import rest_state
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.slab import Slab as ElasticSlab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.peak_width.parameters import LEAST_REALIZATIONS, Case, Parameters
from granular_response_paper.parameters import material
from granular_response_paper.records import axes, column, columns, labels, record, table
from granular_response_paper.survey.crossover import CONFIDENCE, folded, weights
from granular_response_paper.survey.packings import measured

#: Height of the line that stands for the floor (radii): below all centres, above what the floor contacts rest on.
FLOOR_LINE = 1e-6
SURVEYED = "1 where the packings are those of the survey"


@record
class Slab:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column("friction, of floor and walls too")
    gravity: str = column("how gravity was applied")
    force: float = column(f"at the reference height {WEIGHTS}; 0 is the limit of small ones")
    layers: int = column("number of rows")
    realization: int = column("realization of the disorder")


@record
class Outcome:
    height: float = column(f"height of the surface {RADII}")
    depth: FloatArray = column(f"depth below the surface {RADII}", "line")  #: the last one is the floor
    profile: FloatArray = column("vertical stress per force, times depth", "line", "t")  #: symmetric, mean over loads
    transmitted: FloatArray = column("part of the force that crosses the line", "line")
    loads: float = column("small loads on the packing")


@record
class Widths:
    """What is found of one case, along the lines of its highest slab or the floors of its slabs."""

    depth: FloatArray = column(f"depth below the surface {RADII}", "along")
    profile: FloatArray = column("vertical stress per force, times depth", "along", "t")
    elastic_profile: FloatArray = column("the same in the elastic slab of the same height", "along", "t")
    length: FloatArray = column(f"length by each definition {RADII}", "along", "definition")
    elastic_length: FloatArray = column(f"the same in the elastic slab {RADII}", "along", "definition")
    transmitted: FloatArray = column("part of the force that crosses the line", "along")
    power: FloatArray = column("power of depth with which the length grows", "definition", "fit")
    interval: FloatArray = column(
        "95 % interval of the first of these; of a lattice the range over the fits", "definition", "level"
    )
    elastic_power: FloatArray = column("the same powers in the elastic slab", "definition", "fit")


@record
class Inside(Widths):
    fitted: FloatArray = column("1 where the line is fitted", "along")
    loads: float = column("small loads on a packing")
    layers: int = column("number of layers")
    surveyed: float = column(SURVEYED)


@record
class Floors(Widths):
    layers: FloatArray = column("number of layers", "along")
    packings: FloatArray = column("number of packings", "along")
    surveyed: FloatArray = column(SURVEYED, "along")


def grid(parameters: Parameters) -> FloatArray:
    """Distances from the axis, in depths."""
    return np.arange(round(parameters.reach / parameters.spacing) + 1, dtype=float) * parameters.spacing


def compute(scene: Scene, force: float, loads: int, margin: float, lines: int, width: float, t: FloatArray) -> Outcome:
    """One packing; ``scene`` has one load, of unit force.

    ``force`` is 0 for small ones: on disordered packings as many as ``loads``, farther than ``margin`` (heights) from
    the side walls. Profiles are on at most as many ``lines``, with a Gaussian of w = ``width``, at distances ``t`` in
    depths. Raises what the solvers raise.
    """
    problem = Problem.from_scene(scene)
    rest, packing = rest_state(problem), problem.packing
    problem = problem.with_loads(rest.position)
    z = rest.position[:, 1]
    rows = np.array([z[packing.row == row].mean() for row in range(int(packing.row.max()) + 1)])
    half_row = 0.5 * (rows[-1] - rows[0]) / (len(rows) - 1)
    surface = rows[-1] + half_row
    between = 0.5 * (rows[1:] + rows[:-1])[::-1]
    taken = np.unique(np.geomspace(1.0, len(between), min(lines, len(between))).round().astype(int)) - 1
    line = np.append(between[taken], FLOOR_LINE)
    depth = surface - line
    depth[-1] = surface
    if not force:
        disks = loaded_disks(packing, rest, margin * surface, loads if np.ptp(packing.radius) else 1)
        answers = contact_answers(problem, rest, disks, sliding="stick")
        borne = [k for k in range(len(disks)) if np.isfinite(answers[0][k]).all()]
        fields = [(given_forces(rest, answers[0][k], answers[1][k]), rest.position[disks[k], 0], 1.0) for k in borne]
    else:
        _, (loaded,) = loaded_states(problem, rest, [force])
        start, end = common_candidates([rest, loaded], packing.radius)
        middle = rest.position[int(problem.load_disk[0]), 0]
        fields = [(load_forces(start, end), middle, force)]
    at = list(zip(line, depth, strict=True))
    profiles = [[scaled(forces, x, *place, t, width) / size for place in at] for forces, x, size in fields]
    transmitted = [[line_forces(forces, height)[1].sum() / size for height in line] for forces, _, size in fields]
    return Outcome(surface, depth, np.mean(profiles, axis=0), np.mean(transmitted, axis=0), len(fields))


def loaded_disks(packing: Packing, rest: State, margin: float, count: int) -> NDArray[np.intp]:
    """At most ``count`` disks of the top row, evenly spread over what is ``margin`` from the side walls.

    The one nearest the middle for a count of one.
    """
    x = rest.position[:, 0]
    top = np.flatnonzero(packing.row == packing.row.max())
    if count == 1:
        return top[[np.argmin(np.abs(x[top] - 0.5 * packing.width))]]
    inside = top[interior_mask(x[top], packing.width, margin)]
    inside = inside[np.argsort(x[inside], kind="stable")]
    return inside[np.unique(np.linspace(0, len(inside) - 1, min(count, len(inside))).round().astype(int))]


def scaled(forces: ContactForces, x: float, height: float, depth: float, t: FloatArray, width: float) -> FloatArray:
    """(len(t),) stress times depth on the line at ``height`` at distances ``t`` depths from ``x``, made symmetric."""
    both = np.concatenate([-t[:0:-1], t])
    return folded(line_stress(forces, height, x + depth * both, width)) * depth


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``inside`` and ``floors``."""
    outcomes = measured(parameters, "slabs", packings, task, Outcome)
    each = [
        (case, [[outcomes[c, h, r] for r in range(case.count(h))] for h in range(len(case.heights))])
        for c, case in enumerate(parameters.cases)
    ]
    inside = table([_inside(parameters, case, found[-1]) for case, found in each], "case").rename_dims(along="line")
    floors = table([_floors(parameters, case, found) for case, found in each], "case").rename_dims(along="slab")
    given = {"fitted": list(parameters.fitted), "width": parameters.width}
    datasets = {
        "inside": inside.assign_coords(_coordinates(parameters, "of the lines")).assign_attrs(given),
        "floors": floors.assign_coords(_coordinates(parameters, "of the slabs")).assign_attrs(given),
    }
    return labelled(datasets, parameters.base)


def packings(parameters: Parameters, *, surveyed: bool) -> dict[tuple[int, int, int], Slab]:
    """The slabs of the survey, or all others, by their places: of the case, of its height, and the realization."""
    return {
        (c, h, r): Slab(case.polydispersity, case.friction, case.gravity, case.force or 0.0, case.heights[h], r)
        for c, case in enumerate(parameters.cases)
        for h in range(len(case.heights))
        for r in range(case.count(h))
        if (h >= len(case.layers)) == surveyed
    }


def task(asked: Parameters, slab: Slab) -> partial[Outcome]:
    """One slab of a case."""
    scale = slab.layers / asked.reference_layers
    scene = asked.base.updated(
        material(slab.polydispersity, slab.realization, slab.friction)
        | {
            "packing.layers": slab.layers,
            "packing.disks_per_row": asked.disks_per_layer * slab.layers + 1,
            "contact.normal_stiffness": asked.base.contact.normal_stiffness * scale,
            "preparation.gravity": slab.gravity,
        }
    )
    force = slab.force * scale**2
    return partial(compute, scene, force, asked.loads, asked.margin, asked.lines, asked.width, grid(asked))


def elastic(case: Case, parameters: Parameters, height: float, depth: FloatArray) -> FloatArray:
    """(line, t) scaled profiles of the elastic slab, coarse-grained along x as those of the packing."""
    ratio = parameters.base.contact.stiffness_ratio if case.friction > 0.0 else 0.0
    slab = ElasticSlab(
        height, lattice.moduli(Springs.uniform(1.0, ratio), "free"), "rough" if case.friction > 0.0 else "smooth"
    )
    t, deviation = grid(parameters), parameters.width / np.sqrt(2.0)
    return np.stack([-slab.stress(t * z, max(height - z, 0.0), 1.0, deviation)[1] * z for z in depth])


def drawn(profile: FloatArray, seed: int, asked: Parameters) -> FloatArray | None:
    """(draw, ...) means of bootstrap draws over the realizations (r, ...); None where these are too few."""
    count = len(profile)
    if count < LEAST_REALIZATIONS:
        return None
    return np.einsum("wr,r...->w...", weights(count, asked.draws, seed) / count, profile)


def widths(
    asked: Parameters,
    depth: FloatArray,
    profile: FloatArray,
    elastic_profile: FloatArray,
    draws: FloatArray | None,
    used: NDArray[np.bool_],
) -> dict[str, FloatArray]:
    """Fields of :class:`Widths`, of mean profiles (d, t) at ``depth`` (d,).

    Powers are over the depths that are ``used`` (d,). Their interval has 95 % of the ``draws`` (draw, used, t) of
    profiles; without any it is the range over the fits.
    """
    t = grid(asked)
    length, elastic_length = (lengths(t, one, asked.tolerance) * depth[:, None] for one in (profile, elastic_profile))
    power, elastic_power = (powers(depth[used], one[used].T) for one in (length, elastic_length))
    if draws is None:
        interval = np.stack([power.min(axis=-1), power.max(axis=-1)], axis=-1)
    else:
        all_ = lengths(t, draws, asked.tolerance) * depth[used][:, None]
        # nan where a draw has none
        interval = np.quantile(powers(depth[used], np.swapaxes(all_, 1, 2))[..., 0], CONFIDENCE, axis=0).T
    return {
        "depth": depth, "profile": profile, "elastic_profile": elastic_profile,
        "length": length, "elastic_length": elastic_length,
        "power": power, "interval": interval, "elastic_power": elastic_power,
    }  # fmt: skip


def _inside(parameters: Parameters, case: Case, found: list[Outcome]) -> Inside:
    """Of the highest slab of a case: profiles on all lines, powers over those that are fitted."""
    depth = np.mean([one.depth for one in found], axis=0)
    height = float(np.mean([one.height for one in found]))
    profile = np.stack([one.profile for one in found])
    used = (depth >= parameters.fitted[0]) & (depth <= parameters.fitted[1] * height)
    draws = drawn(profile[:, used], parameters.seed, parameters)
    return Inside(
        **widths(parameters, depth, profile.mean(axis=0), elastic(case, parameters, height, depth), draws, used),
        transmitted=np.mean([one.transmitted for one in found], axis=0),
        fitted=used.astype(float),
        loads=float(np.mean([one.loads for one in found])),
        layers=case.heights[-1],
        surveyed=float(bool(case.surveyed)),
    )


def _floors(parameters: Parameters, case: Case, found: list[list[Outcome]]) -> Floors:
    """On the floors of the slabs of a case."""
    height = np.array([np.mean([one.height for one in row]) for row in found])
    floors = [np.stack([one.profile[-1] for one in row]) for row in found]
    # packings of different heights have nothing to do with each other
    each = [drawn(floor, parameters.seed + h, parameters) for h, floor in enumerate(floors)]
    some = [one for one in each if one is not None]
    draws = np.stack(some, axis=1) if len(some) == len(each) else None
    profile = np.stack([floor.mean(axis=0) for floor in floors])
    reference = np.concatenate([elastic(case, parameters, h, np.array([h])) for h in height])
    return Floors(
        **widths(parameters, height, profile, reference, draws, np.full(len(height), True)),
        transmitted=np.array([np.mean([one.transmitted[-1] for one in row]) for row in found]),
        layers=np.array(case.heights, float),
        packings=np.array([float(len(row)) for row in found]),
        surveyed=np.array([float(layers in case.surveyed) for layers in case.heights]),
    )


def _coordinates(parameters: Parameters, what: str) -> dict[str, xr.Variable]:
    cases, of = parameters.cases, {name: one.long_name for name, one in columns(Slab).items()}
    texts = {name: of[name] for name in ("polydispersity", "friction", "gravity")}
    force = np.array([case.force or 0.0 for case in cases])
    return {
        **labels("case", cases, **texts, realizations="number of realizations"),
        "force": variable("case", force, of["force"]),
        **axes(
            t=(grid(parameters), "distance from the load per depth"),
            definition=(DEFINITIONS, "lengths"),
            fit=(FITS, f"depths {what} that are used"),
            level=(CONFIDENCE, "ends of the interval"),
        ),
    }
