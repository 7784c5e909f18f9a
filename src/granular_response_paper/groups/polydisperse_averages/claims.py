"""Claims D15 and D17: means of five packings, and the directions of contacts (Sec. VI.A)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Data, Quantity, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP = "polydisperse_averages"
CLAIMS = Claims(__package__)


@CLAIMS.measures("D15")
def nearly_symmetrical(data: Data, words: Words) -> list[Test]:
    few = at(data.get(GROUP, "averages"), width=6.0)
    mean = few["mean_of_few"].transpose("case", "step", "x").values[few["polydispersity"].values > 0.0]
    with np.errstate(invalid="ignore"):
        off = (np.abs(mean - mean[..., ::-1]).max(axis=-1) / mean.max(axis=-1)).ravel()
    least = Quantity.exact(np.nanmin(off))
    return [Test("difference from the mirror image", least, bounds.at_most(words, "nearly"), unit="%")]


@CLAIMS.measures("D17")
def preferred_directions(data: Data, words: Words) -> list[Test]:
    study = data.get(GROUP, "packings")
    lattice = np.radians([0.0, 60.0, 120.0, 180.0])
    near = (np.abs(study["angle"].values[:, None] - lattice) < np.radians(12.0)).any(axis=1)
    tests: dict[str, Test] = {}
    for case in np.flatnonzero((study["friction"].values == 0.0) & (study["polydispersity"].values > 0.0)):
        density = np.nanmean(study["contact_angle_density"].transpose("case", ..., "angle").values[case], axis=0)
        ratio = Quantity.exact(density[near].sum() / density.sum() / near.mean())
        name = f"polydispersity {float(study['polydispersity'][case]):g}"
        tests.setdefault(
            name, Test("contacts near the lattice's directions", ratio, bounds.higher(words, "visible"), name)
        )
    return list(tests.values())
