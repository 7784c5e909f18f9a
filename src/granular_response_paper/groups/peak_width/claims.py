"""Claims B6 and B7, beyond the paper: is the response as wide as it is deep (Sec. II)?"""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Data, Kind, Measure, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

#: Power of depth with which the width of an elastic response grows, and the two definitions of the width.
ELASTIC, WIDTHS = 1.0, {"half_maximum": "half maximum", "half_force": "half of the force"}


def growth(name: str) -> Measure:
    def measure(data: Data, words: Words) -> list[Test]:
        study, tests = data.get("peak_width", name), []
        for case in range(study.sizes["case"]):
            one = study.isel(case=case)
            other = "prepared without friction" if str(one["gravity"].values) == "frictionless" else ""
            for definition, text in WIDTHS.items():
                bound = bounds.near(words, "about", ELASTIC)
                tests.append(
                    Test(f"power, {text}", power(one.sel(definition=definition)), bound, material(one), "", other)
                )
        return tests

    return measure


#: On lines inside the highest slab of each case, and on the floors of slabs of growing height.
CLAIMS.measures("B6")(growth("inside"))
CLAIMS.measures("B7")(growth("floors"))


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
    return (
        f"{f'δ = {delta:g}' if delta else 'lattice'}, friction {float(one['friction']):g}, "
        f"{f'force of {force:g} at 20 layers' if force else 'small force'}"
    )
