"""Claim B18, beyond the paper: what the contacts at the Coulomb limit at rest decide (Sec. V)."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.stats import spearmanr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

#: Fewest preparations that have a trend.
FEWEST = 4
EVENTS = {"linear_range": "end of the linear range", "first_opening": "first opening", "crossover": "two peaks"}


@CLAIMS.measures("B18")
def mobilized(data: Data, words: Words) -> list[Test]:
    """For each slab with :data:`FEWEST` preparations: a falling trend, and one force without mobilized contacts."""
    study = data.get("preparation", "mobilized")
    study = study.isel(case=study["polydispersity"].values == 0.0)
    slabs = list(zip(study["wall_friction"].values.tolist(), study["friction"].values.tolist(), strict=True))
    tests = []
    for (event, text), margin in product(EVENTS.items(), study["margin"].values.tolist()):
        for slab in dict.fromkeys(slabs):
            alike = study.isel(case=[one == slab for one in slabs]).sel(name=event, margin=margin)
            part, force = alike["mobilized_part"].values, alike["force"].values
            free = force[part == 0.0]
            if np.isnan(force).any() or len(force) < FEWEST or np.ptp(part) == 0.0 or len(free) < 2:
                continue
            case = f"{text}, contacts within {margin:.0%} of the limit"
            where = f"friction {slab[1]:g}{', rough walls' if slab[0] else ''}"
            trend, spread = (Quantity.exact(one) for one in (spearmanr(part, force).statistic, free.max() / free.min()))
            falling = Bound(most=words["nearly"] - 1.0, word="nearly")
            tests.append(Test(f"rank correlation, {where}", trend, falling, case))
            same = bounds.near(words, "similar")
            tests.append(Test(f"largest per smallest force without them, {where}", spread, same, case))
    CLAIMS.needs(tests, f"mobilized holds no slab with {FEWEST} preparations")
    return tests
