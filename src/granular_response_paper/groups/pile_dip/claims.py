"""Claim P3: the regions of open contacts of two piles (Sec. V.F)."""

from __future__ import annotations

from granular_response_paper.claims.claim import Data, Numbers


def regions(data: Data) -> Numbers:
    """P3: with friction per without, and the aspect of the one per the other's."""
    study = data.get("pile_dip", "piles")
    full, without = (study.sel(case=case, drop=True) for case in ("frictional", "frictionless"))
    contacts, height, width = (float((full / without)[f"central_{n}"]) for n in ("open_contacts", "height", "width"))
    for name, size in (("contacts", contacts), ("height", height), ("width", width)):
        yield name, size, max(width / height, height / width)
