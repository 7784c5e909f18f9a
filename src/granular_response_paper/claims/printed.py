"""The quantities for which the paper prints a number, beside ours: the data of one picture of the whole
reproduction.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from .bootstrap import over_brackets
from .claim import Data, Verdict
from .numbers import NotMeasured, Quantity, rounded, text


class Printed(NamedTuple):
    """What the paper prints a number of, its unit, and which number of which claim is ours."""

    what: str
    paper: float
    unit: str
    claim: str
    ask: int = 0
    digits: int = 0  #: of ours, if not as many as its interval leaves


QUANTITIES = (
    Printed("first opening, friction 0", 0.75, "mg", "F1"),
    Printed("first opening, friction 0.2", 4.0, "mg", "F1", 1),
    Printed("first opening, friction 1", 6.0, "mg", "F1", 2),
    Printed("two peaks, friction 0 (Fig. 3)", 3.0, "mg", "F4a"),
    Printed("two peaks, friction 0.2", 20.0, "mg", "R3a"),
    Printed("open region at the floor, friction 0.2", 20.0, "mg", "R3b"),
    Printed("third peak, friction 0.2", 40.0, "mg", "R4"),
    Printed("loss of symmetry, friction 1", 91.0, "mg", "R5a"),
    Printed("linear range, friction 0.2 over 0", 10.0, "", "R1"),
    Printed("linear range, friction 1 over 0", 10.0, "", "R1", 1),
    Printed("k_T/k_N between two peaks and one", 0.3, "", "K1a"),
    Printed("the same for a half plane", 0.2915, "", "K6", digits=4),
    Printed("contacts per disk, δ = 0.01, friction 0", 4.25, "", "D7a"),
    Printed("change of the response with k_N", 0.02, "%", "F8"),
)

#: The linear range of the slab of the tests of superposition (Sec. VI.B), of which no claim asks: median over packings
#: of its end, 5 % off at x = 0.
SUPERPOSED = Printed("linear range, δ = 0.01, friction 0.05", 0.4, "mg", "")


def quantities(entries: Sequence[Verdict], data: Data) -> list[dict[str, Any]]:
    """One entry for each, of those that are measured: the paper's number, ours with its interval and what that is
    of, and the numbers of other cases (``others``): geometry, width, stiffness, other gravity and initial lattices.
    """
    by_id = {entry.claim.id: entry for entry in entries}
    found = []
    for printed in QUANTITIES:
        entry = by_id[printed.claim]
        own = [test.found for test in entry.primary if test.ask == entry.claim.asks[printed.ask]]
        others = [
            test for test in entry.tests if test.ask == entry.claim.asks[printed.ask] and test not in entry.primary
        ]
        if own:
            pale = [{"case": test.case.name, "prepared": test.case.prepared, **_point(test.found)} for test in others]
            found.append(_entry(printed, own[0], pale))
    with suppress(NotMeasured):
        study = data.get("superposition", "linear_range")
        ends = zip(study["linear_until"].values.tolist(), study["nonlinear_from"].values.tolist(), strict=True)
        found.append(_entry(SUPERPOSED, over_brackets([Quantity.bracket(*one) for one in ends]), []))
    return found


def _entry(printed: Printed, own: Quantity, others: list[dict[str, Any]]) -> dict[str, Any]:
    named = {name: one for name, one in printed._asdict().items() if name not in ("ask", "digits")}
    ours = {"text": text(own, printed.unit, printed.digits), "interval_of": own.method or own.kind, **_point(own)}
    return {**named, "ours": ours, "others": others}


def _point(found: Quantity) -> dict[str, Any]:
    """A number with the ends of its interval; null for an open end, and for the value of a lower bound."""
    return {"value": rounded(found.value), "interval": [rounded(found.low), rounded(found.high)]}
