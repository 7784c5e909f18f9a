"""Claim R5a: the force at which the response loses its symmetry (Sec. V.E)."""

from __future__ import annotations

from contextlib import suppress

from granular_response_paper.claims import preparations
from granular_response_paper.claims.claim import Data, NotMeasured, Numbers, Quantity

EVENT = "loss_of_symmetry_path"


def loss_of_symmetry(data: Data) -> Numbers:  # R5a
    brackets = data.get("symmetry_breaking", "brackets")
    columns = (brackets[name].values.tolist() for name in ("low", "high", "ramp_time", "time_step"))
    for low, high, ramp, step in zip(*columns, strict=True):
        if step == brackets["time_step"].values[0]:
            yield f"force grown over {ramp:g} sqrt(R/g)", Quantity.bracket(low, high)
    literal = data.get("symmetry_breaking", "equal_rows")
    yield "rows of 60 disks", Quantity.bracket(literal["low"].item(), literal["high"].item())
    with suppress(NotMeasured):  # without a summary of preparations
        yield "along a load path", data.event(preparations.GROUP, EVENT, 1.0)
    yield from ((way, *found) for way, found in preparations.along(data, EVENT, [1.0]))
