"""Claims U1 to U4: two loads at once (Sec. VI.B)."""

from __future__ import annotations

import numpy as np

from ...claims import asked
from ...claims.bootstrap import over_realizations
from ...claims.claim import Claims, Data, Finding, Measure, Reading, at
from ...claims.words import Bounds

GROUP = "superposition"
CLAIMS = Claims(GROUP)


def superposition(force: float, word: str) -> Measure:
    def measure(data: Data, words: Bounds) -> Finding:
        names = {"floor forces": "floor_error_largest", "all contact forces": "contact_error_largest"}
        study = at(data.get(GROUP, "errors"), force=force)
        readings, texts = [], []
        for text, name in names.items():
            error = study[name].transpose("realization", "distance").values
            worst = np.nanmax(error, axis=1)  # over distances
            typical = over_realizations(worst)
            texts.append(f"{text} {typical.text('%')}, {worst.max():.1%} in the worst")
            what = "largest difference of whole and sum, median of the realizations"
            readings.append(Reading(text, asked.at_most(what, typical, words, word, "%")))
        return Finding(
            f"largest difference of whole and sum per largest added force, at the worst of {study.sizes['distance']} "
            f"distances, median of {len(worst)} realizations: " + "; ".join(texts),
            readings,
        )

    return measure


CLAIMS.measures("U1")(superposition(0.2, "holds"))


@CLAIMS.measures("U2")
def linear_range(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "linear_range")
    until, beyond = study["linear_until"].values, study["nonlinear_from"].values
    # a path that does not end is beyond all others
    ends = np.where(np.isfinite(beyond), 0.5 * (until + beyond), 1e6)
    last = f"{beyond.max():.3g} mg" if np.isfinite(beyond).all() else f"beyond {until.max():.3g} mg"
    return asked.one_reading(
        f"median {np.median(ends):.3g} mg; single realizations end between {until.min():.3g} mg and {last}",
        "5 % off, one realization",
        *asked.one_of("an end of the linear range, mg,", ends, 0.4, words, "about"),
    )


CLAIMS.measures("U3")(superposition(1.0, "quite well"))


@CLAIMS.measures("U4")
def falls_with_depth(data: Data, words: Bounds) -> Finding:
    study = at(data.get(GROUP, "errors"), force=1.0).sortby("gap")
    error = study["row_error"].transpose("distance", "realization", "gap").values
    CLAIMS.needs(error.shape[2] > 1, "errors holds one depth")
    falls = {
        f"loads {distance:g} apart": over_realizations(one[:, -1] / one.max(axis=1))
        for distance, one in zip(study["distance"].values.tolist(), error, strict=True)
    }
    return asked.each(
        "rms difference of whole and sum in the deepest row of contacts per the largest of any row, each per force in "
        "its row: ",
        falls,
        lambda fall: asked.lower("difference in the deepest row per the largest of any row", fall, words, "marked"),
        form=".2f",
    )
