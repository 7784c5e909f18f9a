"""Two values between which something changes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ..errors import GranularError

#: Part of a value by which the two ends of an answer may differ and are said as one number, of four digits.
SAME = 1e-3


class EventNotBracketed(GranularError, ValueError):
    """The predicate says the same at both ends, so no event is known to lie between them."""


@dataclass(frozen=True)
class Bracket:
    """Two parameter values between which a predicate changes; the same one twice where it is known exactly.

    Examples
    --------
    >>> gr.Bracket(low=0.2, high=0.4, at_low=False, evaluations=5).width
    0.2
    """

    low: float
    high: float
    at_low: bool  #: the predicate at ``low``; at ``high`` it is the opposite
    evaluations: int  #: how often the predicate was called

    @property
    def middle(self) -> float:
        """Halfway between them."""
        return self.low + 0.5 * (self.high - self.low)

    @property
    def width(self) -> float:
        """Their difference."""
        return self.high - self.low

    @property
    def ends(self) -> tuple[float, float]:
        """Both of them."""
        return self.low, self.high


class First(NamedTuple):
    """Between which two values something happens first: after ``low``, and not after ``high``.

    ``low`` is 0 where it has happened at the first value already, ``high`` nan where it has not up to the last one.
    ``str`` says it in words.

    Examples
    --------
    >>> str(gr.studies.First(20.19, 20.2)), str(gr.studies.First(30.0, float("nan")))
    ('from 20.2', 'not up to 30')
    """

    low: float
    high: float

    @property
    def happened(self) -> bool:
        """Whether it happens at all."""
        return not math.isnan(self.high)

    def __str__(self) -> str:
        if not self.happened:
            return "not known" if math.isnan(self.low) else f"not up to {self.low:.4g}"
        if self.low == 0.0:
            return f"at {self.high:.4g} or below"
        if self.high - self.low > SAME * self.high:
            return f"between {self.low:.4g} and {self.high:.4g}"
        return f"from {self.high:.4g}"
