"""Claims B4 and B5, beyond the paper: disordered packings as elastic slabs, with nothing to fit (Sec. I)."""

from __future__ import annotations

import math

import numpy as np

from granular_response_paper.claims import asked
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Claims, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "moduli"
CLAIMS = Claims(GROUP)


def _described(data: Data, words: Bounds, solid: str, of: str) -> Finding:
    study = data.get(GROUP, "packings")
    readings: list[Reading] = []
    values: dict[bool, list[float]] = {True: [], False: []}
    for case in range(study.sizes["case"]):
        largest = int(np.nanargmax(study["layers"].values[case]))
        one = study.isel(case=case, size=largest, smoothing=0)
        found = over_realizations(one["difference"].sel(solid=solid).values, np.mean)
        values[bool(one["friction"] > 0.0)].append(found.value)
        what = f"largest difference to the {of} slab per its largest pressure, mean of packings"
        name = f"{asked.material(one)}, {float(one['layers']):g} layers"
        readings.append(Reading(name, asked.at_most(what, found, words, "nearly", "%")))
    parts = [
        f"{Quantity.range(these, math.nan).text('%')} {'with' if friction else 'without'} friction"
        for friction, these in values.items()
        if these
    ]
    return Finding(f"part of the largest pressure by which they differ: {', '.join(parts)}", readings)


@CLAIMS.measures("B4")
def by_their_moduli(data: Data, words: Bounds) -> Finding:
    return _described(data, words, "free", "elastic")


@CLAIMS.measures("B5")
def isotropic(data: Data, words: Bounds) -> Finding:
    return _described(data, words, "isotropic", "isotropic")
