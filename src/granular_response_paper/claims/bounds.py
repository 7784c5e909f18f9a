"""What a sentence asks of a number, and the thresholds of the paper's qualitative terms: one table for every claim.

The thresholds are our interpretations, written when an earlier table of values was known; none is chosen for one
claim. A star beside a verdict says that it changes with one of them halved, or doubled to three quarters at most.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

from .bootstrap import RARE
from .numbers import Quantity, shown

Outcome = Literal["yes", "no", "cannot tell"]

#: Each term with its threshold, a part of what is compared, and what it says.
WORDS: dict[str, tuple[float, str]] = {
    "about": (
        0.25,
        "About 20 is within a quarter of 20: what rounds to a number of one digit. Of a sampled force, the event "
        "itself lies at most that much below it.",
    ),
    "almost": (
        math.log10(2.0),
        "Almost an order of magnitude is within a factor of two of ten, on the paper's logarithmic scale.",
    ),
    "slightly": (0.25, "Slightly smaller, a little below, is at most a quarter less."),
    "small": (0.25, "Small is at most a quarter of what it is compared with."),
    "nearly": (0.1, "Nearly the same, nearly independent, not sensitive, saturated: changed by at most a tenth."),
    "similar": (0.5, "Similar, resembling: the larger exceeds the smaller, or they differ, by at most half."),
    "few per cent": (0.05, "Only a few per cent is at most five."),
    "visible": (
        0.01,
        "What a printed curve shows: a dip, a peak or a change of a hundredth of the largest value. No effect is less.",
    ),
    "holds": (0.05, "Holds, almost exactly, agrees: the symbols of a plot, a twentieth of its height, overlap."),
    "quite well": (0.2, "Quite well: seen to differ, and by at most a fifth."),
    "gradual": (0.5, "Gradual: no step between neighbouring forces by half of the largest response; sharp: one."),
    "marked": (0.5, "Marked, significant, strong, considerable, very distinct: by at least half."),
}

THRESHOLDS = {word: threshold for word, (threshold, _) in WORDS.items()}

#: The largest threshold that is tried: a marked part is half, and doubled it would be the whole.
MOST = 0.75


def varied(threshold: float) -> tuple[float, float]:
    """The thresholds in its place that show whether a verdict hangs on it: half of it, and twice or :data:`MOST`."""
    return 0.5 * threshold, min(2.0 * threshold, MOST)


#: How far off a response is no longer linear: the text does not say.
TOLERANCES = (0.01, 0.02, 0.05)


class Limits(NamedTuple):
    """From ``least`` to ``most``, or with ``strict`` between them."""

    least: float
    most: float
    strict: bool = False

    def outcome(self, found: Quantity) -> Outcome:
        """Yes with the whole interval inside, no with all of it outside, cannot tell otherwise."""
        if self.strict:
            inside = self.least < found.low and (found.high < self.most or self.most == math.inf)
            outside = found.high <= self.least or found.low >= self.most
        else:
            inside = self.least <= found.low and found.high <= self.most
            outside = found.high < self.least or found.low > self.most
        return "yes" if inside else "no" if outside else "cannot tell"

    def text(self, unit: str = "") -> str:
        unit = "%" if unit == "part" else "" if unit == "count" else unit
        least, most = (shown(end, unit, 3) if math.isfinite(end) else "" for end in (self.least, self.most))
        if not most:
            return f"{'more than' if self.strict else 'at least'} {least}"
        if not least:
            return f"{'less than' if self.strict else 'at most'} {most}"
        return least if self.least == self.most else f"{least} to {most}"


@dataclass(frozen=True)
class Bound:
    """What the text asks of a number, by the threshold of the qualitative term ``word``, if one decides."""

    ends: Callable[[float], tuple[float, float]]
    word: str = ""
    strict: bool = False

    def limits(self, words: Mapping[str, float]) -> Limits:
        return Limits(*self.ends(words[self.word] if self.word else 0.0), self.strict)


def at_most(most: float | str, plus: float = 0.0) -> Bound:
    """A number, or the threshold of a term, ``plus`` something."""
    return Bound(lambda t: (-math.inf, t + plus), most) if isinstance(most, str) else Bound(lambda t: (-math.inf, most))


def at_least(least: float | str) -> Bound:
    return Bound(lambda t: (t, math.inf), least) if isinstance(least, str) else Bound(lambda t: (least, math.inf))


def less_than(most: float, word: str = "") -> Bound:
    return Bound(lambda t: (-math.inf, most), word, strict=True)


def more_than(least: float, word: str = "") -> Bound:
    return Bound(lambda t: (least, math.inf), word, strict=True)


def between(least: float, most: float) -> Bound:
    return Bound(lambda t: (least, most))


def within(word: str, of: float = 1.0) -> Bound:
    """Within the threshold of a term, as a part of it, of a number."""
    return Bound(lambda t: ((1.0 - t) * of, (1.0 + t) * of), word)


about = partial(within, "about")


def sampled(force: float) -> Bound:
    """Of an event that the paper saw at a force which it chose: the event is there, or about so much below."""
    return Bound(lambda t: ((1.0 - t) * force, force), "about")


#: A part of samples that is not rare, as more than one in forty; a term decides what counts, if one does.
rare = partial(Bound, lambda t: (RARE, math.inf))
#: Of ratios, by a term.
lower_by = partial(Bound, lambda t: (-math.inf, 1.0 - t))
hardly_lower = partial(Bound, lambda t: (1.0 - t, math.inf))
higher_by = partial(Bound, lambda t: (1.0 + t, math.inf))
same_size = partial(Bound, lambda t: (1.0 / (1.0 + t), 1.0 + t))
order_of_magnitude = partial(Bound, lambda t: (10.0 ** (1.0 - t), 10.0 ** (1.0 + t)), "almost")
