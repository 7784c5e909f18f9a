"""Claims B19 to B26, beyond the paper: the experiments that it reviews, on packings and observables like theirs."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims import asked
from granular_response_paper.claims.bootstrap import part_of
from granular_response_paper.claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

from . import LATTICE

GROUP = "experiments"
CLAIMS = Claims(GROUP)
NEARLY_EQUAL, TWO_SIZES, DEEP = "nearly equal", "bidisperse", "deep"
#: Applied in the experiments with photoelastic disks; in mean weights, as the smaller ones.
LARGE, MIDDLE, SMALL, HALF = 150.0, 15.0, 3.0, 1.5
#: Powers of depth of an elastic and a diffusive response.
ELASTIC, DIFFUSIVE = 1.0, 0.5
#: The two definitions of the width.
WIDTHS = {"half_maximum": "half maximum", "half_force": "half of the force"}


def _case(data: Data, packing: str, force: float, angle: float = 90.0, name: str = "means") -> xr.Dataset:
    study = data.get(GROUP, name)
    same = (study["packing"] == packing) & (study["force_applied"] == force) & (study["angle_applied"] == angle)
    CLAIMS.needs(same.any(), f"holds no {packing} packing under {force:g} mg at {angle:g} degrees")
    return study.isel(case=int(np.flatnonzero(same)[0]))


def _quantity(one: xr.DataArray, less: float = 0.0) -> Quantity:
    """A mean with its interval, ``less`` than it by a number."""
    value, low, high = (one.values - less).tolist()
    return Quantity(value, low, high, "confidence", "bootstrap of the mean")


@CLAIMS.measures("B19")
def holds(data: Data, words: Bounds) -> Finding:
    found = {}
    for packing in (NEARLY_EQUAL, TWO_SIZES):
        one = _case(data, packing, LARGE, name="packings")
        found[packing] = part_of(one["moved"].dropna("realization") <= one.attrs["largest_move"])
    return asked.each(
        "packings that hold 150 mg: ",
        found,
        lambda part: asked.at_least("part that holds", part, words, "marked", "%"),
        unit="%",
    )


@CLAIMS.measures("B20")
def lattice_chains(data: Data, words: Bounds) -> Finding:
    one = _case(data, NEARLY_EQUAL, LARGE)
    direction, contrast = _quantity(one["chain"]), _quantity(one["contrast"])
    return asked.one_reading(
        f"the largest force beside the vertical is at {direction.text()} degrees; at 60 it is {contrast.text()} of "
        "that at 75",
        "150 mg",
        asked.near("direction in degrees", direction, words, "nearly", LATTICE),
        asked.higher("force at 60 degrees over that at 75", contrast, words, "marked"),
    )


@CLAIMS.measures("B21")
def vertical_chain(data: Data, words: Bounds) -> Finding:
    vertical = _quantity(_case(data, NEARLY_EQUAL, LARGE)["vertical"])
    return asked.one_reading(
        f"straight below the load the force is {vertical.text()} of that at 75 degrees",
        "150 mg",
        asked.higher("force below the load over that at 75 degrees", vertical, words, "visible"),
    )


@CLAIMS.measures("B22")
def fading(data: Data, words: Bounds) -> Finding:
    found = {}
    for force in (MIDDLE, SMALL):
        two, one = (_quantity(_case(data, packing, force)["contrast"], 1.0) for packing in (TWO_SIZES, NEARLY_EQUAL))
        CLAIMS.needs(one.low > 0.0, f"nearly equal disks have no chains under {force:g} mg that could fade")
        found[f"{force:g} mg"] = two.per(one)
    return asked.each(
        "of the excess at 60 degrees, packings of two sizes keep ",
        found,
        lambda ratio: asked.lower("excess over that of nearly equal disks", ratio, words, "marked"),
    )


def _powers(one: xr.Dataset, words: Bounds, of: float) -> list[Condition]:
    return [
        asked.near(
            f"power, {name}", _quantity(one["power"].sel(definition=width).isel(fit=0)), words, "about", of
        )
        for width, name in WIDTHS.items()
    ]  # fmt: skip


@CLAIMS.measures("B23")
def linear_width(data: Data, words: Bounds) -> Finding:
    one = _case(data, DEEP, SMALL)
    powers, dip = _powers(one, words, ELASTIC), _quantity(one["dip"])
    slopes = ", ".join(f"{_quantity(one['slope'].sel(definition=w)).text()} ({name})" for w, name in WIDTHS.items())
    return asked.one_reading(
        f"the width grows as the power {' and '.join(power.found.text() for power in powers)}; half of it per depth, "
        f"by straight lines: {slopes}; dip {dip.text('%')}",
        "packings of two sizes, 3 mg",
        *powers,
        asked.at_most("dip at x = 0 per largest", dip, words, "few per cent", "%"),
    )


@CLAIMS.measures("B24")
def root_width(data: Data, words: Bounds) -> Finding:
    rows = []
    for packing in (TWO_SIZES, NEARLY_EQUAL):
        reading = Reading(packing, *_powers(_case(data, packing, SMALL), words, DIFFUSIVE))
        rows.append((" and ".join(condition.found.text() for condition in reading.conditions), reading))
    return asked.told("the width grows as the power ", rows)


@CLAIMS.measures("B25")
def linear_force(data: Data, words: Bounds) -> Finding:
    whole, half = (_case(data, DEEP, force)["stress"].sel(estimate="mean") for force in (SMALL, HALF))
    inside = whole.where(whole["depth"] >= 4.0).dropna("depth")
    change = Quantity.range((abs(half - inside).max("x") / inside.max("x")).values)
    return asked.one_reading(
        f"per load, 3 mg differs from 1.5 mg by {change.text('%')} of the largest stress",
        "packings of two sizes",
        asked.at_most("difference per largest stress", change, words, "holds", "%"),
    )


@CLAIMS.measures("B26")
def oblique(data: Data, words: Bounds) -> Finding:
    rows = []
    for angle in (45.0, 30.0):
        strongest = _quantity(_case(data, NEARLY_EQUAL, LARGE, angle)["strongest"])
        if np.isnan(strongest.value):  # no packings hold it
            continue
        nearer = Condition("direction in degrees", strongest, 0.5 * angle, 0.5 * (angle + LATTICE), strict=True)
        rows.append((strongest.text(), Reading(f"force at {angle:g} degrees", nearer)))
    CLAIMS.needs(rows, "holds no packing that bears an oblique force")
    return asked.told("the largest force is at ", rows)
