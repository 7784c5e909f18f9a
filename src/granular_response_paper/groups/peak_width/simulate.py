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

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.floor import interior_mask
from granular_response.observe.stress import ContactForces, given_forces, line_forces, line_stress, load_forces
from granular_response.observe.widths import DEFINITIONS, FITS, lengths, powers
from granular_response.scene import Packing, Scene
from granular_response.solve import Problem, contact_answers, loaded_states
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, common_candidates, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import map_tasks
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.slab import Slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.peak_width.parameters import LEAST_REALIZATIONS, Case, Parameters
from granular_response_paper.survey.crossover import folded, weights
from granular_response_paper.survey.packings import Key, Layout, chosen

#: Height of the line that stands for the floor (radii): below all centres, above what the floor contacts rest on.
FLOOR_LINE = 1e-6
#: Ends of intervals.
LEVELS = (0.025, 0.975)


@dataclass(frozen=True)
class Task:
    """One packing, with one load of unit force."""

    scene: Scene
    force: float | None  #: None: small ones
    loads: int  #: as many small ones on disordered packings
    margin: float  #: of these from the side walls, in heights
    lines: int
    width: float  #: w of the Gaussian
    t: FloatArray  #: distances of the profiles, in depths


@dataclass(frozen=True)
class Outcome:
    height: float  #: of the surface over the floor
    depth: FloatArray  #: (line,) below the surface; the last one is the floor
    profile: FloatArray  #: (line, t) scaled, symmetric, mean over the loads
    transmitted: FloatArray  #: (line,) part of the force that crosses the line
    loads: float


#: How the survey stores them.
STORED = Layout(
    Outcome,
    {
        "polydispersity": "polydispersity",
        "friction": "friction, of floor and walls too",
        "gravity": "how gravity was applied",
        "force": f"at the reference height {FORCE}; 0 is the limit of small ones",
        "layers": "number of rows",
        "realization": "realization of the disorder",
    },
    {
        "height": ((), f"height of the surface {LENGTH}"),
        "depth": (("line",), f"depth below the surface {LENGTH}"),
        "profile": (("line", "t"), "vertical stress per force, times depth"),
        "transmitted": (("line",), "part of the force that crosses the line"),
        "loads": ((), "small loads on the packing"),
    },
)


def grid(parameters: Parameters) -> FloatArray:
    """Distances from the axis, in depths."""
    return np.arange(round(parameters.reach / parameters.spacing) + 1, dtype=float) * parameters.spacing


def compute(task: Task) -> Outcome:
    """Raises what the solvers raise."""
    problem = Problem.from_scene(task.scene)
    rest, packing, t = rest_state(problem), problem.packing, task.t
    problem = problem.with_loads(rest.position)
    z = rest.position[:, 1]
    rows = np.array([z[packing.row == row].mean() for row in range(int(packing.row.max()) + 1)])
    half_row = 0.5 * (rows[-1] - rows[0]) / (len(rows) - 1)
    surface = rows[-1] + half_row
    between = 0.5 * (rows[1:] + rows[:-1])[::-1]
    chosen = np.unique(np.geomspace(1.0, len(between), min(task.lines, len(between))).round().astype(int)) - 1
    line = np.append(between[chosen], FLOOR_LINE)
    depth = surface - line
    depth[-1] = surface
    if task.force is None:
        disks = loaded_disks(packing, rest, task.margin * surface, task.loads if packing_varies(task.scene) else 1)
        answers = contact_answers(problem, rest, disks, sliding="stick")
        borne = [k for k in range(len(disks)) if np.isfinite(answers[0][k]).all()]
        fields = [(given_forces(rest, answers[0][k], answers[1][k]), rest.position[disks[k], 0], 1.0) for k in borne]
    else:
        _, (loaded,) = loaded_states(problem, rest, [task.force])
        start, end = common_candidates([rest, loaded], packing.radius)
        middle = rest.position[int(problem.load_disk[0]), 0]
        fields = [(load_forces(start, end), middle, task.force)]
    profile = np.zeros((len(line), len(t)))
    transmitted = np.zeros(len(line))
    for forces, x, force in fields:
        for k in range(len(line)):
            profile[k] += scaled(forces, x, line[k], depth[k], t, task.width) / force
            transmitted[k] += line_forces(forces, line[k])[1].sum() / force
    return Outcome(surface, depth, profile / len(fields), transmitted / len(fields), len(fields))


def packing_varies(scene: Scene) -> bool:
    """Whether disks of one row differ."""
    return bool(scene.to_dict()["packing"].get("polydispersity", 0.0) > 0.0)


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
    own, stored = slabs(parameters, surveyed=False), slabs(parameters, surveyed=True)
    tasks = [task(parameters, *one) for one in own]
    found = map_tasks(compute, tasks, what="slabs")
    outcomes = dict(zip(own, found, strict=True))
    outcomes |= chosen(parameters.survey_file, STORED, {one: key(parameters, *one) for one in stored})
    datasets = {"inside": _inside(parameters, outcomes), "floors": _floors(parameters, outcomes)}
    for dataset in datasets.values():
        dataset.attrs.update({"fitted": list(parameters.fitted), "width": parameters.width})
    return labelled(datasets, parameters.base)


