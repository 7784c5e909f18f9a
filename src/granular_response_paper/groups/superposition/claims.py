"""Claims U1 to U4: two loads at once (Sec. VI.B)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import RARE, over_realizations, part_of
from granular_response_paper.claims.claim import Bound, Data, Measure, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP = "superposition"
CLAIMS = Claims(__package__)

#: The paper's linear range, and errors by what they are of.
LINEAR = 0.4
ERRORS = {"floor forces": "floor_error_largest", "all contact forces": "contact_error_largest"}


def superposition(force: float, word: str) -> Measure:
    def measure(data: Data, words: Words) -> list[Test]:
        study = at(data.get(GROUP, "errors"), force=force)
        worst = {
            case: np.nanmax(study[name].transpose("realization", "distance").values, axis=1)
            for case, name in ERRORS.items()
        }
        return [
            Test("packings with so small a difference", part_of(one <= words[word]), Bound(RARE, word=word), case, "%")
            for case, one in worst.items()
        ]

    return measure


CLAIMS.measures("U1")(superposition(0.2, "holds"))
CLAIMS.measures("U3")(superposition(1.0, "quite well"))


@CLAIMS.measures("U2")
def linear_range(data: Data, words: Words) -> list[Test]:
    study = data.get(GROUP, "linear_range")
    until, beyond = study["linear_until"].values, study["nonlinear_from"].values
    # a path that does not end is beyond all others
    ends = np.where(np.isfinite(beyond), 0.5 * (until + beyond), np.inf)
    low, high = ((1.0 + sign * words["about"]) * LINEAR for sign in (-1.0, 1.0))
    return [
        Test(f"packings with an end below {high:g} mg", part_of(ends < high), Bound(RARE, word="about"), unit="%"),
        Test(f"packings with an end above {low:g} mg", part_of(ends > low), Bound(RARE, word="about"), unit="%"),
    ]


@CLAIMS.measures("U4")
def falls_with_depth(data: Data, words: Words) -> list[Test]:
    study = at(data.get(GROUP, "errors"), force=1.0).sortby("gap")
    error = study["row_error"].transpose("distance", "realization", "gap").values
    CLAIMS.needs(error.shape[2] > 1, "errors holds one depth")
    return [
        Test(
            "difference in the deepest row per the largest",
            over_realizations(one[:, -1] / one.max(axis=1)),
            bounds.lower(words, "marked"),
            f"loads {distance:g} apart",
        )
        for distance, one in zip(study["distance"].values.tolist(), error, strict=True)
    ]
