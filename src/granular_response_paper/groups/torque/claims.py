"""Claims T1a and T1b: a torque on the loaded disk (Sec. V.G)."""

from __future__ import annotations

import numpy as np

from ...claims.bounds import at_least, at_most
from ...claims.claim import Ask, Claims, Data, Numbers
from ...claims.numbers import needs

GROUP = "torque"
claim = Claims(
    GROUP, {"force": 10.0, "angle": 30.0, "scene.contact.friction": 0.5, "scene.packing.polydispersity": 0.001}
)

#: "Close to the load" and beyond (mean radii).
NEAR, FAR = 6.0, 9.0


@claim("T1a", "V.G, Fig. 18", Ask("mean change of the contact forces near the load", at_least("marked"), "%"))
def change(data: Data) -> Numbers:
    """As shown, additional torques can have quite a large effect on the obtained force chains.
    Short: Torques can have quite a large effect on force chains
    Here: The largest torque changes the contact forces within 6 radii of the load by {0}.
    Remark: One realization; the sentence says what torques can do"""
    rings = data.get(GROUP, "reach").sortby("torque").isel(torque=-1)
    yield rings["force_change"].values[rings["ring_outer"].values <= NEAR].mean()


@claim("T1b", "V.G", Ask("change far from the load per near it", at_most("small"), "%"),
       primary="antisymmetric part, mean over the area", figures=[18])  # fmt: skip
def near_the_load(data: Data) -> Numbers:
    """Although the effect on the stress field (in particular, its asymmetric part) is typically confined to a region
    close to the point of application, this may indicate that for some effects it is important to extend the continuum
    description to incorporate torques and rotations, i.e., use a micropolar or Cosserat continuum model [88, 89, 90]).
    Short: Its effect on the stress is confined to the load's surroundings
    Here: Beyond 9 radii from the load a torque changes the antisymmetric part of the stress by {0} of its change within
    6 radii, and the whole stress by {whole stress, mean over the area|0}.
    Remark: The stress of the force alone falls with the distance too, so that its relative change reaches farther"""
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
