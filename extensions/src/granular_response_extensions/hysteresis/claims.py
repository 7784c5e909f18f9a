"""Claims B2 and B3, beyond the paper: whether what is nonlinear is irreversible, and what a second loading finds."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bootstrap import over_brackets, over_realizations
from granular_response_paper.claims.claim import Data, Numbers, Quantity, materials


def ranges(data: Data) -> Numbers:  # B2
    for name, one in materials(data.get("hysteresis", "events")):
        events = one.sel(event=["linear_range", "reversible_range"])[["low", "high"]].to_array()
        brackets = events.transpose("realization", "event", "variable").values
        pairs = [tuple(Quantity.bracket(*ends) for ends in both) for both in brackets if np.isfinite(both[0, 0])]
        if any(linear.happens for linear, _ in pairs):
            yield name, over_brackets([reversible.per(linear) for linear, reversible in pairs])


def repeated(data: Data) -> Numbers:
    """B3: the part of the work that is lost again, and the change of the response."""
    for name, case in materials(data.get("hysteresis", "loops")):
        one = case.isel(turn=int(np.flatnonzero(np.isfinite(case["force"].values))[-1]))
        lost = (one["slid_again"] + one["crossed_again"]).values / one["work"].values
        known = (values[np.isfinite(values)] for values in (lost, one["floor_repeated"].values))
        # one packing has no interval, of several the mean has one
        numbers = (over_realizations(values, np.mean) if len(values) > 1 else values[0] for values in known)
        yield f"{name}, {float(one['force']):g} mg", *numbers
