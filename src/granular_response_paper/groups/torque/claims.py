"""Claim T1: a torque on the loaded disk (Sec. V.G)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ...claims import asked
from ...claims.claim import Claims, Data, Finding
from ...claims.words import Bounds

GROUP = "torque"
CLAIMS = Claims(GROUP)

#: "Close to the load" and beyond (mean radii).
NEAR, FAR = 6.0, 9.0


def _rings(data: Data) -> tuple[xr.Dataset, np.ndarray]:
    """What the largest torque changes in rings, and which of them are close to the load."""
    rings = data.get(GROUP, "reach").sortby("torque").isel(torque=-1)
    return rings, rings["ring_outer"].values <= NEAR


@CLAIMS.measures("T1a")
def chains(data: Data, words: Bounds) -> Finding:
    rings, near = _rings(data)
    CLAIMS.needs(near.any(), f"reach holds no ring within {NEAR:g} radii")
    change = float(rings["force_change"].values[near].mean())
    torque = float(rings["torque"])
    return asked.one_reading(
        f"torque {torque:g}: contact forces within {NEAR:g} radii change by {change:.0%}",
        f"torque {torque:g}",
        asked.at_least("change of the contact forces", change, words, "marked", "%"),
    )


@CLAIMS.measures("T1b")
def near_the_load(data: Data, words: Bounds) -> Finding:
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

    return asked.each(
        f"change beyond {FAR:g} radii per that within {NEAR:g}: ",
        {
            "antisymmetric part, mean over the area": area(antisymmetric),
            "whole stress, mean over the area": area(whole),
            "antisymmetric part, per stress of the ring": ring("antisymmetric_change"),
            "whole stress, per stress of the ring": ring("stress_change"),
        },
        lambda ratio: asked.at_most("change far from the load per that near it", ratio, words, "small"),
        form=".3f",
    )
