"""Claim N9: what another contact law changes in the response under one force (Sec. III.B)."""

from __future__ import annotations

from granular_response_paper.claims.bounds import at_most
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, at
from granular_response_paper.claims.numbers import Quantity

GROUP = "sensitivity"
claim = Claims(GROUP, {"force": 15.0, "friction": [0.2, 1.0]})


def _difference(data: Data, friction: float, variant: str) -> Quantity:
    """The largest difference of the floor response away from the side walls, per largest response."""
    study = data.get(GROUP, f"mu_{friction:g}")
    other, own = (at(study, variant=name)["floor_response"].values[1:-1] for name in (variant, "reference"))
    return Quantity.exact(float(abs(other - own).max() / own.max()))


@claim(
    "N9", "III.B", Ask("largest difference per largest response", at_most("quite well"), "%"),
    primary="friction 0.2", figures=[]
)  # fmt: skip
def linear_forces(data: Data) -> Numbers:
    """For the typical deformations obtained in the experiments, a linear fit to the particle force law provides quite a
    good description [65], which further justifies our choice of modeling the normal force as that exerted by a linear
    spring with the above mentioned effective spring constant.
    Short: Linear normal forces describe the 3/2 law quite well
    Here: With the power 3/2 in place of linear normal forces the response differs by {0} of its peak at friction 0.2
    and by {friction 1|0} at friction 1.
    Remark: The sentence is about measured contacts; here it is asked of the response under 15 mg. The laws have the
    same stiffness at the mean contact force at rest"""
    for mu in (0.2, 1.0):
        yield f"friction {mu:g}", _difference(data, mu, "hertz")

