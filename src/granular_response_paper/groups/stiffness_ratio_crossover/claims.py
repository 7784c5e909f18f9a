"""Claims K1, K5 and K6: the response against the ratio of the springs at large friction (Secs. V.B and V.C)."""

from __future__ import annotations

import numpy as np

from ...claims import asked
from ...claims.claim import Claims, Data, Finding, Quantity, Reading
from ...claims.words import Bounds

GROUP = "stiffness_ratio_crossover"
CLAIMS = Claims(GROUP)

#: The paper's crossover, and the largest ratio of its Fig. 10.
CROSSOVER, LARGEST = 0.3, 1.0


def _ends(data: Data) -> dict[str, Quantity]:
    """The crossover by what counts as one: two peaks end, end for good, the maximum at x = 0 begins."""
    study = data.get(GROUP, "response").sortby("stiffness_ratio")
    ratio, double = study["stiffness_ratio"].values, study["double_peaked"].values > 0
    last = np.flatnonzero(double)
    CLAIMS.needs(last.size and last[-1] + 1 < len(ratio), "response holds no end of two peaks")
    return {
        "two peaks end, going up": data.event(GROUP, "two_peaks_end"),
        "they end for good": Quantity.bracket(ratio[last[-1]], ratio[last[-1] + 1]),
        "the maximum at x = 0 begins": data.event(GROUP, "central_maximum_begins"),
    }


@CLAIMS.measures("K1a")
def crossover(data: Data, words: Bounds) -> Finding:
    ends = _ends(data)
    return Finding(
        ", ".join(f"{name}: {end.text()}" for name, end in ends.items()),
        [Reading(name, asked.near("crossover", end, words, "about", CROSSOVER)) for name, end in ends.items()],
    )


@CLAIMS.measures("K1b")
def independent(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "response").sortby("stiffness_ratio")
    ratio = study["stiffness_ratio"].values
    response = study["floor_response"].transpose("stiffness_ratio", "floor_disk").values
    usual = int(np.argmin(np.abs(ratio - 0.8)))
    change = np.abs(response - response[usual]).max(axis=1) / response[usual].max()
    found = {}
    for start in (0.4, 0.5):
        above = (ratio >= start - 1e-9) & (ratio <= LARGEST)
        CLAIMS.needs(above.sum() > 2, f"response holds too few ratios from {start:g} to {LARGEST:g}")
        found[f"from {start:g} on"] = change[above].max()
    what = "change from the response at 0.8, per its largest value"
    return asked.each(
        "largest change from the response at a ratio of 0.8: ",
        found,
        lambda largest: asked.at_most(what, largest, words, "nearly", "%"),
        form=".1%",
    )


@CLAIMS.measures("K5")
def no_sliding(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "response")
    sliding = study["sliding_contacts"].values[study["stiffness_ratio"].values > 0.0]
    return asked.one_reading(
        f"at most {sliding.max():.0f} contacts of disks at the Coulomb limit, at all ratios above 0",
        "at rest under 15 mg",
        asked.none_of("sliding contacts", sliding.max()),
    )


@CLAIMS.measures("K6")
def criterion(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "elastic")
    roots = dict(zip(study["rotations"].values.tolist(), study["root"].values.tolist(), strict=True))
    end = data.event(GROUP, "two_peaks_end")
    return Finding(
        f"root {roots['suppressed']:.4f} of the half plane without rotations, {roots['free']:.4f} with free ones; the "
        f"slab's two peaks end at {end.text()}",
        [
            Reading(
                name,
                asked.near("root per crossover of the slab", Quantity.exact(roots[key]).per(end), words, "quite well"),
            )
            for key, name in (("suppressed", "rotations suppressed, as in eq. (5)"), ("free", "disks free to turn"))
        ],
    )
