"""Locate an event (a first opening, a crossover, a loss of symmetry) between two parameter values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..errors import GranularError
from .positive import check_positive


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


def bisect_event(
    predicate: Callable[[float], bool],
    low: float,
    high: float,
    tolerance: float,
    *,
    at_low: bool | None = None,
    at_high: bool | None = None,
) -> Bracket:
    """Halve ``[low, high]`` until it is at most ``tolerance`` wide and still holds a change of ``predicate``.

    Calls the predicate once per halving and at each end whose value (``at_low``, ``at_high``) is not given.
    If the predicate changes several times, one of the changes is found. The result can be wider than the
    tolerance only where floating-point numbers are sparser than it.

    Raises ``ValueError`` for an empty interval or a tolerance that is not positive, and
    :class:`EventNotBracketed` if both ends agree.
    """
    if not low < high:
        raise ValueError(f"low: {low} given; it must be below high, which is {high}")
    check_positive(tolerance=tolerance)
    evaluations = 0
    if at_low is None:
        at_low, evaluations = bool(predicate(low)), evaluations + 1
    if at_high is None:
        at_high, evaluations = bool(predicate(high)), evaluations + 1
    if at_low == at_high:
        raise EventNotBracketed(f"the predicate is {at_low} at both {low} and {high}; no event between them is known")
    while high - low > tolerance:
        middle = low + 0.5 * (high - low)
        if not low < middle < high:
            break
        evaluations += 1
        if bool(predicate(middle)) == at_low:
            low = middle
        else:
            high = middle
    return Bracket(low=low, high=high, at_low=at_low, evaluations=evaluations)
