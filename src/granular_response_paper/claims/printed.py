"""The quantities for which the paper prints a number, beside ours: the data of a picture of the whole reproduction."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from .bootstrap import over_brackets
from .claim import Data, Verdict
from .numbers import NotMeasured, Quantity, rounded, text


class Printed(NamedTuple):
    """What the paper prints a number of, and which number of which claim is ours."""

    what: str
    claim: str
    ask: int = 0
    digits: int = 0  #: of ours, if not as many as its interval leaves


QUANTITIES = (
    Printed("first opening, friction 0", "F1"),
    Printed("first opening, friction 0.2", "F1", 1),
    Printed("first opening, friction 1", "F1", 2),
    Printed("two peaks, friction 0 (Fig. 3)", "F4a"),
    Printed("two peaks, friction 0.2", "R3a"),
    Printed("open region at the floor, friction 0.2", "R3b"),
    Printed("third peak, friction 0.2", "R4"),
    Printed("loss of symmetry, friction 1", "R5a"),
    Printed("linear range, friction 0.2 over 0", "R1"),
    Printed("linear range, friction 1 over 0", "R1", 1),
    Printed("k_T/k_N between two peaks and one", "K1a"),
    Printed("the same for a half plane", "K6", digits=4),
    Printed("contacts per disk, δ = 0.01, friction 0", "D7a"),
    Printed("change of the response with k_N", "F8"),
)

#: The linear range of the slab of the tests of superposition (Sec. VI.B), of which no claim asks: median over packings
#: of its end, 5 % off at x = 0.
SUPERPOSED = Printed("linear range, δ = 0.01, friction 0.05", "")


def quantities(entries: Sequence[Verdict], data: Data) -> list[dict[str, Any]]:
    """One entry for each, of those that are measured: the paper's number, ours with its interval and what that is
    of, and the numbers of other cases (``others``): geometry, width, stiffness, other gravity and initial lattices.
    """
    by_id = {entry.claim.id: entry for entry in entries}
    found = []
    for printed in QUANTITIES:
        entry = by_id[printed.claim]
        ask, primary = entry.claim.asks[printed.ask], entry.primary
        tests = [test for test in entry.tests if test.ask == ask]
        for own in (test for test in tests if test in primary):
            rest = [(test.case, test.found) for test in tests if test not in primary]
            others = [{"case": case.name, "prepared": case.prepared, **_point(one)} for case, one in rest]
            found.append(_entry(printed, ask.paper, ask.unit, own.found, others))
    with suppress(NotMeasured):
        study = data.get("superposition", "linear_range")
        ends = zip(study["linear_until"].values.tolist(), study["nonlinear_from"].values.tolist(), strict=True)
        found.append(_entry(SUPERPOSED, 0.4, "mg", over_brackets([Quantity.bracket(*one) for one in ends]), []))
    return found


def _entry(printed: Printed, paper: float | None, unit: str, own: Quantity, others: list[Any]) -> dict[str, Any]:
    ours = {"text": text(own, unit, printed.digits), "interval_of": own.method or own.kind, **_point(own)}
    named = {"what": printed.what, "paper": paper, "unit": unit, "claim": printed.claim}
    return {**named, "ours": ours, "others": others}


def _point(found: Quantity) -> dict[str, Any]:
    """A number with the ends of its interval; null for an open end, and for the value of a lower bound."""
    return {"value": rounded(found.value), "interval": [rounded(found.low), rounded(found.high)]}
