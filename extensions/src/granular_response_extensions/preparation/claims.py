"""Claim B18, beyond the paper: what the contacts at the Coulomb limit at rest decide (Sec. V)."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.stats import spearmanr

from granular_response_paper.claims.claim import Case, Data, Numbers
from granular_response_paper.records import alike

#: Fewest preparations that have a trend.
FEWEST = 4
EVENTS = {"linear_range": "end of the linear range", "first_opening": "first opening", "crossover": "two peaks"}


def mobilized(data: Data) -> Numbers:
    """B18, for each slab with :data:`FEWEST` preparations: the trend, and how forces without such contacts differ."""
    study = data.get("preparation", "mobilized")
    study = study.isel(case=study["polydispersity"].values == 0.0)
    slabs = alike(study, "case", "wall_friction", "friction").items()
    for (event, text), margin, ((wall, mu), slab) in product(EVENTS.items(), study["margin"].values.tolist(), slabs):
        one = slab.sel(name=event, margin=margin)
        part, force = one["mobilized_part"].values, one["force"].values
        free = force[part == 0.0]
        if np.isfinite(force).all() and len(force) >= FEWEST and np.ptp(part) > 0.0 and len(free) > 1:
            where = f"friction {mu:g}{', rough walls' if wall else ''}"
            case = Case(f"{text}, contacts within {margin:.0%} of the limit", where)
            yield case, spearmanr(part, force).statistic, free.max() / free.min()
