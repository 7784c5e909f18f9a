"""Claim B1, beyond the paper: Saint-Venant's principle in granular packings (Sec. VI)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims import asked
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Claims, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "influence"
CLAIMS = Claims(GROUP)

#: Of the difference of two loads with the same force and torque, in an elastic body.
ELASTIC = 2.0


@CLAIMS.measures("B1")
def saint_venant(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "saint_venant")
    what = "power of the distance with which two equivalent loads differ less"
    readings, means = [], []
    for case in range(study.sizes["case"]):
        one = study.isel(case=case, separation=0)
        each = one["exponent"].values
        each = each[np.isfinite(each[:, 0])]
        CLAIMS.needs(len(each), "saint_venant holds no power, no rows are fitted")
        # of a lattice there is one: the range over the rows that are fitted
        found = over_realizations(each[:, 0], np.mean) if len(each) > 1 else Quantity.range(each[0])
        means.append(found.value)
        readings.append(Reading(asked.material(one), asked.near(what, found, words, "quite well", ELASTIC)))
    return Finding(
        f"the difference of a force and its two halves falls as the power {min(means):.2g} to {max(means):.2g} of the "
        "distance; 2 in an elastic body",
        readings,
    )
