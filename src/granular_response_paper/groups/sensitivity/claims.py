"""The claim of Sec. III.B on the law of the normal force."""

from __future__ import annotations

from ...claims import bounds
from ...claims.claim import Data, Quantity, Test
from ...claims.declared import Claims
from ...claims.words import Words

CLAIMS = Claims(__package__)


@CLAIMS.measures("N9")
def linear_law(data: Data, words: Words) -> list[Test]:
    found = []
    for friction in (0.2, 1.0):
        study = data.get("sensitivity", f"mu_{friction:g}")
        names = study["variant"].values.astype(str).tolist()
        CLAIMS.needs("hertz" in names, "no variant with the 3/2 law is stored")
        largest = float(study["floor_response"].values[names.index("reference")].max())
        apart = float(study["largest_difference"].values[names.index("hertz")]) / largest
        found.append(
            Test(
                "largest difference per largest response",
                Quantity.exact(apart),
                bounds.at_most(words, "quite well"),
                f"friction {friction:g}",
                "%",
            )
        )
    return found
