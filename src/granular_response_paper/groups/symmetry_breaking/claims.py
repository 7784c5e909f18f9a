"""Claim R5a: the force at which the response loses its symmetry (Sec. V.E)."""

from __future__ import annotations

from contextlib import suppress

from granular_response_paper.claims import preparations
from granular_response_paper.claims.claim import Bound, Data, NotMeasured, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP, EVENT = "symmetry_breaking", "loss_of_symmetry_path"
CLAIMS = Claims(__package__)

#: The next force that the paper names is 95 mg, where its response has lost its symmetry.
BOUND = Bound(91.0, 95.0)


@CLAIMS.measures("R5a")
def loss_of_symmetry(data: Data, words: Words) -> list[Test]:
    brackets = data.get(GROUP, "brackets")
    steps = brackets["time_step"].values
    columns = (brackets[name].values.tolist() for name in ("low", "high", "ramp_time", "time_step"))
    found = {
        f"force grown over {ramp:g} sqrt(R/g)": Quantity.bracket(low, high)
        for low, high, ramp, step in zip(*columns, strict=True)
        if step == steps[0]
    }
    literal = data.get(GROUP, "equal_rows")
    found["rows of 60 disks"] = Quantity.bracket(literal["low"].item(), literal["high"].item())
    with suppress(NotMeasured):  # without a summary of preparations
        found["along a load path"] = data.event(preparations.GROUP, EVENT, 1.0)
    tests = [Test("loss of symmetry", event, BOUND, case, "mg") for case, event in found.items()]
    others = preparations.events(data, EVENT, 1.0)
    return tests + [Test("loss of symmetry", event, BOUND, "", "mg", way) for way, event in others.items()]
