"""Claim P3: the regions of open contacts of two piles (Sec. V.F)."""

from __future__ import annotations

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)


@CLAIMS.measures("P3")
def regions(data: Data, words: Words) -> list[Test]:
    study = data.get("pile_dip", "piles")
    contacts, height, width = (
        float(study[f"central_{name}"].sel(case="frictional"))
        / float(study[f"central_{name}"].sel(case="frictionless"))
        for name in ("open_contacts", "height", "width")
    )
    limit = 1.0 + words["similar"]
    sizes = {"contacts": contacts, "height": height, "width": width}
    aspect = Quantity.exact(max(width / height, height / width))
    return [
        test
        for case, size in sizes.items()
        for test in (
            Test("size with friction per without", Quantity.exact(size), Bound(1 / limit, limit, "similar"), case),
            Test("width per height, one pile over the other", aspect, bounds.higher(words, "nearly"), case),
        )
    ]
