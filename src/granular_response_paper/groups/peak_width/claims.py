"""Claims B6 and B7, beyond the paper: is the response as wide as it is deep (Sec. II)?"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from ...claims import asked
from ...claims.claim import Claims, Data, Finding, Kind, Quantity, Reading
from ...claims.words import Bounds

GROUP = "peak_width"
CLAIMS = Claims(GROUP)
#: Power of depth with which the width of an elastic response grows; force that diffuses has half of it, so that
#: "about" it, within a quarter, is nearer to it than to that.
ELASTIC = 1.0
#: The two definitions of the width.
WIDTHS = {"half_maximum": "half maximum", "half_force": "half of the force"}


def _growth(data: Data, words: Bounds, name: str, what: str) -> Finding:
    study = data.get(GROUP, name)
    readings, elastic, found = [], [], []
    for case in range(study.sizes["case"]):
        one = study.isel(case=case)
        by = {words_of_it: one.sel(definition=definition) for definition, words_of_it in WIDTHS.items()}
        readings.append(
            Reading(
                material(one),
                *(asked.near(f"{what}, {width}", power(these), words, "about", ELASTIC) for width, these in by.items()),
                change="gravity" if str(one["gravity"].values) == "frictionless" else "",
            )
        )
        found += [condition.found for condition in readings[-1].conditions]
        elastic += [float(these["elastic_power"].values[0]) for these in by.values()]
    values = [quantity.value for quantity in found]
    return Finding(
        f"the width grows as the power {min(values):.2g} to {max(values):.2g}, by the same code {min(elastic):.2g} to "
        f"{max(elastic):.2g} in elastic slabs of the same heights; no interval goes below "
        f"{min(quantity.low for quantity in found):.2g}",
        readings,
    )


#: On lines inside the highest slab of each case, and on the floors of slabs of growing height.
CLAIMS.measures("B6")(partial(_growth, name="inside", what="power of the depth"))
CLAIMS.measures("B7")(partial(_growth, name="floors", what="power of the height"))


def power(found: xr.Dataset) -> Quantity:
    """One power with its interval; raises NotMeasured where there is none."""
    value, (low, high) = float(found["power"].values[0]), found["interval"].values
    CLAIMS.needs(np.isfinite([value, low, high]).all(), "holds a width without a power")
    realizations = int(found["realizations"]) if "realizations" in found.coords else 1
    kind: Kind = "confidence" if realizations > 1 else "range"
    return Quantity(value, float(low), float(high), kind, samples=realizations)


def material(one: xr.Dataset) -> str:
    """A case in words."""
    delta, force = float(one["polydispersity"]), float(one["force"])
    prepared = ", prepared without friction" if str(one["gravity"].values) == "frictionless" else ""
    return (
        f"{f'δ = {delta:g}' if delta else 'lattice'}, friction {float(one['friction']):g}{prepared}, "
        f"{f'force of {force:g} at 20 layers' if force else 'small force'}"
    )
