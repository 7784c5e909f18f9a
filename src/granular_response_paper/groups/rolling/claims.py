"""Claims B11 to B14, beyond the paper: what rolling resistance changes (Secs. V.F and VIII)."""

from __future__ import annotations

import xarray as xr

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, Quantity
from ...claims.words import Bounds

GROUP = "rolling"
CLAIMS = Claims(GROUP)

#: Of the paper's pile with friction (Fig. 17).
FRICTION = 0.94


def _least(data: Data) -> xr.Dataset:
    found = data.get(GROUP, "thresholds", "low", "high", "floor_dip", "layers", "rolling_friction")
    return found.sortby(["layers", "rolling_friction"])


def _bracket(one: xr.Dataset) -> Quantity:
    return Quantity.bracket(float(one["low"]), float(one["high"]))


@CLAIMS.add(
    "B11",
    "beyond the paper, V.F",
    "least friction of disks and floor that holds an ordered pile on a flat floor without support, without rolling "
    "resistance",
    "stable piles on a flat floor require rolling resistance",
    17,
)
def without_resistance(data: Data, words: Bounds) -> Finding:
    found = _least(data)
    CLAIMS.needs(float(found["rolling_friction"][0]) == 0.0, "thresholds holds nothing without rolling resistance")
    least = {f"{int(n)} layers": _bracket(found.sel(layers=n).isel(rolling_friction=0)) for n in found["layers"]}
    most = {f"{int(n)} layers": _bracket(found.sel(layers=n).isel(rolling_friction=-1)) for n in found["layers"]}
    return asked.each(
        "without rolling resistance: ",
        least,
        lambda one: Condition("least friction that holds the pile", one, FRICTION),
        remark=f"With rolling friction {float(found['rolling_friction'][-1]):g}: {asked.listed(most)}. Asked for more "
        f"than {FRICTION:g}, the friction of the paper's pile. The pile is placed, not built disk by disk",
    )


@CLAIMS.add(
    "B12",
    "beyond the paper, V.F",
    "dip of the floor force under the apex of piles without support that rolling resistance holds, per largest force",
    "no dip with friction (there with side walls)",
    17,
)
def no_dip(data: Data, words: Bounds) -> Finding:
    piles = data.get(GROUP, "piles", "floor_dip", "layers", "case").sortby("layers")
    found = _least(data).isel(rolling_friction=-1)
    dips = {f"{int(n)} layers, friction of Fig. 17": piles.sel(layers=n, case="resisting") for n in piles["layers"]}
    dips |= {f"{int(n)} layers, least friction": found.sel(layers=n) for n in found["layers"]}
    CLAIMS.needs(bool(found["floor_dip"].notnull().all()), "thresholds holds no pile that rolling resistance holds")
    numbers = {name: float(one["floor_dip"]) for name, one in dips.items()}
    return asked.each(
        "with the largest rolling friction: ",
        numbers,
        lambda dip: asked.at_most("dip per largest force", dip, words, "visible", "%"),
        form=".1%",
    )


def _slabs(data: Data, *names: str) -> xr.Dataset:
    found = data.get(GROUP, "slabs", *names, "friction", "rolling_friction").sortby("rolling_friction")
    CLAIMS.needs(found.sizes["rolling_friction"] > 1, "slabs holds one rolling friction, there is nothing to compare")
    return found


@CLAIMS.add(
    "B13",
    "beyond the paper, V.A and VIII",
    "largest change of a slab's response to small loads by rolling resistance, per largest response",
    "the response to small forces is elastic, with friction too",
    (6, 7),
)
def elastic_response(data: Data, words: Bounds) -> Finding:
    response = _slabs(data, "elastic_response")["elastic_response"]
    without = response.isel(rolling_friction=0)
    change = abs(response - without).max("floor_disk") / without.max("floor_disk")
    found = {
        f"friction {float(mu):g}": Quantity.range(change.sel(friction=mu).values[1:].tolist())
        for mu in change["friction"]
    }
    return asked.each(
        "the response to small loads changes by ",
        found,
        lambda one: asked.at_most("change per largest response", one, words, "nearly", "%"),
        unit="%",
        remark="Ranges over the rolling frictions above 0",
    )


@CLAIMS.add(
    "B14",
    "beyond the paper, VIII",
    "couple stress that the load adds per mean radius and vertical stress at the same height, at half height",
    "rolling resistance supports continuum models with couple stresses (micropolar, Cosserat)",
    (),
)
def couple_stress(data: Data, words: Bounds) -> Finding:
    slabs = _slabs(data, "couple_stress", "vertical_stress", "z")
    part = (slabs["couple_stress"] / slabs["vertical_stress"]).sel(z=0.5, method="nearest")
    found = {
        f"friction {float(mu):g}": Quantity.range(part.sel(friction=mu).values[1:].tolist()) for mu in part["friction"]
    }
    return asked.each(
        "couple stress per vertical stress times radius: ",
        found,
        lambda one: asked.at_least("couple stress per vertical stress times radius", one, words, "visible", "%"),
        unit="%",
        remark="Ranges over the rolling frictions above 0; without rolling resistance equal disks hand on no couples",
    )
