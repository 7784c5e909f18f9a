"""How wide profiles are, and the powers of depth with which that grows, beside an elastic slab.

Of a lattice, an interval of a power is its range over the fits; of disordered packings it has 95 % of the draws over
their realizations.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from granular_response.observe.widths import lengths, powers
from granular_response.state import FloatArray
from granular_response.store.variables import RADII
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.slab import Slab
from granular_response_paper.groups.peak_width.parameters import Case, Parameters
from granular_response_paper.records import column, record, table
from granular_response_paper.survey.crossover import CONFIDENCE, weights

SURVEYED = "1 where the packings are those of the survey"


@record
class Outcome:
    """The profiles of one packing."""

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


def elastic(case: Case, asked: Parameters, height: float, depth: FloatArray) -> FloatArray:
    """(line, t) scaled profiles of the elastic slab, coarse-grained along x as those of the packing."""
    ratio = asked.base.contact.stiffness_ratio if case.friction > 0.0 else 0.0
    moduli = lattice.moduli(Springs.uniform(1.0, ratio), "free")
    slab = Slab(height, moduli, "rough" if case.friction > 0.0 else "smooth")
    t, deviation = asked.grid, asked.width / np.sqrt(2.0)
    return np.stack([-slab.stress(t * z, max(height - z, 0.0), 1.0, deviation)[1] * z for z in depth])


def drawn(profile: FloatArray, seed: int, asked: Parameters) -> FloatArray:
    """(draw, ...) means of bootstrap draws over the realizations (r, ...)."""
    return np.einsum("wr,r...->w...", weights(len(profile), asked.draws, seed) / len(profile), profile)


def widths(
    asked: Parameters,
    depth: FloatArray,
    profile: FloatArray,
    elastic_profile: FloatArray,
    transmitted: FloatArray,
    draws: FloatArray | None,
    used: NDArray[np.bool_],
) -> Widths:
    """Of mean profiles (d, t) at ``depth`` (d,); those ``used`` are fitted, and ``draws`` (draw, used, t) of them."""
    both = (profile, elastic_profile)
    length, elastic_length = (lengths(asked.grid, one, asked.tolerance) * depth[:, None] for one in both)
    power, elastic_power = (powers(depth[used], one[used].T) for one in (length, elastic_length))
    if draws is None:
        interval = np.stack([power.min(axis=-1), power.max(axis=-1)], axis=-1)
    else:
        of_draws = lengths(asked.grid, draws, asked.tolerance) * depth[used][:, None]
        # nan where a draw has none
        interval = np.quantile(powers(depth[used], np.swapaxes(of_draws, 1, 2))[..., 0], CONFIDENCE, axis=0).T
    return Widths(depth, profile, elastic_profile, length, elastic_length, transmitted, power, interval, elastic_power)


def inside(asked: Parameters, case: Case, found: Sequence[Outcome]) -> Inside:
    """Of the highest slab of a case: profiles on all lines, powers over those that are fitted."""
    each = {name: one.values for name, one in table(found, "realization").items()}
    depth, height, transmitted = (each[name].mean(axis=0) for name in ("depth", "height", "transmitted"))
    used = (depth >= asked.fitted[0]) & (depth <= asked.fitted[1] * height)
    draws = drawn(each["profile"][:, used], asked.seed, asked) if case.polydispersity else None
    reference = elastic(case, asked, float(height), depth)
    return Inside(
        **vars(widths(asked, depth, each["profile"].mean(axis=0), reference, transmitted, draws, used)),
        fitted=used.astype(float),
        loads=float(each["loads"].mean()),
        layers=case.heights[-1],
        surveyed=float(bool(case.surveyed)),
    )


def floors(asked: Parameters, case: Case, found: Sequence[Sequence[Outcome]]) -> Floors:
    """On the floors of the slabs of a case."""
    rows = [table(row, "realization").isel(line=-1) for row in found]
    height, transmitted = (np.array([row[name].values.mean() for row in rows]) for name in ("height", "transmitted"))
    profiles = [row["profile"].values for row in rows]
    # packings of different heights have nothing to do with each other
    draws = [drawn(one, asked.seed + h, asked) for h, one in enumerate(profiles)] if case.polydispersity else None
    reference = np.concatenate([elastic(case, asked, h, np.array([h])) for h in height])
    profile, every = np.stack([one.mean(axis=0) for one in profiles]), np.full(len(height), True)
    joined = None if draws is None else np.stack(draws, axis=1)
    return Floors(
        **vars(widths(asked, height, profile, reference, transmitted, joined, every)),
        layers=np.array(case.heights, float),
        packings=np.array([float(len(row)) for row in found]),
        surveyed=np.array([float(layers in case.surveyed) for layers in case.heights]),
    )
