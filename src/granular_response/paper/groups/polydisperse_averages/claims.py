"""Claim D2: the linear range of one polydisperse slab, as in Fig. 20 (Sec. VI.A)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ...claims.claim import Claim, Condition, Data, Finding, NotMeasured, Quantity, Reading
from ...claims.words import Bounds

GROUP = "polydisperse_averages"


def _end(path: xr.Dataset, tolerance: float) -> Quantity:
    """Where the smoothed response at x = 0 leaves that to the smallest force by more than ``tolerance``."""
    value, force = path["response_at_centre"].values, path["force"].values
    known = np.isfinite(value)
    value, force = value[known], force[known]
    if value.size < 2:
        raise NotMeasured(f"data/{GROUP}.nc: linear_range holds a path without forces")
    off = np.flatnonzero(np.abs(value / value[0] - 1.0) > tolerance)
    if not off.size:
        return Quantity.bracket(float(force[-1]), float("nan"))
    return Quantity.bracket(float(force[off[0] - 1]), float(force[off[0]]))


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
                ends.append(_end(study.isel(path=int(np.flatnonzero(here)[0])), tolerance))
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


CLAIMS = (
    Claim(
        "D2",
        "VI.A, Fig. 20",
        "delta = 0.01, one realization, w = 3: end of the linear range at x = 0 over that of the lattice with the same "
        "friction",
        "shorter than in the lattice",
        shorter_range,
        (20,),
        GROUP,
    ),
)
