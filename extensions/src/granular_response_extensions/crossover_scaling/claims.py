"""Claims B8 and B9, beyond the paper: finite size, with friction too (Secs. IV.B, IV.C and VIII)."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

#: Of the layers: the weight of a piece of the slab that is as wide as deep. And how the sides are confined, in words.
OF_WEIGHT = 2.0
SIDES = {"walls": "between walls", "constant": "constant confinement", "as weight": "confined as weight"}


def _series(data: Data, event: str) -> list[tuple[str, xr.Dataset]]:
    """What each series of layers is, and its powers of the layers."""
    study = data.get("crossover_scaling", "powers")
    every = (study.isel(series=k).sel(event=event) for k in range(study.sizes["series"]))
    found = [one for one in every if str(one["varied"].values) == "layers"]
    CLAIMS.needs(found, "powers holds no series of layers")
    return [(f"friction {float(one['friction']):g}, {SIDES[str(one['confined'].values)]}", one) for one in found]


def _power(one: xr.Dataset) -> Quantity:
    value, least, largest = one["exponent"].values.tolist()
    return Quantity.range((least, largest), value)


@CLAIMS.measures("B8")
def deep_and_shallow(data: Data, words: Words) -> list[Test]:
    bound = Bound(0.0, strict=True)
    return [Test("power of the layers", _power(one), bound, name) for name, one in _series(data, "crossover")]


@CLAIMS.measures("B9")
def of_weight(data: Data, words: Words) -> list[Test]:
    """Of the series in which the power is not that of the weight by choice of the confinement."""
    tests = [
        Test("power of the layers", _power(one), bounds.near(words, "nearly", OF_WEIGHT), f"{what}, {name}")
        for event, what in (("reaches_floor", "open region at the floor"), ("crossover", "two peaks"))
        for name, one in _series(data, event)
        if float(one["friction"]) > 0.0 or str(one["confined"].values) != "as weight"
    ]
    CLAIMS.needs(tests, "powers holds no series in which gravity could decide")
    return tests
