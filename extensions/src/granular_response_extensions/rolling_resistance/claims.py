"""Claims B14 to B17, beyond the paper: what rolling resistance changes (Secs. V.F and VIII)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import xarray as xr

from granular_response_paper.claims.bounds import at_least, at_most
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, at
from granular_response_paper.claims.numbers import Quantity, needs

GROUP = "rolling_resistance"
claim = Claims(GROUP)


def _held(data: Data, rolling: int) -> Iterator[tuple[str, xr.Dataset]]:
    """Piles at the least friction with the smallest rolling friction (0) or the largest (-1), and their names."""
    found = data.get(GROUP, "thresholds").sortby("rolling_friction").isel(rolling_friction=rolling)
    for ramp, size in product(found["ramp"].values, found["layers"].values):
        gravity = f"in {ramp:g} sqrt(R/g)" if ramp else "at once"
        yield f"{size} layers, gravity {gravity}", found.sel(layers=size, ramp=ramp)


@claim("B14", "beyond the paper, V.F", Ask("least friction that holds the core", at_least(0.94)),
       Ask("disks that leave the pile", at_least(1.0), "count"), primary="every disk, 11 layers, gravity at once",
       figures=[17])  # fmt: skip
def without_resistance(data: Data) -> Numbers:
    """Therefore, the edges of the pile have to be supported by side walls (the construction of stable piles on an
    uncorrugated floor requires the introduction of rolling friction, or rolling resistance [87]).
    Short: Without rolling resistance a pile needs side walls
    Here: The core of a pile of 11 layers holds from friction {the core, 11 layers, gravity at once|0} on; {0} disks
    at its toe roll away.
    Remark: Asked for more than 0.94, the friction of the paper's pile. The toe disks roll away at constant speed and
    are stopped by hand. The pile is placed, not built disk by disk"""
    for name, one in _held(data, 0):
        needs(float(one["rolling_friction"]) == 0.0, "thresholds holds nothing without rolling resistance")
        yield f"every disk, {name}", None, float(one["loose_disks"])
        yield f"the core, {name}", Quantity.bracket(float(one["low"]), float(one["high"])), None


@claim("B15", "beyond the paper, V.F",
       Ask("dip of the floor force under the apex per largest force", at_most("visible"), "%"),
       primary="friction of Fig. 17, 11 layers", figures=[17])  # fmt: skip
def no_dip(data: Data) -> Numbers:
    """In particular, as shown in Figs. 17(c),(d), the pile of frictionless disks exhibits a dip in the stress under the
    apex, but the pile of frictional disks does not.
    Short: Piles with friction have no dip
    Here: In the pile of 11 layers that rolling resistance holds, with the friction of Fig. 17, the floor force under
    the apex is less than the largest beside it by {0} (below 0: it is largest there)."""
    piles = data.get(GROUP, "piles").sel(case="resisting")
    for size in piles["layers"]:
        yield f"friction of Fig. 17, {int(size)} layers", float(piles["floor_dip"].sel(layers=size))
    for name, one in _held(data, -1):
        yield f"least friction, {name}", float(one["floor_dip"])


@claim("B16", "beyond the paper, VIII", Ask("change per largest response", at_least("nearly"), "%"),
       primary="friction 0.2", modal=True, finds="not seen")  # fmt: skip
def small_load(data: Data) -> Numbers:
    """In particular, the dominant effect of tangential forces in such failure, e.g., in the transition to an asymmetric
    response described in Sec. V E, as well as the effects of applied torques (Sec. V G) and of rolling resistance,
    support the suggestion that, at least on intermediate scales, continuum models of micropolar, or Cosserat type [88,
    89, 90] may be required (see, e.g., [100, 101]).
    Short: Rolling resistance suggests a Cosserat continuum
    Here: At friction 0.2 rolling resistance changes the response to the small load by {0}.
    Remark: The sentence speaks of failure; here the linear response is looked at. Ranges over the rolling frictions
    above the least"""
    slabs = data.get(GROUP, "slabs").sortby("rolling_friction")
    without, *others = slabs["floor_response"].isel(load=0).transpose("rolling_friction", ...)
    for mu in slabs["friction"].values:
        least = without.sel(friction=mu)
        yield (
            f"friction {mu:g}",
            Quantity.over(float(abs(one.sel(friction=mu) - least).max() / least.max()) for one in others),
        )


@claim("B17", "beyond the paper, VIII",
       Ask("unexplained fraction of the squares of the couple stress", at_most("quite well"), "%"),
       Ask("Cosserat length in radii", at_least(1.0)), primary="friction 0.2, 0.5 mg", modal=True,
       finds="not seen")  # fmt: skip
def cosserat(data: Data) -> Numbers:
    """As B16.
    Short: Rolling resistance suggests a Cosserat continuum
    Here: At friction 0.2 under the small load the gradient of the rotations leaves {0} of the squares of the couple
    stress unexplained; the Cosserat length is {1} radii.
    Remark: The sentence speaks of failure; here the linear response is looked at. Less than a radius is no length of a
    continuum. Ranges over the rolling frictions above the least"""
    torque = [("torques", {"torque": value}, f"torque {value:g}") for value in (0.001, 0.15)]
    loads = [("slabs", {"load": value}, f"{value:g} mg") for value in (0.5, 10.0)]
    for mu, (name, label, text) in product((0.2, 1.0), [*loads, *torque]):
        study = data.get(GROUP, name)
        one = at(study.isel(rolling_friction=study["rolling_friction"].values > 0.0), friction=mu, **label)
        for prefix, suffix in (("", ""), ("decay_", ", decay"))[: 1 + (name == "torques")]:
            numbers = (Quantity.over(one[f"{prefix}{what}"].values.tolist()) for what in ("unexplained", "length"))
            yield f"friction {mu:g}, {text}{suffix}", *numbers
