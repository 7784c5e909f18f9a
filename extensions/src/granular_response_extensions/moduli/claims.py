"""Claims B4 and B5, beyond the paper: disordered packings as elastic slabs, with nothing to fit (Sec. I)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Measure, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)


def described(solid: str) -> Measure:
    """In the highest packings of each case."""

    def measure(data: Data, words: Words) -> list[Test]:
        study, tests = data.get("moduli", "packings"), []
        for case in range(study.sizes["case"]):
            one = study.isel(case=case, size=int(np.nanargmax(study["layers"].values[case])), smoothing=0)
            found = over_realizations(one["difference"].sel(solid=solid).values, np.mean)
            what, name = (
                f"largest difference to the {solid} slab",
                f"{bounds.material(one)}, {float(one['layers']):g} layers",
            )
            tests.append(Test(what, found, bounds.at_most(words, "nearly"), name, "%"))
        return tests

    return measure


CLAIMS.measures("B4")(described("free"))
CLAIMS.measures("B5")(described("isotropic"))
