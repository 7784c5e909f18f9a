"""Claim B10, beyond the paper: the linear law against the power 3/2 (Sec. III.B)."""

from __future__ import annotations

from ...claims import asked
from ...claims.claim import Claims, Data, Finding, Reading
from ...claims.words import Bounds

GROUP = "contact_law"
CLAIMS = Claims(GROUP)


@CLAIMS.measures("B10")
def linear_fit(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "responses")
    what = "largest difference of the responses, per largest response"
    largest = asked.by_friction(study.max("force"), "difference")
    values = largest.values()
    return Finding(
        f"responses by the two laws are at most {min(values):.1%} to {max(values):.1%} of the largest response apart",
        [Reading(name, asked.at_most(what, one, words, "quite well", "%")) for name, one in largest.items()],
    )
