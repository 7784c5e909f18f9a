"""Claims B8 and B9, beyond the paper: finite size, with friction too (Secs. IV.B, IV.C and VIII)."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims import asked
from granular_response_paper.claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "crossover_scaling"
CLAIMS = Claims(GROUP)
#: Of the layers: the weight of a piece of the slab that is as wide as deep.
OF_WEIGHT = 2.0


def _powers(data: Data, event: str) -> list[tuple[str, xr.Dataset]]:
    """What each series of layers is, and its powers of the layers."""
    study = data.get(GROUP, "powers")
    found = []
    for k in range(study.sizes["series"]):
        one = study.isel(series=k).sel(event=event)
        if str(one["varied"].values) == "layers":
            kind = str(one["confined"].values)
            sides = {"walls": "between walls", "constant": "constant confinement"}.get(kind, "confined as weight")
            found.append((f"friction {float(one['friction']):g}, {sides}", one))
    CLAIMS.needs(found, "powers holds no series of layers")
    return found


def _quantity(ends: xr.DataArray) -> Quantity:
    value, least, largest = ends.values.tolist()
    return Quantity.range((least, largest), value)


@CLAIMS.measures("B8")
def deep_and_shallow(data: Data, words: Bounds) -> Finding:
    series = _powers(data, "crossover")
    layers = float(data.get(GROUP, "powers").attrs["layers"])
    texts = [f"{_quantity(one['exponent']).text()} ({name})" for name, one in series]
    far = [f"{_quantity(one['extrapolated']).text('mg')} ({name})" for name, one in series]
    return Finding(
        "crossover force grows with the layers as the power " + "; ".join(texts),
        [
            Reading(name, Condition("power of the layers", _quantity(one["exponent"]), 0.0, strict=True))
            for name, one in series
        ],
        f"Extrapolated to {layers:g} layers: " + "; ".join(far),
    )


@CLAIMS.measures("B9")
def of_weight(data: Data, words: Bounds) -> Finding:
    readings, texts = [], []
    for event, what in (("reaches_floor", "open region at the floor"), ("crossover", "two peaks")):
        series = [(name, _quantity(one["exponent"])) for name, one in _powers(data, event) if _by_itself(one)]
        texts.append(f"{what}: " + "; ".join(f"{power.text()} ({name})" for name, power in series))
        readings += [
            Reading(f"{what}, {name}", asked.near("power of the layers", power, words, "nearly", OF_WEIGHT))
            for name, power in series
        ]
    CLAIMS.needs(readings, "powers holds no series in which gravity could decide")
    return Finding("powers of the layers: " + "; ".join(texts), readings)


def _by_itself(one: xr.Dataset) -> bool:
    """Whether the power is not that of the weight by choice: no friction and a confinement that grows with it."""
    return bool(float(one["friction"]) > 0.0 or str(one["confined"].values) != "as weight")
