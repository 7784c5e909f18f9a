"""Claim T1: a torque on the loaded disk (Sec. V.G)."""

from __future__ import annotations

import numpy as np

from ...claims import asked
from ...claims.claim import Claims, Data, Finding
from ...claims.words import Bounds

GROUP = "torque"
CLAIMS = Claims(GROUP)

#: "Close to the load" and beyond (mean radii).
NEAR, FAR = 6.0, 9.0


@CLAIMS.measures("T1a")
def chains(data: Data, words: Bounds) -> Finding:
    rings = data.get(GROUP, "reach").sortby("torque").isel(torque=-1)
    near = rings["ring_outer"].values <= NEAR
    CLAIMS.needs(near.any(), f"reach holds no ring within {NEAR:g} radii")
    change = float(rings["force_change"].values[near].mean())
    torque = float(rings["torque"])
    return asked.one_reading(
        f"torque {torque:g}: contact forces within {NEAR:g} radii change by {change:.0%}",
        f"torque {torque:g}",
        asked.at_least("change of the contact forces", change, words, "marked", "%"),
    )


def _fields(data: Data) -> dict[str, np.ndarray]:
    """Change of the stress and of its antisymmetric part (z, x) by the largest torque, and the distance of the load."""
    components = ("stress_xx", "stress_xz", "stress_zx", "stress_zz")
    study = data.get(GROUP, "stress").sortby("torque")
    disks = data.get(GROUP, "torques").sortby("torque")
    change = np.stack([study[name].values[-1] - study[name].values[0] for name in components])
    place = disks["position"].values[0, int(disks["loaded_disk"])]
    x, z = np.meshgrid(study["x"].values, study["z"].values)
    return {
        "distance": np.hypot(x - place[0], z - place[1]),
        "whole": np.sqrt((change**2).sum(axis=0)),
        "antisymmetric": 0.5 * np.abs(change[1] - change[2]),
    }


@CLAIMS.measures("T1b")
def near_the_load(data: Data, words: Bounds) -> Finding:
    rings = data.get(GROUP, "reach")
    rings = rings.sortby("torque").isel(torque=-1)
    near, far = rings["ring_outer"].values <= NEAR, rings["ring_inner"].values >= FAR
    fields = _fields(data)
    within, beyond = fields["distance"] < NEAR, fields["distance"] > FAR
    there = near.any() and far.any() and within.any() and beyond.any()
    CLAIMS.needs(there, f"holds nothing within {NEAR:g} or beyond {FAR:g} radii of the load")

    def ring(name: str) -> float:
        return float(rings[name].values[far].mean() / rings[name].values[near].mean())

    def area(name: str) -> float:
        return float(fields[name][beyond].mean() / fields[name][within].mean())

    return asked.each(
        f"change beyond {FAR:g} radii per that within {NEAR:g}: ",
        {
            "antisymmetric part, mean over the area": area("antisymmetric"),
            "whole stress, mean over the area": area("whole"),
            "antisymmetric part, per stress of the ring": ring("antisymmetric_change"),
            "whole stress, per stress of the ring": ring("stress_change"),
        },
        lambda ratio: asked.at_most("change far from the load per that near it", ratio, words, "small"),
        form=".3f",
    )
