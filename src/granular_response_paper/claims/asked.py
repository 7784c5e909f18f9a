"""What claims ask for again and again: a number against the bound of a word, and findings of one kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .bootstrap import OUTSIDE, part_of
from .claim import Condition, Finding, NotMeasured, Quantity, Reading
from .words import Bounds


def near(what: str, found: float | Quantity, words: Bounds, word: str, of: float = 1.0, unit: str = "") -> Condition:
    """The number is off ``of`` by the word's part of it at most."""
    return Condition(what, _known(found), (1.0 - words[word]) * of, (1.0 + words[word]) * of, (word,), unit)


def sampled(what: str, event: Quantity, paper: float, words: Bounds) -> Condition:
    """The paper's number is the first of its sampled forces at or above the event (mean disk weights)."""
    return Condition(what, event, (1.0 - words["about"]) * paper, paper, ("about",), "mg")


def rises(what: str, values: Sequence[Quantity]) -> Condition:
    """Each of positive ``values`` is larger than the one before: their smallest ratio is above 1."""
    steps = [after.per(before) for before, after in pairwise(values)]
    if not steps:
        raise NotMeasured(f"{what}: fewer than two values to compare")
    smallest = Quantity(
        min(s.value for s in steps), min(s.low for s in steps), min(s.high for s in steps), steps[0].kind
    )
    return Condition(f"{what}, smallest ratio of neighbours", smallest, least=1.0, strict=True)


def at_most(what: str, found: float | Quantity, words: Bounds, word: str, unit: str = "") -> Condition:
    return Condition(what, _known(found), most=words[word], words=(word,), unit=unit)


def at_least(what: str, found: float | Quantity, words: Bounds, word: str, unit: str = "") -> Condition:
    return Condition(what, _known(found), words[word], words=(word,), unit=unit)


def lower(what: str, ratio: float | Quantity, words: Bounds, word: str) -> Condition:
    """The ratio is below 1 by the word's bound or more."""
    return Condition(what, _known(ratio), most=1.0 - words[word], words=(word,))


def higher(what: str, ratio: float | Quantity, words: Bounds, word: str) -> Condition:
    """The ratio is above 1 by the word's bound or more."""
    return Condition(what, _known(ratio), 1.0 + words[word], words=(word,))


def hardly_lower(what: str, ratio: float | Quantity, words: Bounds, word: str, unit: str = "") -> Condition:
    """The ratio is below 1 by the word's bound at most."""
    return Condition(what, _known(ratio), 1.0 - words[word], words=(word,), unit=unit)


def none_of(what: str, number: float) -> Condition:
    """There is none."""
    return Condition(what, Quantity.exact(number), most=0.0)


def one_of(what: str, values: ArrayLike, paper: float, words: Bounds, word: str) -> list[Condition]:
    """The paper's number of one sample, within the word's bound, is none that single realizations rarely have.

    Values (r,) below it and above it are each at least a fortieth of all: the central 95 %.
    """
    found, least = np.asarray(values, dtype=float), 0.5 * OUTSIDE
    low, high = ((1.0 + sign * words[word]) * paper for sign in (-1.0, 1.0))
    return [
        Condition(f"realizations with {what} below {high:g}", part_of(found < high), least, words=(word,), unit="%"),
        Condition(f"realizations with {what} above {low:g}", part_of(found > low), least, words=(word,), unit="%"),
    ]


def _known(found: float | Quantity) -> Quantity:
    return found if isinstance(found, Quantity) else Quantity.exact(found)


def one_reading(summary: str, reading: str, *conditions: Condition, remark: str = "") -> Finding:
    """What was measured in one interpretation alone."""
    return Finding(summary, [Reading(reading, *conditions)], remark)


def told(what: str, rows: Sequence[tuple[str, Reading]], remark: str = "", *, between: str = "; ") -> Finding:
    """What was found in each reading, as a text, with the name of the reading in brackets."""
    texts = between.join(f"{text} ({reading.name})" for text, reading in rows)
    return Finding(what + texts, [reading for _, reading in rows], remark)


def each(
    what: str,
    found: Mapping[str, float | Quantity],
    condition: Callable[[Quantity], Condition],
    unit: str = "",
    remark: str = "",
    changed: Callable[[str], str] = lambda name: "",
    form: str = "",
) -> Finding:
    """A number for each reading, by its name, and what is asked of each; ``changed`` says what a reading changes."""
    readings = [Reading(name, condition(_known(number)), change=changed(name)) for name, number in found.items()]
    return Finding(what + listed(found, form, unit), readings, remark)


def listed(found: Mapping[str, float | Quantity], form: str = "", unit: str = "") -> str:
    """Numbers with what they are in brackets: by the ``form`` of ``format``, or as quantities with a ``unit``."""
    texts = {name: format(_known(one).value, form) if form else _known(one).text(unit) for name, one in found.items()}
    return ", ".join(f"{text} ({name})" for name, text in texts.items())


def by_friction(study: xr.Dataset, name: str) -> dict[str, float]:
    """The values of a variable (friction,), by the friction in words."""
    pairs = zip(study["friction"].values.tolist(), study[name].values.tolist(), strict=True)
    return {f"friction {mu:g}": value for mu, value in pairs}


def material(case: xr.Dataset) -> str:
    """A case of a study in words."""
    return f"polydispersity {float(case['polydispersity']):g}, friction {float(case['friction']):g}"


#: Names the reading of two peaks that disorder uses, where smoothing and scatter hide a smaller dip.
VISIBLE = "two peaks from a visible dip on"


def first(curve: xr.Dataset, name: str, happened: ArrayLike) -> Quantity:
    """Between which stored values of the coordinate ``name`` something has ``happened`` first, in their order.

    Raises NotMeasured if it has at the first one.
    """
    values, at = curve[name].values, np.flatnonzero(happened)
    if not values.size or (at.size and at[0] == 0):
        raise NotMeasured(f"no {name} is stored at which it has not happened yet")
    return Quantity.bracket(*sorted(values[at[0] - 1 : at[0] + 1])) if at.size else Quantity.bracket(values[-1], np.nan)


def dips_from(along: xr.Dataset, name: str, words: Bounds) -> Quantity:
    """Between which values of ``name`` the dip at x = 0 becomes visible; see :func:`first`."""
    known = along.isel({name: np.isfinite(along["central_dip"].values)})
    return first(known, name, known["central_dip"].values > words["visible"])


def linear_until(path: xr.Dataset, tolerance: float) -> Quantity:
    """Where the response at x = 0 is more than ``tolerance`` off that to the smallest force; see :func:`first`."""
    known = path.isel(force=np.isfinite(path["response_at_centre"].values))
    response = known["response_at_centre"].values
    return first(known, "force", np.abs(response / response[0] - 1.0) > tolerance)
