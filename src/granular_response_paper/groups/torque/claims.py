"""Claim T1: a torque on the loaded disk (Sec. V.G)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.claim import Data, Numbers, needs

GROUP = "torque"

#: "Close to the load" and beyond (mean radii).
NEAR, FAR = 6.0, 9.0


def near_the_load(data: Data) -> Numbers:  # T1b
    rings = data.get(GROUP, "reach").sortby("torque").isel(torque=-1)
    near, far = rings["ring_outer"].values <= NEAR, rings["ring_inner"].values >= FAR
    study, disks = (data.get(GROUP, name).sortby("torque") for name in ("stress", "torques"))
    stress = np.stack([study[f"stress_{component}"].values for component in ("xx", "xz", "zx", "zz")])
    change = stress[:, -1] - stress[:, 0]
    place = disks["position"].values[0, int(disks["loaded_disk"])]
    x, z = np.meshgrid(study["x"].values, study["z"].values)
    distance = np.hypot(x - place[0], z - place[1])
    within, beyond = distance < NEAR, distance > FAR
    for there in (near, far, within, beyond):
        needs(there.any(), f"nothing within {NEAR:g} or beyond {FAR:g} radii of the load")
    areas = {
        "antisymmetric part": 0.5 * np.abs(change[1] - change[2]),
        "whole stress": np.sqrt((change**2).sum(axis=0)),
    }
    for name, field in areas.items():
        yield f"{name}, mean over the area", field[beyond].mean() / field[within].mean()
    for name, ring in (("antisymmetric part", "antisymmetric_change"), ("whole stress", "stress_change")):
        yield f"{name}, per stress of the ring", rings[ring].values[far].mean() / rings[ring].values[near].mean()
