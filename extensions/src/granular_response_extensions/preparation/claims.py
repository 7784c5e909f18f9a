"""Claim B18, beyond the paper: what the contacts at the Coulomb limit at rest decide (Sec. V)."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.stats import spearmanr

from granular_response_paper.claims.claim import Case, Data, Numbers

#: Fewest preparations that have a trend.
FEWEST = 4
EVENTS = {"linear_range": "end of the linear range", "first_opening": "first opening", "crossover": "two peaks"}


def mobilized(data: Data) -> Numbers:
    """B18, for each slab with :data:`FEWEST` preparations: the trend, and how forces without such contacts differ."""
    study = data.get("preparation", "mobilized")
    study = study.isel(case=study["polydispersity"].values == 0.0)
    slabs = list(zip(study["wall_friction"].values.tolist(), study["friction"].values.tolist(), strict=True))
    for (event, text), margin in product(EVENTS.items(), study["margin"].values.tolist()):
        for slab in dict.fromkeys(slabs):
            alike = study.isel(case=[one == slab for one in slabs]).sel(name=event, margin=margin)
            part, force = alike["mobilized_part"].values, alike["force"].values
            free = force[part == 0.0]
            if np.isnan(force).any() or len(force) < FEWEST or np.ptp(part) == 0.0 or len(free) < 2:
                continue
            where = f"friction {slab[1]:g}{', rough walls' if slab[0] else ''}"
            case = Case(f"{text}, contacts within {margin:.0%} of the limit", where)
            yield case, spearmanr(part, force).statistic, free.max() / free.min()
