"""Claim B18, beyond the paper: what the contacts at the Coulomb limit at rest decide (Sec. V)."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.stats import spearmanr

from granular_response_paper.claims.bounds import at_most, within
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers
from granular_response_paper.records import alike

claim = Claims("preparation")

#: Fewest preparations that have a trend.
FEWEST = 4
EVENTS = {"linear_range": "end of the linear range", "first_opening": "first opening", "crossover": "two peaks"}


@claim("B18", "beyond the paper, V", Ask("rank correlation", at_most("nearly", plus=-1.0)),
       Ask("largest per smallest force without mobilized contacts", within("similar")),
       primary="end of the linear range, contacts within 1% of the limit, friction 0.2", source="hypothesis",
       finds="not supported")  # fmt: skip
def mobilized(data: Data) -> Numbers:
    """The fraction of fully mobilized contacts in the initial equilibrium determines the response.
    Short: Fully mobilized contacts in the initial equilibrium decide the response
    Here: At friction 0.2 the rank correlation of the linear range with the fraction of fully mobilized contacts is {0}
    (-1: it always falls); without such contacts its largest force is {1} times its smallest.
    Remark: Over preparations of one ordered slab"""
    study = data.get("preparation", "mobilized")
    study = study.isel(case=study["polydispersity"].values == 0.0)
    slabs = alike(study, "case", "wall_friction", "friction").items()
    for (event, text), margin, ((wall, mu), slab) in product(EVENTS.items(), study["margin"].values.tolist(), slabs):
        one = slab.sel(name=event, margin=margin)
        part, force = one["mobilized_part"].values, one["force"].values
        free = force[part == 0.0]
        if np.isfinite(force).all() and len(force) >= FEWEST and np.ptp(part) > 0.0 and len(free) > 1:
            where = f"friction {mu:g}{', rough walls' if wall else ''}"
            name = f"{text}, contacts within {margin:.0%} of the limit, {where}"
            yield name, spearmanr(part, force).statistic, free.max() / free.min()
