"""Bounds from qualitative terms, and tests that several claims make."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from granular_response.errors import GranularError

from .claim import Bound, NotMeasured, Quantity, Test, needs
from .words import WORDS, Words


def near(words: Words, word: str, of: float = 1.0) -> Bound:
    """Off ``of`` by the term's part of it at most."""
    ends = ((1.0 - words[word]) * of, (1.0 + words[word]) * of)
    return Bound(min(ends), max(ends), word)


def at_most(words: Words, word: str) -> Bound:
    return Bound(most=words[word], word=word)


def at_least(words: Words, word: str) -> Bound:
    return Bound(words[word], word=word)


def lower(words: Words, word: str) -> Bound:
    """A ratio below 1 by the term's threshold or more."""
    return Bound(most=1.0 - words[word], word=word)


def higher(words: Words, word: str) -> Bound:
    """A ratio above 1 by the term's threshold or more."""
    return Bound(1.0 + words[word], word=word)


def hardly_lower(words: Words, word: str) -> Bound:
    """A ratio below 1 by the term's threshold at most."""
    return Bound(1.0 - words[word], word=word)


def sampled(words: Words, force: float) -> Bound:
    """Of an event, if the paper's ``force`` is the first of its sampled ones at or above it."""
    return Bound((1.0 - words["about"]) * force, force, "about")


NONE = Bound(most=0.0)


class DeclaredError(GranularError):
    """A claim that is not declared as it must be. The message is one line."""


def declared(what: Mapping[str, Any], words: Words) -> Bound:
    """The bound of one key in a ``claims.yaml``: ``about: 20``, ``at most: visible``, ``between: [0, 10]``, ...

    Raises DeclaredError for another key.
    """
    ((kind, of),) = what.items()
    by_word = {"at most": at_most, "at least": at_least, "lower by": lower, "higher by": higher}
    by_word["hardly lower by"] = hardly_lower
    if kind in WORDS:
        return near(words, kind, float(of))
    if kind in by_word and isinstance(of, str):
        return by_word[kind](words, of)
    numbers = {
        "sampled": lambda: sampled(words, float(of)),
        "at most": lambda: Bound(most=float(of)),
        "at least": lambda: Bound(float(of)),
        "less than": lambda: Bound(most=float(of), strict=True),
        "more than": lambda: Bound(float(of), strict=True),
        "between": lambda: Bound(float(of[0]), float(of[1])),
    }
    if kind not in numbers:
        raise DeclaredError(f"bound {kind}: must be a qualitative term or one of {', '.join(numbers | by_word)}")
    return numbers[kind]()


def rise(values: Sequence[Quantity]) -> Quantity:
    """The smallest ratio of neighbours among positive ``values``; above 1 if each is larger than the one before."""
    steps = [after.per(before) for before, after in pairwise(values)]
    needs(steps, "fewer than two values to compare")
    value, low, high = (min(getattr(step, name) for step in steps) for name in ("value", "low", "high"))
    return Quantity(value, low, high, steps[0].kind)


def rises(what: str, values: Sequence[Quantity], case: str = "") -> Test:
    return Test(f"{what}, smallest ratio of neighbours", rise(values), Bound(1.0, strict=True), case)


def first(curve: xr.Dataset, name: str, happened: ArrayLike) -> Quantity:
    """Between which stored values of the coordinate ``name`` something has ``happened`` first, in their order.

    Raises NotMeasured if it has at the first one.
    """
    values, at = curve[name].values, np.flatnonzero(happened)
    if not values.size or (at.size and at[0] == 0):
        raise NotMeasured(f"no {name} is stored at which it has not happened yet")
    return Quantity.bracket(*sorted(values[at[0] - 1 : at[0] + 1])) if at.size else Quantity.bracket(values[-1], np.nan)


def linear_until(path: xr.Dataset, tolerance: float) -> Quantity:
    """Where the response at x = 0 is more than ``tolerance`` off that to the smallest force; see :func:`first`."""
    known = path.isel(force=np.isfinite(path["response_at_centre"].values))
    response = known["response_at_centre"].values
    return first(known, "force", np.abs(response / response[0] - 1.0) > tolerance)


def material(case: xr.Dataset) -> str:
    """A case of a study in words."""
    return f"polydispersity {float(case['polydispersity']):g}, friction {float(case['friction']):g}"
