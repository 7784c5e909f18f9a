"""Claims B4, B5 and B27 to B29, beyond the paper: packings, and slabs under load, as elastic slabs."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.bounds import about, at_most
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, materials
from granular_response_paper.claims.numbers import Quantity, needs

claim = Claims("moduli")

OWN = "polydispersity 0.01, friction 0.2"


def _described(data: Data, solid: str) -> Numbers:
    """In the highest packings of each case."""
    for name, case in materials(data.get("moduli", "packings")):
        one = case.isel(size=int(np.nanargmax(case["layers"].values)), smoothing=0)
        yield name, over_realizations(one["difference"].sel(solid=solid).values, np.mean)


@claim("B4", "beyond the paper, I",
       Ask("largest difference to the elastic slab of the measured moduli", at_most("nearly"), "%"),
       primary=OWN)  # fmt: skip
def elastic(data: Data) -> Numbers:
    """More specifically, large systems subject to "small" applied forces (which is likely to be the case in many
    engineering applications), can be described by isotropic elasticity except in the near vicinity of the point of
    application of the force (where one expects strong induced anisotropy and irreversible rearrangements).
    Short: Large systems under small forces are elastic slabs
    Here: At friction 0.2 and polydispersity 0.01 the response differs from that of the elastic slab with the packings'
    own moduli by {0} of the largest pressure.
    Remark: Mean over the small loads on the top disks of a packing, smoothed with w = 3, in the highest packings; no
    parameter is fitted"""
    yield from _described(data, "free")


@claim("B5", "beyond the paper, I", Ask("largest difference to the nearest isotropic slab", at_most("nearly"), "%"),
       primary=OWN)  # fmt: skip
def isotropic(data: Data) -> Numbers:
    """As B4.
    Short: Large systems under small forces are isotropic
    Here: At friction 0.2 and polydispersity 0.01 the response differs from that of the nearest isotropic slab by {0} of
    the largest pressure.
    Remark: Mean over the small loads on the top disks of a packing, smoothed with w = 3, in the highest packings; no
    parameter is fitted"""
    yield from _described(data, "isotropic")


def _slabs(data: Data) -> dict[str, xr.Dataset]:
    """Slabs by friction, without steps that are not there."""
    found = data.get("moduli", "slabs")
    known = np.isfinite(found["force"].values)
    return {f"friction {float(mu):g}": found.isel(slab=k, step=known[k]) for k, mu in enumerate(found["friction"])}


@claim("B27", "beyond the paper, V.C", Ask("force at which r < 0 reaches the floor per crossover force", about(1.0)),
       primary="friction 0")  # fmt: skip
def reach(data: Data) -> Numbers:
    """They found a criterion for the elastic moduli at which a crossover occurs from a single peaked response to a
    double peaked one [36]: two peaks are expected for r ≡ (1/bd)[ab − c(d + c)] < 0.
    Short: Two peaks are expected for r < 0
    Here: Without friction the region of r < 0 reaches the floor at {0} times the crossover force.
    Remark: Ranges over the averages, the loads to which moduli are fitted and the forces between which it happens"""
    for name, slab in _slabs(data).items():
        crossover = Quantity.bracket(*slab["crossover"].values)
        reached = slab["reach"].values.reshape(slab.sizes["step"], -1) >= 1.0
        if crossover.happens and reached[-1].all():
            force, first = slab["force"].values, reached.argmax(axis=0)
            needs(bool((first > 0).all()), f"{name}: the region of r < 0 reaches the floor at the first force")
            ends = np.concatenate([force[first - 1], force[first]])
            yield name, Quantity(float(ends.mean()), float(ends.min()), float(ends.max()), "range").per(crossover)


@claim("B28", "beyond the paper, IV and VIII",
       Ask("difference of the incremental response from the elastic slab per largest response", at_most("nearly"), "%"),
       primary="friction 0.2, up to the crossover, averages over 2 R", modal=True, finds="not seen")  # fmt: skip
def incrementally_elastic(data: Data) -> Numbers:
    """If the particle positions do not change significantly, so that only the contact network is modified in response
    to the applied stress, the behavior can possibly be modeled as "incrementally elastic".
    Short: The behavior can possibly be modeled as incrementally elastic
    Here: At friction 0.2, up to the crossover and with moduli averaged over two radii, the incremental response
    differs from that of an elastic slab with the measured incremental moduli by {0}.
    Remark: Ranges over the loads to which moduli are fitted. Largest difference of all forces. Two radii is the
    width of Fig. 14"""
    for name, slab in _slabs(data).items():
        crossover = Quantity.bracket(*slab["crossover"].values)
        below = slab["force"].values <= crossover.low
        parts = {"up to the crossover": below, "beyond it": ~below} if crossover.happens else {"one peak": below}
        for part, inside in parts.items():
            for k, width in enumerate(slab["width"].values.tolist()) if inside.any() else ():
                largest = slab["difference"].isel(width=k).values[inside].max(axis=0).ravel()
                yield (
                    f"{name}, {part}, averages over {width:g} R",
                    Quantity(None, float(largest.min()), float(largest.max()), "range"),
                )


@claim("B29", "beyond the paper, IV and VIII", Ask("forces with another number of peaks", at_most(0.0), "count"),
       primary="friction 0", modal=True, finds="not seen")  # fmt: skip
def peaks(data: Data) -> Numbers:
    """As B28.
    Short: The behavior can possibly be modeled as incrementally elastic
    Here: Without friction the elastic slab has another number of peaks under {0} of the forces.
    Remark: Ranges over the averages and the loads to which moduli are fitted"""
    for name, slab in _slabs(data).items():
        needs(slab[["predicted_two_peaks", "two_peaks"]].to_array().notnull().all(), f"{name}: no number of peaks")
        wrong = (slab["predicted_two_peaks"] != slab["two_peaks"]).sum("step")
        yield name, Quantity.over(wrong.values.ravel().tolist())
