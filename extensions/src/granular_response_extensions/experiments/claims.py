"""Claims B19, B22 and B25, beyond the paper: the experiments that it reviews, on packings like theirs."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims.bootstrap import part_of
from granular_response_paper.claims.claim import Data, Numbers, Quantity, at, needs


def _case(data: Data, packing: str, force: float, name: str = "means") -> xr.Dataset:
    return at(data.get("experiments", name), packing=packing, force_applied=force, angle_applied=90.0)


def holds(data: Data) -> Numbers:  # B19
    for packing in ("nearly equal", "bidisperse"):
        one = _case(data, packing, 150.0, "packings")
        yield packing, part_of(one["moved"].dropna("realization") <= one.attrs["largest_move"])


def _excess(data: Data, packing: str, force: float) -> Quantity:
    value, low, high = (_case(data, packing, force)["contrast"].values - 1.0).tolist()
    return Quantity(value, low, high, "confidence", "bootstrap of the mean")


def fading(data: Data) -> Numbers:  # B22
    for force in (15.0, 3.0):
        two, one = (_excess(data, packing, force) for packing in ("bidisperse", "nearly equal"))
        needs(one.low > 0.0, f"nearly equal disks have no chains under {force:g} mg that could fade")
        yield f"{force:g} mg", two.per(one)


def linear_force(data: Data) -> Numbers:  # B25
    whole, half = (_case(data, "deep", force)["stress"].sel(estimate="mean") for force in (3.0, 1.5))
    inside = whole.where(whole["depth"] >= 4.0).dropna("depth")
    yield "", Quantity.range((abs(half - inside).max("x") / inside.max("x")).values)
