"""Claim A4: large slabs against isotropic elasticity (abstract, Sec. VIII)."""

from __future__ import annotations

from granular_response_paper.claims.claim import Case, Data, Numbers
from granular_response_paper.records import alike


def large_systems(data: Data) -> Numbers:
    """A4: the difference in the deepest slab, and per that in the thinnest."""
    cases = alike(data.get("slab_comparison", "slabs"), "slab", "friction", "floor", "gravity", "disks_per_layer")
    for (mu, floor, gravity, wide), slabs in cases.items():
        thin, *_, deep = slabs.sortby("layers")["distance"].values
        name = f"friction {mu:g}, {floor} floor, {wide:g} disks a row per layer"
        yield Case(name, prepared="" if gravity == "at-once" else f"gravity {gravity}"), deep, deep / thin
