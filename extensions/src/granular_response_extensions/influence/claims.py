"""Claim B1, beyond the paper: Saint-Venant's principle in granular packings (Sec. VI)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

#: Of the difference of two loads with the same force and torque, in an elastic body.
ELASTIC = 2.0


@CLAIMS.measures("B1")
def saint_venant(data: Data, words: Words) -> list[Test]:
    study, tests = data.get("influence", "saint_venant"), []
    for case in range(study.sizes["case"]):
        one = study.isel(case=case, separation=0)
        each = one["exponent"].values
        each = each[np.isfinite(each[:, 0])]
        CLAIMS.needs(len(each), "saint_venant holds no power, no rows are fitted")
        # of a lattice there is one: the range over the rows that are fitted
        found = over_realizations(each[:, 0], np.mean) if len(each) > 1 else Quantity.range(each[0])
        tests.append(Test("power", found, bounds.near(words, "quite well", ELASTIC), bounds.material(one)))
    return tests
