"""Claim A4: large slabs against isotropic elasticity (abstract, Sec. VIII)."""

from __future__ import annotations

from ...claims.bounds import at_least, at_most
from ...claims.claim import Ask, Case, Claims, Data, Numbers, at
from ...records import alike

claim = Claims("slab_comparison", {"force": 0.01})


@claim("A4", "abstract, VIII", Ask("difference from the elastic slab in the deepest one", at_most("holds"), "%"),
       Ask("that per the one in the thinnest", at_most(1.0)),
       Ask("dip per peak in a small slab under a large force", at_least("marked"), "%"),
       primary="friction 0, smooth floor, 8 disks a row per layer", figures=[1, 3])  # fmt: skip
def large_systems(data: Data) -> Numbers:
    """The results indicate that in large systems (typically considered by engineers), the response is close to that
    predicted by isotropic elasticity whereas the response of small systems (or when sufficiently large forces are
    applied) is strongly anisotropic.
    Short: Large slabs respond as isotropic elastic ones, small ones anisotropically
    Here: Without friction the response of the deepest slab differs from that of the elastic slab by {0}. In 15 layers
    under 15 mg it dips at x = 0 by {2} of the peaks.
    Remark: Force of 0.01 mg for the elastic slab: no contact opens, so that a lattice of springs tends to its continuum
    and this half could hardly fail. The height of the slab is that to the top of the loaded disk. In 15 layers, where
    gravity opens a row of contacts, the difference is 5 %"""
    large = at(data.get("friction_linear_range", "response"), friction=0.0, force=15.0)
    dip = 1.0 - float(large["response_at_centre"]) / float(large["peak_height"])
    cases = alike(data.get("slab_comparison", "slabs"), "slab", "friction", "floor", "gravity", "disks_per_layer")
    for k, ((mu, floor, gravity, wide), slabs) in enumerate(cases.items()):
        thin, *_, deep = slabs.sortby("layers")["distance"].values
        name = f"friction {mu:g}, {floor} floor, {wide:g} disks a row per layer"
        case = Case(name) if gravity == "at-once" else Case(f"{name}, gravity {gravity}", "gravity")
        yield case, deep, deep / thin, None if k else dip
