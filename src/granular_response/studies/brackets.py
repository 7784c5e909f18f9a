"""Two values between which something changes."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import GranularError


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
