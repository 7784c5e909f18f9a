"""Claims P1 to P3: a pile of 11 layers with and without friction (Sec. V.F)."""

from __future__ import annotations

from collections.abc import Callable

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from ...claims.words import Bounds

GROUP = "pile_dip"
CLAIMS = Claims(GROUP)


def _dips(data: Data, case: str, wanted: Callable[..., Condition], words: Bounds) -> Finding:
    """The dip under the apex per largest value, by where it is read."""
    stress, floor = data.get(GROUP, "stress"), data.get(GROUP, "piles")
    dips = {
        "stress 4 radii above the floor": float(stress["dip"].sel(case=case)),
        "floor forces": float(floor["floor_dip"].sel(case=case)),
    }
    return asked.each("", dips, lambda dip: wanted("dip per largest value", dip, words, "visible", "%"), form=".2%")


@CLAIMS.measures("P1")
def dip_without_friction(data: Data, words: Bounds) -> Finding:
    return _dips(data, "frictionless", asked.at_least, words)


@CLAIMS.measures("P2")
def no_dip_with_friction(data: Data, words: Bounds) -> Finding:
    return _dips(data, "frictional", asked.at_most, words)


@CLAIMS.measures("P3")
def regions(data: Data, words: Bounds) -> Finding:
    names = {"central_open_contacts": "contacts", "central_height": "height", "central_width": "width"}
    study = data.get(GROUP, "piles")
    ratios = {
        text: float(study[name].sel(case="frictional")) / float(study[name].sel(case="frictionless"))
        for name, text in names.items()
    }
    limit = 1.0 + words["similar"]
    aspect = ratios["width"] / ratios["height"]
    shape = asked.higher("width per height, one pile over the other", max(aspect, 1.0 / aspect), words, "nearly")
    return Finding(
        "with friction over without: "
        + ", ".join(f"{text} {ratio:.2f}" for text, ratio in (ratios | {"width per height": aspect}).items()),
        [
            Reading(
                f"size as {text}",
                Condition("size with friction per without", Quantity.exact(ratio), 1.0 / limit, limit, ("similar",)),
                shape,
            )
            for text, ratio in ratios.items()
        ],
    )
