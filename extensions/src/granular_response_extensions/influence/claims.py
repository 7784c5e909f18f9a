"""Claim B1, beyond the paper: Saint-Venant's principle in granular packings (Sec. VI)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Numbers, Quantity, material, needs


def saint_venant(data: Data) -> Numbers:  # B1
    study = data.get("influence", "saint_venant")
    for case in range(study.sizes["case"]):
        one = study.isel(case=case, separation=0)
        each = one["exponent"].values
        each = each[np.isfinite(each[:, 0])]
        needs(len(each), "saint_venant holds no power, no rows are fitted")
        # of a lattice there is one: the range over the rows that are fitted
        found = over_realizations(each[:, 0], np.mean) if len(each) > 1 else Quantity.range(each[0])
        yield material(one), found
