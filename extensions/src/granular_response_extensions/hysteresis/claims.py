"""Claims B2 and B3, beyond the paper: whether what is nonlinear is irreversible, and what a second loading finds."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bootstrap import over_brackets, over_realizations
from granular_response_paper.claims.bounds import about, at_most
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, materials
from granular_response_paper.claims.numbers import Quantity

claim = Claims("hysteresis")


@claim("B2", "beyond the paper, I and VII", Ask("reversible range per linear one", about(1.0)),
       primary="polydispersity 0, friction 0.2", source="hypothesis", finds="not supported")  # fmt: skip
def ranges(data: Data) -> Numbers:
    """What is nonlinear is irreversible, and what is linear is reversible.
    Short: What is nonlinear is irreversible, and the reverse
    Here: In the lattice at friction 0.2 the reversible range is {0} times the linear range.
    Remark: Reversible: a loop leaves no floor force changed by more than 1 % of the largest change under the load.
    Linear: the response at x = 0 changes by less than 1 %. The paper writes "Nonlinear/irreversible effects" (I)"""
    for name, one in materials(data.get("hysteresis", "events")):
        events = one.sel(event=["linear_range", "reversible_range"])[["low", "high"]].to_array()
        brackets = events.transpose("realization", "event", "variable").values
        pairs = [tuple(Quantity.bracket(*ends) for ends in both) for both in brackets if np.isfinite(both[:, 0]).all()]
        if any(linear.happens for linear, _ in pairs):
            yield name, over_brackets([reversible.per(linear) for linear, reversible in pairs])


@claim("B3", "beyond the paper, IV", Ask("part of the work dissipated again", at_most("visible"), "part"),
       Ask("change of the response", at_most("visible"), "part"), primary="polydispersity 0, friction 0",
       modal=True)  # fmt: skip
def repeated(data: Data) -> Numbers:
    """If the particle positions do not change significantly, so that only the contact network is modified in response
    to the applied stress, the behavior can possibly be modeled as "incrementally elastic".
    Short: The behavior can possibly be modeled as incrementally elastic
    Here: Of the work on the lattice without friction the second loading dissipates {0}, and it changes {1} of the
    response.
    Remark: From the largest force to none and back. Elastic is taken as dissipating less than 1 % of the work"""
    for name, case in materials(data.get("hysteresis", "loops")):
        one = case.isel(turn=int(np.flatnonzero(np.isfinite(case["force"].values))[-1]))
        lost = (one["slid_again"] + one["crossed_again"]).values / one["work"].values
        known = (values[np.isfinite(values)] for values in (lost, one["floor_repeated"].values))
        # one packing has no interval, of several the mean has one
        numbers = (over_realizations(values, np.mean) if len(values) > 1 else values[0] for values in known)
        yield name, *numbers
