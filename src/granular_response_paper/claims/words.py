"""Thresholds of the paper's qualitative terms, such as "about 20 mg": one table, used by every claim.

They are our interpretations, written when an earlier table of values was known; none is chosen for one claim. A star
beside a verdict says that it changes with one of them halved or doubled.
"""

from __future__ import annotations

import math

#: Each term with its threshold, a part of what is compared, and what it says.
WORDS: dict[str, tuple[float, str]] = {
    "about": (
        0.25,
        "About 20 is within a quarter of 20: what rounds to a number of one digit. Of a sampled force, the event "
        "itself lies at most that much below it.",
    ),
    "almost": (
        math.log10(2.0),
        "Almost an order of magnitude, on the logarithmic scale to which the paper points: within a factor of two, 0.3 "
        "of a decade, of ten. It calls 4/0.75 and 6/0.75 so.",
    ),
    "slightly": (0.25, "Slightly smaller, a little below, is at most a quarter less."),
    "small": (0.25, "Small is at most a quarter of what it is compared with."),
    "nearly": (0.1, "Nearly the same, nearly independent, saturated: changed by at most a tenth."),
    "similar": (0.5, "Similar, resembling: the larger exceeds the smaller, or they differ, by at most half."),
    "few per cent": (0.05, "Only a few per cent is at most five."),
    "visible": (
        0.01,
        "What a printed curve shows: a dip, a peak or a change of a hundredth of the largest value. No effect is less.",
    ),
    "holds": (0.05, "Holds, reflects exactly, agrees: the symbols of a plot, a twentieth of its height, overlap."),
    "quite well": (0.2, "Quite well: seen to differ, and by at most a fifth."),
    "gradual": (0.5, "Gradual: no step between neighbouring forces by half of the largest response; sharp: one."),
    "marked": (0.5, "Marked, significant, strong, considerable, very distinct: by at least half."),
    "several": (3.0, "Several hundred is at least three hundred."),
}

THRESHOLDS = {word: threshold for word, (threshold, _) in WORDS.items()}

#: By what a threshold is multiplied to see whether a verdict hangs on it.
FACTORS = (0.5, 2.0)

#: How far off a response is no longer linear: the text does not say.
TOLERANCES = (0.01, 0.02, 0.05)
