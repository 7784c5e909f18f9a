"""Claims K1b and K7: what the response at large friction does not depend on (Sec. V.B)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Data, Quantity, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP = "stiffness_ratio_crossover"
CLAIMS = Claims(__package__)

#: The ratio of most of the paper's simulations, and the largest one of its Fig. 10.
USUAL, LARGEST = 0.8, 1.0


@CLAIMS.measures("K1b")
def independent(data: Data, words: Words) -> list[Test]:
    study = data.get(GROUP, "response").sortby("stiffness_ratio")
    ratio = study["stiffness_ratio"].values
    response = study["floor_response"].transpose("stiffness_ratio", "floor_disk").values
    usual = int(np.argmin(np.abs(ratio - USUAL)))
    change = np.abs(response - response[usual]).max(axis=1) / response[usual].max()
    tests = []
    for start in (0.4, 0.5):
        above = (ratio >= start - 1e-9) & (ratio <= LARGEST)
        CLAIMS.needs(above.sum() > 2, f"response holds too few ratios from {start:g} to {LARGEST:g}")
        largest = Quantity.exact(change[above].max())
        tests.append(Test("largest change", largest, bounds.at_most(words, "nearly"), f"from {start:g} on", "%"))
    return tests


@CLAIMS.measures("K7")
def immaterial(data: Data, words: Words) -> list[Test]:
    much = at(data.get(GROUP, "response"), stiffness_ratio=USUAL)["floor_response"].values
    less = data.get("friction_linear_range", "friction_axis").sortby("friction").isel(friction=-1)
    CLAIMS.needs(float(less["friction"]) >= 2.0, "friction_axis does not reach friction 2")
    change = Quantity.exact(np.abs(less["floor_response"].values - much).max() / much.max())
    return [Test("difference per largest response", change, bounds.at_most(words, "nearly"), unit="%")]
