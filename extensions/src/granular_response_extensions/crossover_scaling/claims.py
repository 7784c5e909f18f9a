"""Claims B8 and B9, beyond the paper: finite size, with friction too (Secs. IV.B, IV.C and VIII)."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims.claim import Data, Numbers, Quantity, needs

#: How the sides are confined, in words.
SIDES = {"walls": "between walls", "constant": "constant confinement", "as weight": "confined as weight"}


def _series(data: Data, event: str) -> list[tuple[str, xr.Dataset, Quantity]]:
    """What each series of layers is, and its power of the layers."""
    study = data.get("crossover_scaling", "powers")
    every = (study.isel(series=k).sel(event=event) for k in range(study.sizes["series"]))
    found = [one for one in every if str(one["varied"].values) == "layers"]
    needs(found, "powers holds no series of layers")
    names = [f"friction {float(one['friction']):g}, {SIDES[str(one['confined'].values)]}" for one in found]
    ends = [one["exponent"].values.tolist() for one in found]
    return list(zip(names, found, (Quantity.range(end[1:], end[0]) for end in ends), strict=True))


def deep_and_shallow(data: Data) -> Numbers:  # B8
    for name, _, power in _series(data, "crossover"):
        yield name, power


def of_weight(data: Data) -> Numbers:
    """B9, of the series in which the power is not that of the weight by choice of the confinement."""
    found = {
        f"{what}, {name}": power
        for event, what in (("reaches_floor", "open region at the floor"), ("crossover", "two peaks"))
        for name, one, power in _series(data, event)
        if float(one["friction"]) > 0.0 or str(one["confined"].values) != "as weight"
    }
    needs(found, "powers holds no series in which gravity could decide")
    yield from found.items()
