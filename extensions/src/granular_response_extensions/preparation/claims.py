"""Claim B18, beyond the paper: what the contacts at the Coulomb limit at rest decide (Sec. V)."""

from __future__ import annotations

import numpy as np
from scipy.stats import spearmanr

from granular_response_paper.claims import asked
from granular_response_paper.claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "preparation"
CLAIMS = Claims(GROUP)
#: Fewest preparations that have a trend.
FEWEST = 4
EVENTS = {"linear_range": "end of the linear range", "first_opening": "first opening", "crossover": "two peaks"}


@CLAIMS.measures("B18")
def mobilized(data: Data, words: Bounds) -> Finding:
    """For each slab with :data:`FEWEST` preparations: a falling trend, and one force without mobilized contacts."""
    study = data.get(GROUP, "mobilized")
    study = study.isel(case=study["polydispersity"].values == 0.0)
    slabs = list(zip(study["wall_friction"].values.tolist(), study["friction"].values.tolist(), strict=True))
    readings, trends, spreads = [], [], []
    for event, text in EVENTS.items():
        for margin in study["margin"].values.tolist():
            conditions: list[Condition] = []
            for slab in dict.fromkeys(slabs):
                alike = study.isel(case=[one == slab for one in slabs]).sel(name=event, margin=margin)
                part, force = alike["mobilized_part"].values, alike["force"].values
                free = force[part == 0.0]
                if np.isnan(force).any() or len(force) < FEWEST or np.ptp(part) == 0.0 or len(free) < 2:
                    continue
                trends.append(float(spearmanr(part, force).statistic))
                spreads.append(float(free.max() / free.min()))
                where = f"friction {slab[1]:g}{', rough walls' if slab[0] else ''}"
                trend, none = f"rank correlation, {where}", f"largest over smallest force without them, {where}"
                falling = Condition(trend, Quantity.exact(trends[-1]), most=words["nearly"] - 1.0, words=("nearly",))
                conditions += [falling, asked.near(none, spreads[-1], words, "similar")]
            if conditions:
                readings.append(Reading(f"{text}, contacts within {margin:.0%} of the limit", *conditions))
    CLAIMS.needs(readings, f"mobilized holds no slab with {FEWEST} preparations")
    return Finding(
        f"the rank correlation is {min(trends):.2f} to {max(trends):.2f}, -1 for a falling trend; without mobilized "
        f"contacts the forces of one friction differ by a factor of up to {max(spreads):.3g}",
        readings,
    )