def slabs(parameters: Parameters, *, surveyed: bool) -> list[tuple[int, int, int]]:
    """Places of the slabs of the survey, or of all others: of the case, of its height, and the realization."""
    return [
        (c, h, r)
        for c, case in enumerate(parameters.cases)
        for h in range(len(case.heights))
        for r in range(case.count(h))
        if (h >= len(case.layers)) == surveyed
    ]


def key(parameters: Parameters, c: int, h: int, r: int) -> Key:
    """What tells a slab from others, as :data:`STORED` names it."""
    case = parameters.cases[c]
    return case.polydispersity, case.friction, case.gravity, case.force or 0.0, case.heights[h], r


def survey(parameters: Parameters) -> dict[Key, Task]:
    """The slabs that are left to the survey."""
    return {key(parameters, *one): task(parameters, *one) for one in slabs(parameters, surveyed=True)}


def task(parameters: Parameters, c: int, h: int, realization: int) -> Task:
    """One slab of a case."""
    case = parameters.cases[c]
    layers = case.heights[h]
    scale = layers / parameters.reference_layers
    scene = parameters.base.updated(
        {
            "packing.layers": layers,
            "packing.disks_per_row": parameters.disks_per_layer * layers + 1,
            "packing.polydispersity": case.polydispersity,
            "packing.realization": realization,
            "contact.normal_stiffness": parameters.base.contact.normal_stiffness * scale,
            "contact.friction": case.friction,
            "wall.friction": case.friction,
            "preparation.gravity": case.gravity,
        }
    )
    force = None if case.force is None else case.force * scale**2
    asked = parameters
    return Task(scene, force, asked.loads, asked.margin, asked.lines, asked.width, grid(asked))


