"""Claim A4: large slabs against isotropic elasticity (abstract, Sec. VIII)."""

from __future__ import annotations

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words
from granular_response_paper.records import alike

CLAIMS = Claims(__package__)


@CLAIMS.measures("A4")
def large_systems(data: Data, words: Words) -> list[Test]:
    cases = alike(data.get("slab_comparison", "slabs"), "slab", "friction", "floor", "gravity", "disks_per_layer")
    tests = []
    for (mu, floor, gravity, wide), slabs in cases.items():
        CLAIMS.needs(slabs.sizes["slab"] > 1, "slabs holds one depth of a case")
        thin, *_, deep = slabs.sortby("layers")["distance"].values
        name = f"friction {mu:g}, {floor} floor, {wide:g} disks a row per layer"
        other = "" if gravity == "at-once" else f"gravity {gravity}"
        close = bounds.at_most(words, "holds")
        tests += [
            Test("difference from the elastic slab in the deepest one", Quantity.exact(deep), close, name, "%", other),
            Test("that per the one in the thinnest", Quantity.exact(deep / thin), Bound(most=1.0), name, "", other),
        ]
    return tests
