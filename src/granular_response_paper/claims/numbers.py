"""Measured numbers with what is not known of them, and the one way in which they are written for readers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

from granular_response.errors import GranularError

#: What an interval means: none (one deterministic run); the event lies inside; 95 % confidence over packings; smallest
#: to largest value over what the text leaves open in the protocol; smallest to largest of several measures or places.
Kind = Literal["none", "bracket", "confidence", "protocol", "range"]


class NotMeasured(GranularError):
    """What a claim needs is not stored, or is not a number. The message names it."""


def needs(there: object, what: str) -> None:
    """Raises NotMeasured, which says ``what`` is missing, unless ``there`` is true."""
    if not there:
        raise NotMeasured(what)


@dataclass(frozen=True)
class Quantity:
    """A number and the interval in which it lies; ``high`` is inf for a lower bound, which has no ``value``.

    ``method`` names the statistic behind the interval, ``samples`` the number of packings. Raises NotMeasured for a
    number or an end that is nan, so that what is absent can become no quantity.
    """

    value: float | None
    low: float
    high: float
    kind: Kind = "none"
    method: str = field(default="", compare=False)
    samples: int = field(default=1, compare=False)

    def __post_init__(self) -> None:
        value = self.low if self.value is None else self.value
        needs(math.isfinite(value) and math.isfinite(self.low) and not math.isnan(self.high), "no number is stored")

    @classmethod
    def exact(cls, value: float) -> Quantity:
        return cls(float(value), float(value), float(value))

    @classmethod
    def bracket(cls, low: float, high: float) -> Quantity:
        """An event above ``low`` and not above ``high``; ``high`` nan or inf means that it does not happen up to
        ``low``. Where nothing is known below ``high``, a ``low`` of 0, it has no value.
        """
        if not math.isfinite(high):
            return cls(None, float(low), math.inf, "bracket")
        return cls(0.5 * float(low + high) if low > 0.0 else None, float(low), float(high), "bracket")

    @classmethod
    def over(cls, found: Iterable[Quantity | float], kind: Kind = "range", method: str = "") -> Quantity:
        """The first of several, in the interval that holds all of them."""
        each = [one if isinstance(one, Quantity) else cls.exact(one) for one in found]
        needs(each, "no value is stored")
        ends = min(one.low for one in each), max(one.high for one in each)
        return cls(each[0].value, *ends, kind, method, max(one.samples for one in each))

    def per(self, other: Quantity) -> Quantity:
        """The ratio, with the interval that both intervals leave; both positive. NotMeasured if ``other`` is 0."""
        needs(other.high != 0.0, "nothing to compare with")
        kind: Kind = other.kind if self.kind == "none" else self.kind
        high = self.high / other.low if other.low > 0.0 else math.inf
        value = self.value / other.value if self.value is not None and other.value else None
        samples = max(self.samples, other.samples)
        return Quantity(value, self.low / other.high, high, kind, self.method or other.method, samples)

    @property
    def happens(self) -> bool:
        return math.isfinite(self.high)


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_WORDS = {0: "no", 1: "one", 2: "two", 3: "three", 4: "four", 5: "five", 6: "six"}


def digits(value: float, number: int) -> str:
    """A number in so many significant digits, as 0.012, 17, 6100 or 3.5 × 10⁻²⁸."""
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(float(f"{value:.{number - 1}e}"))))
    if -4 < size < 5:
        text = f"{round(value, number - 1 - size):.{max(number - 1 - size, 0)}f}"
    else:
        mantissa, exponent = f"{value:.{number - 1}e}".split("e")
        text = f"{mantissa} × 10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
    return text.replace("-", "−", 1) if value < 0.0 else text


def rounded(value: float | None) -> float | None:
    """To six digits, so that the last ones of a machine do not show; None for an open end and no value."""
    return float(f"{value:.6g}") if value is not None and math.isfinite(value) else None


def shown(value: float, unit: str = "", number: int = 2) -> str:
    """A number with its unit. Of the units, ``%`` is a ratio in per cent, ``part`` one of a whole, of which 0 and 1 are
    the words none and all, and ``count`` a whole number, in words up to six and two digits beyond a thousand.
    """
    if unit == "count":
        whole = round(value)
        return _WORDS.get(whole) or (str(whole) if whole < 1000 else f"{round(whole, 2 - len(str(whole))):,}")
    if unit == "part" and value in (0.0, 1.0):
        return "none" if value == 0.0 else "all"
    if unit in ("%", "part"):
        return f"{digits(100.0 * value, number)} %"
    return f"{digits(value, number)}{' ' + unit if unit else ''}"


def text(found: Quantity, unit: str = "", number: int = 0) -> str:
    """A quantity for readers, in ``number`` digits; for 0 in three if its interval is narrower than a twentieth of
    it, else two.

    The ends of an interval stand in brackets behind the value, or alone where there is none. A hundredth of the
    number is no interval that a reader needs.
    """
    middle = found.low if found.value is None else found.value
    width = (found.high - found.low) / abs(middle) if middle else math.inf
    number = number or (3 if found.kind != "none" and width < 0.05 else 2)
    own = shown(middle, unit, number)
    if found.kind == "none" or width < 0.01:
        return own
    ends = [shown(end, unit, number) for end in (found.low, found.high) if math.isfinite(end)]
    if not found.happens:
        return f"above {ends[0]}" if found.value is None or found.value == found.low else f"{own} (above {ends[0]})"
    if ends[0] == ends[1]:
        return ends[0]
    finer = [shown(one, unit, 3) for one in (middle, found.low, found.high)]
    if found.value is not None and found.kind != "bracket" and own in ends and finer[0] not in finer[1:]:
        return text(found, unit, 3)  # a value apart from an end does not read as that end
    first = ends[0].removesuffix(ends[1][ends[1].rindex(" ") :]) if " " in ends[1] and unit != "count" else ends[0]
    interval = f"{first} to {ends[1]}"
    return interval if found.value is None or found.kind == "bracket" else f"{own} ({interval})"
