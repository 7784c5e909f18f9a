"""Claim B1, beyond the paper: Saint-Venant's principle in granular packings (Sec. VI)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Numbers, Quantity, materials


def saint_venant(data: Data) -> Numbers:  # B1
    for name, one in materials(data.get("influence", "saint_venant")):
        each = one["exponent"].isel(separation=0).values
        each = each[np.isfinite(each[:, 0])]
        # of a lattice there is one: the range over the rows that are fitted
        found = over_realizations(each[:, 0], np.mean) if len(each) > 1 else Quantity.range(each[0])
        yield name, found
