"""Claim R5a: the force at which the response loses its symmetry (Sec. V.E)."""

from __future__ import annotations

from dataclasses import replace

from ...claims.bounds import between
from ...claims.claim import ROBUSTNESS, SLAB, Ask, Claims, Data, Numbers
from ...claims.numbers import Quantity

GROUP, LOST = "symmetry_breaking", "loss_of_symmetry"
claim = Claims(
    GROUP, {**SLAB, "scene.contact.friction": 1.0, "scene.contact.stiffness_ratio": 0.8, "scene.wall.friction": 0.0}
)


@claim("R5a", "V.E, Fig. 16b", Ask("force at which the response loses its symmetry", between(91.0, 95.0), "mg", 91.0),
       primary="over the protocol", finds="any")  # fmt: skip
def loss_of_symmetry(data: Data) -> Numbers:
    """However, when the force exceeds F_ext = 91mg, we obtain a sharp transition to a very different response shape
    [see Fig. 16(b)], which is very asymmetric (unlike the symmetric double peaked response obtained for lower friction
    at large forces).
    Short: At friction 1 symmetry is lost beyond 91 mg
    Here: Symmetry is lost at {load ramp of 20 sqrt(R/g)|0} with a load ramp of 20 √(R/g), at {load ramp of 100
    sqrt(R/g)|0} with one of 100 √(R/g), at {ten displaced copies|0} in copies with disks displaced by 1e-9 R, and at
    {rows of 60 disks|0} in rows of 60 disks. Over the ramps, dashpots, steps and copies it is lost at {0}.
    Remark: The text does not say how long the force grows. The next force that it names is 95 mg, at which symmetry is
    lost. The number 91 speaks for rows of 61 and 60 disks, all on their sites"""

    def from_rest(**labels: str) -> list[Quantity]:
        return data.brackets(ROBUSTNESS, "events_from_rest", name=LOST, **labels)

    own = data.bracket(GROUP, "brackets", name=LOST, ramp_time=20.0)
    yield "over the protocol", Quantity.over([own, *from_rest(kind="protocol")], "protocol", "range over the protocol")
    copies = [from_rest(variant=name)[0] for name in data.variants("protocol") if name.startswith("displaced")]
    yield "ten displaced copies", replace(Quantity.over(copies, "protocol", "range over the copies"), value=None)
    yield "load ramp of 20 sqrt(R/g)", own
    yield "load ramp of 100 sqrt(R/g)", data.bracket(GROUP, "brackets", name=LOST, ramp_time=100.0)
    yield "rows of 60 disks", data.bracket(GROUP, "equal_rows", name=LOST)
    yield "121 disks a row", from_rest(variant="121 disks a row")[0]
    for case, number in data.elsewhere(lambda one: one.event("loss_of_symmetry_path", 1.0)):
        if case.prepared:
            yield case, number
