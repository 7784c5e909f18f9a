"""Claims B4 and B5, beyond the paper: disordered packings as elastic slabs, with nothing to fit (Sec. I)."""

from __future__ import annotations

import math

import numpy as np

from ...claims import asked
from ...claims.bootstrap import over_realizations
from ...claims.claim import Claims, Data, Finding, Quantity, Reading
from ...claims.words import Bounds

GROUP = "moduli"
CLAIMS = Claims(GROUP)


def _described(data: Data, words: Bounds, solid: str, of: str) -> Finding:
    study = data.get(GROUP, "packings", "difference", "layers", "polydispersity", "friction")
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
    return Finding(
        f"part of the largest pressure by which they differ: {', '.join(parts)}",
        readings,
        "Mean over the small loads on the top disks of a packing, smoothed with w = 3; no parameter is fitted. Even in "
        "the presence of friction, says the paper, which includes none",
    )


@CLAIMS.add(
    "B4",
    "beyond the paper, I",
    "response of disordered packings to small loads beside the elastic slab of their own measured moduli",
    "large systems under small forces can be described by elasticity",
)
def by_their_moduli(data: Data, words: Bounds) -> Finding:
    return _described(data, words, "free", "elastic")


@CLAIMS.add(
    "B5",
    "beyond the paper, I",
    "the same beside the isotropic slab nearest to these moduli",
    "large systems under small forces can be described by isotropic elasticity",
)
def isotropic(data: Data, words: Bounds) -> Finding:
    return _described(data, words, "isotropic", "isotropic")
