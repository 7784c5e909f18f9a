"""Claims B19, B22 and B25, beyond the paper: the experiments that it reviews, on packings like theirs."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import part_of
from granular_response_paper.claims.claim import Data, Quantity, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

NEARLY_EQUAL, TWO_SIZES, DEEP = "nearly equal", "bidisperse", "deep"


def _case(data: Data, packing: str, force: float, name: str = "means") -> xr.Dataset:
    study = data.get("experiments", name)
    return at(study, packing=packing, force_applied=force, angle_applied=90.0).assign_attrs(study.attrs)


@CLAIMS.measures("B19")
def holds(data: Data, words: Words) -> list[Test]:
    tests = []
    for packing in (NEARLY_EQUAL, TWO_SIZES):
        one = _case(data, packing, 150.0, "packings")
        found = part_of(one["moved"].dropna("realization") <= one.attrs["largest_move"])
        tests.append(Test("part that holds", found, bounds.at_least(words, "marked"), packing, "%"))
    return tests


@CLAIMS.measures("B22")
def fading(data: Data, words: Words) -> list[Test]:
    tests = []
    for force in (15.0, 3.0):
        excess = []
        for packing in (TWO_SIZES, NEARLY_EQUAL):
            value, low, high = (_case(data, packing, force)["contrast"].values - 1.0).tolist()
            excess.append(Quantity(value, low, high, "confidence", "bootstrap of the mean"))
        two, one = excess
        CLAIMS.needs(one.low > 0.0, f"nearly equal disks have no chains under {force:g} mg that could fade")
        tests.append(
            Test("excess per nearly equal disks'", two.per(one), bounds.lower(words, "marked"), f"{force:g} mg")
        )
    return tests


@CLAIMS.measures("B25")
def linear_force(data: Data, words: Words) -> list[Test]:
    whole, half = (_case(data, DEEP, force)["stress"].sel(estimate="mean") for force in (3.0, 1.5))
    inside = whole.where(whole["depth"] >= 4.0).dropna("depth")
    change = Quantity.range((abs(half - inside).max("x") / inside.max("x")).values)
    return [Test("difference per largest stress", change, bounds.at_most(words, "holds"), unit="%")]
