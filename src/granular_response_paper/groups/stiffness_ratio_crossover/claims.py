"""Claims K1b and K7: what the response at large friction does not depend on (Sec. V.B)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.claim import Data, Numbers, at, needs
from granular_response_paper.claims.words import Words

#: The ratio of most of the paper's simulations, and the largest one of its Fig. 10.
USUAL, LARGEST = 0.8, 1.0


def independent(data: Data, words: Words) -> Numbers:
    """K1b."""
    study = data.get("stiffness_ratio_crossover", "response").sortby("stiffness_ratio")
    ratio = study["stiffness_ratio"].values
    response = study["floor_response"].transpose("stiffness_ratio", "floor_disk").values
    usual = int(np.argmin(np.abs(ratio - USUAL)))
    change = np.abs(response - response[usual]).max(axis=1) / response[usual].max()
    for start in (0.4, 0.5):
        above = (ratio >= start - 1e-9) & (ratio <= LARGEST)
        needs(above.sum() > 2, f"response holds too few ratios from {start:g} to {LARGEST:g}")
        yield f"from {start:g} on", change[above].max()


def immaterial(data: Data, words: Words) -> Numbers:
    """K7."""
    much = at(data.get("stiffness_ratio_crossover", "response"), stiffness_ratio=USUAL)["floor_response"].values
    less = data.get("friction_linear_range", "friction_axis").sortby("friction").isel(friction=-1)
    needs(float(less["friction"]) >= 2.0, "friction_axis does not reach friction 2")
    yield "", np.abs(less["floor_response"].values - much).max() / much.max()