def elastic(case: Case, parameters: Parameters, height: float, depth: FloatArray) -> FloatArray:
    """(line, t) scaled profiles of the elastic slab, coarse-grained along x as those of the packing."""
    ratio = parameters.base.contact.stiffness_ratio if case.friction > 0.0 else 0.0
    slab = Slab(
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


def fit(
    depth: FloatArray, profile: FloatArray, draws: FloatArray | None, t: FloatArray, asked: Parameters
) -> dict[str, FloatArray]:
    """Lengths and their powers of ``depth`` (d,), of mean profiles (d, t) and of those of ``draws`` (draw, d, t).

    ``length`` (d, definition) in radii, ``power`` (definition, fit), ``interval`` (definition, level): with 95 % of the
    draws; without any the range over the fits.
    """
    length = lengths(t, profile, asked.tolerance) * depth[:, None]
    power = powers(depth, length.T)
    if draws is None:
        interval = np.stack([power.min(axis=-1), power.max(axis=-1)], axis=-1)
    else:
        all_ = lengths(t, draws, asked.tolerance) * depth[:, None]
        # nan where a draw has none
        interval = np.quantile(powers(depth, np.swapaxes(all_, 1, 2))[..., 0], LEVELS, axis=0).T
    return {"length": length, "power": power, "interval": interval}


def _inside(parameters: Parameters, outcomes: dict[tuple[int, int, int], Outcome]) -> xr.Dataset:
    """Of the highest slab of each case: profiles on all lines, powers over those that are fitted."""
    t, found, most = grid(parameters), [], 0
    for c, case in enumerate(parameters.cases):
        highest = len(case.heights) - 1
        these = [outcomes[c, highest, r] for r in range(case.count(highest))]
        depth = np.mean([one.depth for one in these], axis=0)
        height = float(np.mean([one.height for one in these]))
        profile = np.stack([one.profile for one in these])
        used = (depth >= parameters.fitted[0]) & (depth <= parameters.fitted[1] * height)
        reference = elastic(case, parameters, height, depth)
        draws = drawn(profile[:, used], parameters.seed, parameters)
        ours = fit(depth[used], profile[:, used].mean(axis=0), draws, t, parameters)
        found.append(
            {
                "depth": depth,
                "fitted": used.astype(float),
                "profile": profile.mean(axis=0),
                "elastic_profile": reference,
                "length": lengths(t, profile.mean(axis=0), parameters.tolerance) * depth[:, None],
                "elastic_length": lengths(t, reference, parameters.tolerance) * depth[:, None],
                "transmitted": np.mean([one.transmitted for one in these], axis=0),
                "power": ours["power"],
                "interval": ours["interval"],
                "elastic_power": fit(depth[used], reference[used], None, t, parameters)["power"],
                "loads": np.array(float(np.mean([one.loads for one in these]))),
            }
        )
        most = max(most, len(depth))
    dataset = _dataset(parameters, found, "line", most, "of the lines")
    dataset["layers"] = variable("case", [case.heights[-1] for case in parameters.cases], "number of layers")
    dataset["surveyed"] = variable("case", [float(bool(case.surveyed)) for case in parameters.cases], SURVEYED)
    return dataset


def _floors(parameters: Parameters, outcomes: dict[tuple[int, int, int], Outcome]) -> xr.Dataset:
    """On the floors of the slabs of each case."""
    t, found, most = grid(parameters), [], 0
    for c, case in enumerate(parameters.cases):
        these = [[outcomes[c, h, r] for r in range(case.count(h))] for h in range(len(case.heights))]
        height = np.array([np.mean([one.height for one in row]) for row in these])
        floors = [np.stack([one.profile[-1] for one in row]) for row in these]
        profile = np.stack([floor.mean(axis=0) for floor in floors])
        # packings of different heights have nothing to do with each other
        each = [drawn(floor, parameters.seed + h, parameters) for h, floor in enumerate(floors)]
        some = [one for one in each if one is not None]
        draws = np.stack(some, axis=1) if len(some) == len(each) else None
        reference = np.concatenate([elastic(case, parameters, h, np.array([h])) for h in height])
        ours = fit(height, profile, draws, t, parameters)
        found.append(
            {
                "depth": height,
                "profile": profile,
                "elastic_profile": reference,
                "length": ours["length"],
                "elastic_length": lengths(t, reference, parameters.tolerance) * height[:, None],
                "transmitted": np.array([np.mean([one.transmitted[-1] for one in row]) for row in these]),
                "power": ours["power"],
                "interval": ours["interval"],
                "elastic_power": fit(height, reference, None, t, parameters)["power"],
                "layers": np.array(case.heights, float),
                "packings": np.array([float(len(row)) for row in these]),
                "surveyed": np.array([float(layers in case.surveyed) for layers in case.heights]),
            }
        )
        most = max(most, len(height))
    return _dataset(parameters, found, "slab", most, "of the slabs")


SURVEYED = "1 where the packings are those of the survey"

#: Dimensions after that of the case and, where there is one, that of the lines or slabs; long names.
_TEXTS = {
    "depth": ("d", f"depth below the surface {LENGTH}"),
    "fitted": ("d", "1 where the line is fitted"),
    "profile": ("dt", "vertical stress per force, times depth"),
    "elastic_profile": ("dt", "the same in the elastic slab of the same height"),
    "length": ("dk", f"length by each definition {LENGTH}"),
    "elastic_length": ("dk", f"the same in the elastic slab {LENGTH}"),
    "transmitted": ("d", "part of the force that crosses the line"),
    "layers": ("d", "number of layers"),
    "packings": ("d", "number of packings"),
    "surveyed": ("d", SURVEYED),
    "power": ("kf", "power of depth with which the length grows"),
    "interval": ("kl", "95 % interval of the first of these; of a lattice the range over the fits"),
    "elastic_power": ("kf", "the same powers in the elastic slab"),
    "loads": ("", "small loads on a packing"),
}


def _dataset(
    parameters: Parameters, found: list[dict[str, FloatArray]], along: str, most: int, what: str
) -> xr.Dataset:
    """One entry for each case; NaN behind its last line or slab."""
    names = {"d": along, "t": "t", "k": "definition", "f": "fit", "l": "level"}
    data = {}
    for name in found[0]:
        letters, text = _TEXTS[name]
        values = [one[name] for one in found]
        if letters.startswith("d"):
            values = [np.pad(v, [(0, most - len(v))] + [(0, 0)] * (v.ndim - 1), constant_values=np.nan) for v in values]
        data[name] = variable(("case", *(names[letter] for letter in letters)), np.stack(values), text)
    cases = parameters.cases
    return xr.Dataset(
        data,
        coords={
            "polydispersity": variable("case", [case.polydispersity for case in cases], "polydispersity"),
            "friction": variable("case", [case.friction for case in cases], "friction, of floor and walls too"),
            "gravity": variable("case", [case.gravity for case in cases], "how gravity was applied"),
            "realizations": variable("case", [case.realizations for case in cases], "number of realizations"),
            "force": variable(
                "case",
                np.array([case.force or 0.0 for case in cases]),
                f"at the reference height {FORCE}; 0 is the limit of small ones",
            ),
            "t": variable("t", grid(parameters), "distance from the load per depth"),
            "definition": variable("definition", list(DEFINITIONS), "lengths"),
            "fit": variable("fit", list(FITS), f"depths {what} that are used"),
            "level": variable("level", np.array(LEVELS), "ends of the interval"),
        },
    )
