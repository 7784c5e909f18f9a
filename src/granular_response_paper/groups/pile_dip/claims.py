"""Claim P3: the regions of open contacts of two piles (Sec. V.F)."""

from __future__ import annotations

from granular_response_paper.claims.claim import Data, Numbers


def regions(data: Data) -> Numbers:
    """P3: with friction per without, and the aspect of the one per the other's."""
    study = data.get("pile_dip", "piles")
    ratios = {
        name: float(one.sel(case="frictional")) / float(one.sel(case="frictionless"))
        for name, one in ((name, study[f"central_{name}"]) for name in ("open_contacts", "height", "width"))
    }
    aspect = max(ratios["width"] / ratios["height"], ratios["height"] / ratios["width"])
    for name, size in ratios.items():
        yield name.replace("open_", ""), size, aspect
