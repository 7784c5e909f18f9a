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
from granular_response.observe.stress import given_forces, line_forces, line_stress, load_forces
from granular_response.observe.widths import DEFINITIONS, FITS
from granular_response.scene import Packing, Scene
from granular_response.solvers.small_loads import contact_answers
from granular_response.state import FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.store.variables import WEIGHTS, variable
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.peak_width.parameters import Parameters
from granular_response_paper.groups.peak_width.simulate.widths import Outcome, floors, inside
from granular_response_paper.parameters import material
from granular_response_paper.records import axes, column, columns, labels, record, table
from granular_response_paper.slab_response import LoadPath
from granular_response_paper.survey.crossover import CONFIDENCE, folded
from granular_response_paper.survey.packings import measured

#: Height of the line that stands for the floor (radii): below all centres, above what the floor contacts rest on.
FLOOR_LINE = 1e-6


@record
class Slab:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column("friction, of floor and walls too")
    gravity: str = column("how gravity was applied")
    force: float = column(f"at the reference height {WEIGHTS}; 0 is the limit of small ones")
    layers: int = column("number of rows")
    realization: int = column("realization of the disorder")


def compute(scene: Scene, force: float, loads: int, margin: float, lines: int, width: float, t: FloatArray) -> Outcome:
    """One packing; ``scene`` has one load, of unit force.

    ``force`` is 0 for small ones: on disordered packings as many as ``loads``, farther than ``margin`` (heights) from
    the side walls. Profiles are on at most as many ``lines``, with a Gaussian of w = ``width``, at distances ``t`` in
    depths. Raises what the solvers raise.
    """
    path = LoadPath.of(scene)
    problem, packing, rest = path.problem, path.problem.packing, path.rest
    z = rest.position[:, 1]
    rows = np.array([z[packing.row == row].mean() for row in range(int(packing.row.max()) + 1)])
    surface = rows[-1] + 0.5 * (rows[-1] - rows[0]) / (len(rows) - 1)
    between = 0.5 * (rows[1:] + rows[:-1])[::-1]
    taken = np.unique(np.geomspace(1.0, len(between), min(lines, len(between))).round().astype(int)) - 1
    line, depth = np.append(between[taken], FLOOR_LINE), surface - np.append(between[taken], 0.0)
    if not force:
        disks = loaded_disks(packing, rest, margin * surface, loads if np.ptp(packing.radius) else 1)
        answers = contact_answers(problem, rest, disks, sliding="stick")
        borne = [k for k in range(len(disks)) if np.isfinite(answers[0][k]).all()]
        fields = [(given_forces(rest, answers[0][k], answers[1][k]), rest.position[disks[k], 0], 1.0) for k in borne]
    else:
        start, end = common_candidates([rest, path.at(force)], packing.radius)
        fields = [(load_forces(start, end), rest.position[int(problem.load_disk[0]), 0], force)]
    both = np.concatenate([-t[:0:-1], t])
    profiles = [
        [folded(line_stress(forces, z, x + d * both, width)) * d / size for z, d in zip(line, depth, strict=True)]
        for forces, x, size in fields
    ]
    transmitted = [[line_forces(forces, z)[1].sum() / size for z in line] for forces, _, size in fields]
    return Outcome(surface, depth, np.mean(profiles, axis=0), np.mean(transmitted, axis=0), len(fields))


def loaded_disks(packing: Packing, rest: State, margin: float, count: int) -> NDArray[np.intp]:
    """At most ``count`` disks of the top row, spread evenly ``margin`` off the walls; one alone is in the middle."""
    x = rest.position[:, 0]
    top = np.flatnonzero(packing.row == packing.row.max())
    if count == 1:
        return top[[np.argmin(np.abs(x[top] - 0.5 * packing.width))]]
    inside = top[interior_mask(x[top], packing.width, margin)]
    inside = inside[np.argsort(x[inside], kind="stable")]
    return inside[np.unique(np.linspace(0, len(inside) - 1, min(count, len(inside))).round().astype(int))]


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``inside`` and ``floors``."""
    outcomes = measured(parameters, "slabs", packings, task, Outcome)
    each = [
        (case, [[outcomes[c, h, r] for r in range(case.count(h))] for h in range(len(case.heights))])
        for c, case in enumerate(parameters.cases)
    ]
    of = {name: one.long_name for name, one in columns(Slab).items()}
    texts = {name: of[name] for name in ("polydispersity", "friction", "gravity")}
    cases = labels("case", parameters.cases, **texts, realizations="number of realizations")
    cases["force"] = variable("case", [case.force or 0.0 for case in parameters.cases], of["force"])
    datasets = {}
    for name, along, tables in (
        ("inside", "line", [inside(parameters, case, found[-1]) for case, found in each]),
        ("floors", "slab", [floors(parameters, case, found) for case, found in each]),
    ):
        coordinates = axes(
            t=(parameters.grid, "distance from the load per depth"),
            definition=(DEFINITIONS, "lengths"),
            fit=(FITS, f"depths of the {along}s that are used"),
            level=(CONFIDENCE, "ends of the interval"),
        )
        data = table(tables, "case").rename_dims(along=along).assign_coords(cases | coordinates)
        datasets[name] = data.assign_attrs(fitted=list(parameters.fitted), width=parameters.width)
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
    return partial(compute, scene, force, asked.loads, asked.margin, asked.lines, asked.width, asked.grid)
