"""Claim A4: large slabs against isotropic elasticity (abstract, Sec. VIII)."""

from __future__ import annotations

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from ...claims.words import Bounds
from ...records import alike

GROUP = "slab_comparison"
CLAIMS = Claims(GROUP)


@CLAIMS.measures("A4")
def large_systems(data: Data, words: Bounds) -> Finding:
    cases = alike(data.get(GROUP, "slabs"), "slab", "friction", "floor", "gravity", "disks_per_layer")
    readings = []
    for (mu, floor, gravity, wide), slabs in cases.items():
        CLAIMS.needs(slabs.sizes["slab"] > 1, "slabs holds one depth of a case")
        thin, *_, deep = slabs.sortby("layers")["distance"].values
        readings.append(
            Reading(
                f"friction {mu:g}, {floor} floor, gravity {gravity}, {wide:g} disks a row per layer",
                asked.at_most("difference from the elastic slab in the deepest one", deep, words, "holds", "%"),
                Condition("that per the one in the thinnest", Quantity.exact(deep / thin), most=1.0),
                change="" if gravity == "at-once" else "gravity",
            )
        )
    values = [reading.conditions[0].found.value for reading in readings]
    return Finding(
        f"the floor response of the deepest slab is {min(values):.2%} to {max(values):.2%} off the elastic one",
        readings,
    )
