"""Where something changes: by bisection of a function, or along stored values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..errors import check_positive, require
from ..state import FloatArray
from .brackets import Bracket, EventNotBracketed, First


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

    Examples
    --------
    >>> gr.studies.bisect_event(lambda value: value**2 > 2.0, 1.0, 2.0, 0.25).ends
    (1.25, 1.5)
    """
    require(low < high, f"low: {low} given; it must be below high, which is {high}")
    check_positive(tolerance=tolerance)
    evaluations = 0
    if at_low is None:
        at_low, evaluations = bool(predicate(low)), evaluations + 1
    if at_high is None:
        at_high, evaluations = bool(predicate(high)), evaluations + 1
    if at_low == at_high:
        raise EventNotBracketed(unchanged(at_low, low, high))
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


def unchanged(at_both: bool, low: float, high: float) -> str:
    """What is said where there is nothing to bracket."""
    return f"the predicate is {at_both} at both {low} and {high}; no event between them is known"


def first_change(values: Sequence[float] | FloatArray, happened: Iterable[bool]) -> First:
    """The last of ``values`` before the first True of ``happened`` and its own.

    Examples
    --------
    >>> gr.studies.first_change([1.0, 2.0, 4.0], [False, False, True])
    First(low=2.0, high=4.0)
    """
    k = next((k for k, yes in enumerate(happened) if yes), None)
    if k is None:
        return First(float(values[-1]), np.nan)
    return First(float(values[k - 1]) if k else 0.0, float(values[k]))


def linear_end(force: ArrayLike, response: ArrayLike, tolerance: float) -> First:
    """Forces (k,) between which ``response`` (k,) is first off its first value by more than ``tolerance`` of it.

    The latter is nan if it never is. Responses may be nan from some force on; both are nan if all of them are.

    Examples
    --------
    >>> gr.studies.linear_end([1.0, 2.0, 4.0], [0.1, 0.1, 0.12], 0.01)
    First(low=2.0, high=4.0)
    """
    force, response = np.asarray(force, float), np.asarray(response, float)
    known = np.isfinite(response)
    if not known.any():
        return First(np.nan, np.nan)
    return first_change(force[known], np.abs(response[known] / response[0] - 1.0) > tolerance)
