"""Claim T1: a torque on the loaded disk (Sec. V.G)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP = "torque"
CLAIMS = Claims(__package__)

#: "Close to the load" and beyond (mean radii).
NEAR, FAR = 6.0, 9.0


def _rings(data: Data) -> tuple[xr.Dataset, np.ndarray]:
    """What the largest torque changes in rings, and which of them are close to the load."""
    rings = data.get(GROUP, "reach").sortby("torque").isel(torque=-1)
    return rings, rings["ring_outer"].values <= NEAR


@CLAIMS.measures("T1a")
def chains(data: Data, words: Words) -> list[Test]:
    rings, near = _rings(data)
    CLAIMS.needs(near.any(), f"reach holds no ring within {NEAR:g} radii")
    change = Quantity.exact(rings["force_change"].values[near].mean())
    return [Test("change of the contact forces", change, bounds.at_least(words, "marked"), unit="%")]


@CLAIMS.measures("T1b")
def near_the_load(data: Data, words: Words) -> list[Test]:
    rings, near = _rings(data)
    far = rings["ring_inner"].values >= FAR
    study, disks = (data.get(GROUP, name).sortby("torque") for name in ("stress", "torques"))
    stress = np.stack([study[f"stress_{component}"].values for component in ("xx", "xz", "zx", "zz")])
    change = stress[:, -1] - stress[:, 0]
    whole, antisymmetric = np.sqrt((change**2).sum(axis=0)), 0.5 * np.abs(change[1] - change[2])
    place = disks["position"].values[0, int(disks["loaded_disk"])]
    x, z = np.meshgrid(study["x"].values, study["z"].values)
    distance = np.hypot(x - place[0], z - place[1])
    within, beyond = distance < NEAR, distance > FAR
    there = near.any() and far.any() and within.any() and beyond.any()
    CLAIMS.needs(there, f"holds nothing within {NEAR:g} or beyond {FAR:g} radii of the load")

    def ring(name: str) -> float:
        return float(rings[name].values[far].mean() / rings[name].values[near].mean())

    def area(field: np.ndarray) -> float:
        return float(field[beyond].mean() / field[within].mean())

    found = {
        "antisymmetric part, mean over the area": area(antisymmetric),
        "whole stress, mean over the area": area(whole),
        "antisymmetric part, per stress of the ring": ring("antisymmetric_change"),
        "whole stress, per stress of the ring": ring("stress_change"),
    }
    small = bounds.at_most(words, "small")
    return [Test("change far from the load per near it", Quantity.exact(r), small, case) for case, r in found.items()]
