"""Packings as in the experiments of Sec. II.B, and what these observe: forces by depth, directions, widths.

The paper says of them: lattices of nearly equal disks and packings of two sizes under 150 weights, friction 0.94, means
over 50 packings; slabs of about ten diameters; deeper, disordered ones under a few weights. Profiles are those of the
contacts that cross a horizontal line at a depth below the loaded disk, smoothed along x: the magnitude of the force
that the load adds at each, as photoelastic images show it, and its vertical component, the stress.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr

from granular_response.observe.difference import wall_force_difference
from granular_response.observe.stress import line_forces, line_stress, load_forces
from granular_response.solvers.solution import solve_scene
from granular_response.state import FLOOR, FloatArray
from granular_response.store.result import common_candidates
from granular_response.store.variables import RADII
from granular_response.studies import LoadPath
from granular_response_extensions.experiments.parameters import LATTICE, LoadedPacking, Parameters
from granular_response_extensions.experiments.simulate.widths import DEFINITIONS, FITS, lengths, powers
from granular_response_paper.datasets import labelled, pictured
from granular_response_paper.records import axes, column, labels, record, table
from granular_response_paper.survey.crossover import CONFIDENCE, folded, weights
from granular_response_paper.tasks import computed

#: Distance from the load per depth, of profiles that are put on each other.
SCALED = np.linspace(0.0, 1.5, 31)
#: Directions below the horizontal, from the side that an oblique force points to, in degrees.
ANGLES = np.arange(20.0, 161.0)
#: Downwards, and half-way between that and the lattice.
VERTICAL, BETWEEN = 90.0, 75.0


@record
class PackingProfiles:
    """One packing under its load."""

    moved: float = column(f"how far the load moves its disk {RADII}")
    height: float = column(f"height of the loaded disk {RADII}")
    imbalance: float = column("largest difference of the force across a line and the load, per load")
    profiles: FloatArray  #: (2, depth, x) magnitude of forces per length and vertical stress, per load; nan below floor


@record
class MeanProfiles:
    """Of the mean over the packings that hold the force: the value, and 95 % of the bootstrap draws."""

    force: FloatArray = column("magnitude of added forces per length and load", "depth", "x", "estimate")
    stress: FloatArray = column("vertical stress of the load, per load", "depth", "x", "estimate")
    direction: FloatArray = column("magnitude of added forces per radian and load", "angle", "estimate")
    strongest: FloatArray = column("direction of the largest of these, in degrees", "estimate")
    chain: FloatArray = column("the same with both sides folded, from 40 to 80 degrees, in degrees", "estimate")
    contrast: FloatArray = column("force at 60 degrees over that at 75, both sides folded", "estimate")
    vertical: FloatArray = column("force at 90 degrees over that at 75, both sides folded", "estimate")
    dip: FloatArray = column("lack of the scaled stress at x = 0, per largest", "estimate")
    length: FloatArray = column(f"half the width by each definition {RADII}", "definition", "depth", "estimate")
    power: FloatArray = column("power of depth with which it grows", "definition", "fit", "estimate")


def measure(asked: Parameters, case: LoadedPacking, realization: int) -> PackingProfiles:
    """One packing; raises what the solvers raise."""
    path, force = LoadPath.of(asked.scene_of(case, realization)), case.force
    disk = int(path.problem.load_disk[0])
    rest, loaded = common_candidates([path.rest, path.at(force)], path.problem.packing.radius)
    start, (middle, top), added = rest.position[disk], loaded.position[disk], load_forces(rest, loaded)
    upright = np.linalg.norm(added.force, axis=1) * np.sign(added.branch[:, 1])
    sizes = replace(added, force=np.stack([np.zeros_like(upright), upright], axis=1))
    at_side, z = loaded.walls.second != FLOOR, loaded.position[loaded.walls.first, 1]
    at_wall, load = wall_force_difference(rest, loaded)[:, 1], -force * path.scene.loads[0].force[1]
    found, lack = np.full((2, asked.depths, len(asked.x)), np.nan), 0.0
    for k, height in enumerate(top - depth for depth in range(1, asked.depths + 1) if depth < top):
        found[:, k] = [line_stress(one, height, middle + asked.x, asked.width) / force for one in (sizes, added)]
        borne = line_forces(added, height)[1].sum() + at_wall[at_side & (z > height)].sum()
        lack = max(lack, float(abs(borne - load) / load))
    return PackingProfiles(float(np.linalg.norm(loaded.position[disk] - start)), float(start[1]), lack, found)


def statistics(asked: Parameters, x: FloatArray, height: float, force: FloatArray, stress: FloatArray) -> dict:
    """The fields of :class:`MeanProfiles` of mean profiles (depth, x); ``height`` is that of the load."""
    depth = np.arange(1.0, asked.depths + 1.0)
    ring = depth[(depth >= asked.ring[0]) & (depth <= asked.ring[1]) & (depth < height)]
    used = (depth >= asked.fitted[0]) & (depth <= asked.fitted[1] * height)
    used &= np.isfinite(stress).all(axis=1)  # some packings are lower than their mean
    sine, cotangent = np.sin(np.radians(ANGLES)), 1.0 / np.tan(np.radians(ANGLES))
    of_ring = [np.interp(d * cotangent, x, force[int(d) - 1], 0.0, 0.0) * d / sine**2 for d in ring]
    direction = np.mean(of_ring, axis=0) if len(ring) else np.full(len(ANGLES), np.nan)
    both = dict(zip(ANGLES, 0.5 * (direction + direction[::-1]), strict=True))
    sideways = ANGLES[(ANGLES >= 40.0) & (ANGLES <= 80.0)]
    half, side = folded(stress), x[len(x) // 2 :]
    scaled = np.mean([d * np.interp(d * SCALED, side, half[int(d) - 1]) for d in depth[used]] or [SCALED * np.nan], 0)
    length = lengths(side, half).T
    return {
        "force": force, "stress": stress, "direction": direction,
        "strongest": ANGLES[np.argmax(direction)], "chain": max(sideways, key=both.__getitem__),
        "contrast": both[LATTICE] / both[BETWEEN], "vertical": both[VERTICAL] / both[BETWEEN],
        "dip": 1.0 - scaled[0] / scaled.max(), "length": length, "power": powers(depth[used], length[:, used]),
    }  # fmt: skip


def mean_of(asked: Parameters, x: FloatArray, outcomes: list[PackingProfiles]) -> MeanProfiles:
    """Of the packings that hold the force; nan with fewer than three."""
    held = [one for one in outcomes if one.moved <= asked.largest_move]
    if len(held) < 3:
        value = statistics(asked, x, 0.0, *np.full((2, asked.depths, len(x)), np.nan))
        return MeanProfiles(**{name: np.full((*np.shape(one), 3), np.nan) for name, one in value.items()})
    profiles, height = np.stack([one.profiles for one in held]), float(np.mean([one.height for one in held]))
    value = statistics(asked, x, height, *profiles.mean(axis=0))
    parts = weights(len(held), asked.draws, asked.seed) / len(held)
    drawn = [statistics(asked, x, height, *one) for one in np.einsum("wr,rkdx->wkdx", parts, profiles)]
    ends = {name: np.quantile([draw[name] for draw in drawn], CONFIDENCE, axis=0) for name in value}
    return MeanProfiles(**{name: np.stack([one, *ends[name]], axis=-1) for name, one in value.items()})


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``packings``, ``means``, and ``picture_K`` of each case that has one."""
    asked, x, cases = parameters, parameters.x, parameters.cases
    tasks = {(c, r): partial(measure, asked, case, r) for c, case in enumerate(cases) for r in range(case.realizations)}
    found = computed(tasks, "packings")
    each = [[found[c, r] for r in range(case.realizations)] for c, case in enumerate(cases)]
    means = computed({(c,): partial(mean_of, asked, x, one) for c, one in enumerate(each)}, "means")
    given = labels("case", cases, force="applied force, in mean weights", angle="of it below the horizontal, degrees")
    coordinates = labels("case", cases, packing="packing", realizations="number of packings")
    coordinates |= {f"{name}_applied": values for name, values in given.items()}
    points = axes(
        depth=(np.arange(1.0, asked.depths + 1.0), f"depth below the loaded disk {RADII}"),
        x=(x, f"position from the loaded disk {RADII}"), angle=(ANGLES, "angle below the horizontal, in degrees"),
        definition=(DEFINITIONS, "definition of the width"),
        fit=(FITS, "fitted depths"), estimate=(("mean", "low", "high"), "mean, and 95 % of its bootstrap draws"),
    )  # fmt: skip
    used = {"largest_move": asked.largest_move, "fitted": list(asked.fitted), "width": asked.width}
    datasets = {
        "packings": table(found, "case", "realization").assign_coords(coordinates).assign_attrs(used),
        "means": table(means, "case").assign_coords(coordinates | points).assign_attrs(used),
    }
    for c in asked.pictures:
        r = next((r for r, one in enumerate(each[c]) if one.moved <= asked.largest_move), 0)
        datasets[f"picture_{c}"] = pictured(solve_scene(asked.scene_of(cases[c], r), load_factors=(cases[c].force,)))
    return labelled(datasets, asked.base)
