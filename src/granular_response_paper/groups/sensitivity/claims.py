"""Claims N9 and N10: what another contact law and other dashpots change (Secs. III.A and III.B)."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

from ...claims.bounds import at_most
from ...claims.claim import SLAB, Ask, Claims, Data, Numbers, at
from ...claims.numbers import NotMeasured, needs

GROUP = "sensitivity"
claim = Claims(GROUP, {**SLAB, "force": 15.0, "friction": [0.2, 1.0]})

#: Events that dashpots may move, by what happens.
EVENTS = {
    "crossover": "two peaks",
    "linear_range": "the end of the linear range",
    "reaches_floor": "the open region at the floor",
    "third_peak": "a third peak",
    "first_opening": "the first opening",
}


def _difference(data: Data, friction: float, variant: str) -> float:
    """The largest difference of the floor response away from the side walls, per largest response."""
    study = data.get(GROUP, f"mu_{friction:g}")
    other, own = (at(study, variant=name)["floor_response"].values[1:-1] for name in (variant, "reference"))
    return float(abs(other - own).max() / own.max())


@claim("N9", "III.B", Ask("largest difference per largest response", at_most("quite well"), "%"),
       primary="friction 0.2", figures=[])  # fmt: skip
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


def _dashpots(data: Data, name: str, friction: float) -> float:
    """The largest change of an event's force with dashpots halved or doubled."""
    own = data.event(name, friction)
    changed = [replace(data, variant=f"dashpots {how}").event(name, friction) for how in ("halved", "doubled")]
    needs(own.happens and all(one.happens for one in changed), f"{name} does not happen with other dashpots")
    return max(abs(one.high / own.high - 1.0) for one in changed)


@claim("N10", "III.A", Ask("largest change with other dashpots", at_most("nearly"), "%"),
       primary="most sensitive result at friction 0.2", figures=[6, 7], finds="not supported")  # fmt: skip
def dissipation(data: Data) -> Numbers:
    """Since we focus on the static response and small deformations the results should not be sensitive to the precise
    choice of dissipation mechanism.
    Short: Results should not be sensitive to the dissipation
    Here: At friction 0.2 dashpots of half strength change the response under 15 mg by {response under 15 mg, friction
    0.2|0} of its peak. Dashpots of half or double strength move the force of two peaks by up to {force of two peaks,
    friction 0.2|0} and the end of the linear range by up to {force of the end of the linear range, friction 0.2|0}.
    Remark: The text does not say which results, so that the most sensitive one decides. The strength of the linear
    dashpots stands for the mechanism. Without friction nothing depends on it; with friction it decides which
    equilibrium is reached"""
    for mu in (0.2, 1.0):
        found = {f"response under 15 mg, friction {mu:g}": _difference(data, mu, "damping_halved")}
        for name, event in EVENTS.items():
            with suppress(NotMeasured):  # not every event happens
                found[f"force of {event}, friction {mu:g}"] = _dashpots(data, name, mu)
        if mu == 0.2:
            needs(f"force of two peaks, friction {mu:g}" in found, "two peaks with other dashpots")
            yield "most sensitive result at friction 0.2", max(found.values())
        yield from found.items()
