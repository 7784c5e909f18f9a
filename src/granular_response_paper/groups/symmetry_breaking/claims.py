"""Claim R5a: the force at which the response loses its symmetry (Sec. V.E)."""

from __future__ import annotations

from ...claims import asked, preparations
from ...claims.claim import Claims, Condition, Data, Finding, Quantity
from ...claims.words import Bounds

GROUP = "symmetry_breaking"
CLAIMS = Claims(GROUP)

#: A force that grows without end slowly, gravity at once.
PATH = "quasi-static path"


@CLAIMS.measures("R5a")
def loss_of_symmetry(data: Data, words: Bounds) -> Finding:
    brackets = data.get(GROUP, "brackets")
    columns = (brackets[name].values.tolist() for name in ("low", "high", "ramp_time", "time_step"))
    found = {
        f"ramp of {ramp:g} sqrt(R/g), step {step:g}": Quantity.bracket(low, high)
        for low, high, ramp, step in zip(*columns, strict=True)
    }
    if preparations.GROUP in data.groups:
        found[PATH] = data.event(preparations.GROUP, "loss_of_symmetry_path", 1.0)
    for walls, friction in (("smooth", 0.0), ("rough", 1.0)):
        for way, event in preparations.events(data, "loss_of_symmetry_path", 1.0, friction).items():
            found[f"{way}, {walls} walls, along a load path"] = event
    # the next force that the paper names is 95 mg, where its response has lost its symmetry
    return asked.each(
        "",
        found,
        lambda event: Condition("loss of symmetry", event, 91.0, 95.0, unit="mg"),
        "mg",
        changed=lambda name: (
            "walls" if "rough walls" in name else "" if name.startswith(("ramp", PATH)) else preparations.CHANGE
        ),
    )
