"""Claim D2: the linear range of one polydisperse slab, as in Fig. 20 (Sec. VI.A)."""

from __future__ import annotations

import numpy as np

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, NotMeasured, Reading
from ...claims.words import Bounds

GROUP = "polydisperse_averages"
CLAIMS = Claims(GROUP)


@CLAIMS.add(
    "D2",
    "VI.A, Fig. 20",
    "delta = 0.01, one realization, w = 3: end of the linear range at x = 0 over that of the lattice with the same "
    "friction",
    "shorter than in the lattice",
)
def shorter_range(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "linear_range", "response_at_centre", "force", "polydispersity", "friction")
    frictions = np.unique(study["friction"].values[np.isclose(study["polydispersity"].values, 0.01)]).tolist()
    readings, texts = [], []
    for tolerance in (0.01, 0.02, 0.05):
        conditions = []
        for mu in frictions:
            ends = []
            for delta in (0.01, 0.0):
                here = np.isclose(study["polydispersity"].values, delta) & np.isclose(study["friction"].values, mu)
                if not here.any():
                    raise NotMeasured(f"data/{GROUP}.nc: linear_range holds no {delta:g} with friction {mu:g}")
                ends.append(asked.linear_until(study.isel(path=int(np.flatnonzero(here)[0])), tolerance))
            conditions.append(Condition(f"range per lattice at friction {mu:g}", ends[0].per(ends[1]), most=1.0))
        if not conditions:
            raise NotMeasured(f"data/{GROUP}.nc: linear_range holds no polydispersity 0.01")
        texts.append(", ".join(f"{c.found.value:.2g}" for c in conditions) + f" ({tolerance:.0%} off)")
        readings.append(Reading(f"response {tolerance:.0%} off", *conditions))
    return Finding(
        f"end of the linear range per that of the lattice, smoothed alike, at friction "
        f"{', '.join(f'{mu:g}' for mu in frictions)}: " + "; ".join(texts),
        readings,
        "One realization, as in the paper",
    )
