"""Claims B19 to B26, beyond the paper: the experiments that it reviews, on packings alike (Secs. II.B and V.D)."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import xarray as xr

from granular_response_paper.claims.bootstrap import part_of
from granular_response_paper.claims.bounds import about, at_least, at_most, between, higher_by, lower_by, within
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, at
from granular_response_paper.claims.numbers import Quantity, needs

claim = Claims("experiments")

DEFINITIONS = {"half_maximum": "half maximum", "half_force": "half of the force"}


def _case(data: Data, packing: str, force: float, name: str = "means", angle: float = 90.0) -> xr.Dataset:
    return at(data.get("experiments", name), packing=packing, force_applied=force, angle_applied=angle)


def _mean(data: Data, name: str, packing: str, force: float, angle: float = 90.0, **labels: str) -> Quantity:
    """A number of the mean over packings, with 95 % of its bootstrap draws and the number of packings."""
    one = at(_case(data, packing, force, angle=angle), **labels)[name]
    one = one.isel(fit=0) if "fit" in one.dims else one
    value, low, high = one.transpose("estimate").values.tolist()
    packings = int(_case(data, packing, force, "packings", angle)["moved"].notnull().sum())
    return Quantity(value, low, high, "confidence", "bootstrap of the mean", packings)


@claim("B19", "beyond the paper, II.B", Ask("packings that hold the force", at_least("marked"), "part"),
       primary="nearly equal", source="hypothesis")  # fmt: skip
def holds(data: Data) -> Numbers:
    """Poured packings hold 150 times the particle weight on one disk of their top.
    Short: Packings like those of the experiment hold its force
    Here: Of the packings of nearly equal disks {0} hold 150 mg on one disk, which moves by two radii at most; of those
    of two sizes {bidisperse|0}.
    Remark: The paper says that "forces that were about 150 times the particle weight were used" (II.B); that packings
    hold them is our question. It does not say how the packings of two sizes were made; here they are poured"""
    for packing in ("nearly equal", "bidisperse"):
        one = _case(data, packing, 150.0, "packings")
        yield packing, part_of(one["moved"].dropna("realization") <= one.attrs["largest_move"])


@claim("B20", "beyond the paper, II.B",
       Ask("direction of the largest force beside the vertical, degrees", within("nearly", 60.0)),
       Ask("force at 60 degrees per that at 75", higher_by("marked")), primary="direction", figures=[15])  # fmt: skip
def chains(data: Data) -> Numbers:
    """These profiles exhibited strong dependence on the particle shapes: the ordered lattice of monodisperse disks
    exhibited two prominent "force chains" along the lattice directions (60° with respect to the horizontal), a result
    which appears to be consistent with a hyperbolic model of propagating forces (note, however, that a vertical force
    chain can be observed as well, and it is not anticipated by these models).
    Short: Two prominent force chains along the lattice directions
    Here: Beside the vertical the largest force of the mean is at {0} degrees; the force at 60 degrees is {prominence|0}
    times that at 75.
    Remark: Packings of nearly equal disks under 150 mg. That prominent is taken as half more than the force at 75
    degrees is a choice of this project"""
    yield "direction", _mean(data, "chain", "nearly equal", 150.0), None
    yield "prominence", None, _mean(data, "contrast", "nearly equal", 150.0)


@claim("B21", "beyond the paper, II.B",
       Ask("force straight below the load per that at 75 degrees", higher_by("visible")), figures=[15],
       finds="any")  # fmt: skip
def vertical(data: Data) -> Numbers:
    """As B20.
    Short: A vertical force chain can be observed as well
    Here: Directly below the load the force is {0} times that at 75 degrees."""
    yield _mean(data, "vertical", "nearly equal", 150.0)


def _excess(data: Data, packing: str, force: float) -> Quantity:
    found = _mean(data, "contrast", packing, force)
    return replace(found, value=(found.value or math.nan) - 1.0, low=found.low - 1.0, high=found.high - 1.0)


@claim("B22", "beyond the paper, II.B",
       Ask("excess force at 60 degrees per that of nearly equal disks", lower_by("marked")),
       primary="15 mg")  # fmt: skip
def fading(data: Data) -> Numbers:
    """As the disorder is increased, the force chains "fade out", and for the random configuration of pentagonal
    particles in 2D the measured force profile possessed a single peak, the width of which varied linearly in the depth;
    the latter result is compatible with the predictions of elasticity.
    Short: With disorder the force chains fade out
    Here: Packings of two sizes keep {0} of the excess force at 60 degrees.
    Remark: Excess over the force at 75 degrees. Fading is taken as a marked decrease"""
    for force in (15.0, 3.0):
        two, one = (_excess(data, packing, force) for packing in ("bidisperse", "nearly equal"))
        needs(one.low > 0.0, f"nearly equal disks have no chains under {force:g} mg that could fade")
        yield f"{force:g} mg", two.per(one)


@claim("B23", "beyond the paper, II.B", Ask("exponent of the width, half maximum", about(1.0)),
       Ask("exponent of the width, half of the force", about(1.0)),
       Ask("dip at x = 0 per largest", at_most("few per cent"), "%"), finds="any")  # fmt: skip
def widens(data: Data) -> Numbers:
    """As B22.
    Short: A disordered packing has one peak whose width grows linearly
    Here: The width grows with the depth with the exponents {0} and {1}; the dip is {2}.
    Remark: Linear is taken as the exponent 1 within a quarter, nearer to 1 than to 1/2"""
    powers = [_mean(data, "power", "deep", 3.0, definition=name) for name in DEFINITIONS]
    yield *powers, _mean(data, "dip", "deep", 3.0)


@claim("B24", "beyond the paper, II.B", Ask("exponent of the width in slabs of about ten diameters", about(0.5)),
       primary="bidisperse, half maximum", modal=True, finds="not seen")  # fmt: skip
def parabolic(data: Data) -> Numbers:
    """In this case, the response appeared to exhibit a parabolic envelope.
    Short: The response of a small slab has a parabolic envelope
    Here: In packings of two sizes the width grows with the depth with the exponent {0}; 1/2 is parabolic.
    Remark: Within a quarter. Disks stand for the rounded rectangles of the experiment"""
    for packing, (name, text) in product(("bidisperse", "nearly equal"), DEFINITIONS.items()):
        yield f"{packing}, {text}", _mean(data, "power", packing, 3.0, definition=name)


@claim("B25", "beyond the paper, II.B",
       Ask("difference of the mean stress per load under 3 and 1.5 mg per largest stress", at_most("holds"), "%"),
       finds="any")  # fmt: skip
def linear_force(data: Data) -> Numbers:
    """In this case the applied force was rather small (a few particle weights), and the response was verified to be
    linear in the applied force.
    Short: The response to a few particle weights is linear
    Here: The mean stress per load under 3 mg differs from that under 1.5 mg by {0} of the largest stress at its depth.
    Remark: Range over the depths from 4 radii on"""
    whole, half = (_case(data, "deep", force)["stress"].sel(estimate="mean") for force in (3.0, 1.5))
    inside = whole.where(whole["depth"] >= 4.0).dropna("depth")
    packings = int(_case(data, "deep", 3.0, "packings")["moved"].notnull().sum())
    found = Quantity.over((abs(half - inside).max("x") / inside.max("x")).values.tolist())
    yield Quantity(None, found.low, found.high, "range", "range over depths", packings)


@claim("B26", "beyond the paper, V.D", Ask("direction of the largest mean force, degrees", between(22.5, 52.5)),
       Ask("the same under 30 degrees", between(15.0, 45.0)), modal=True, finds="not seen")  # fmt: skip
def oblique(data: Data) -> Numbers:
    """We have also been able to reproduce [86] force chains along non-lattice directions observed in experiments with
    an applied force at oblique angles [22], using similar simulations of frictional particles (with some
    polydispersity; see Sec. VI below).
    Short: Oblique forces make chains off the lattice directions
    Here: Under a force at 45 degrees the largest force of the mean is at {0} degrees, under one at 30 degrees at {1}.
    Remark: The paper shows no picture; in another paper [86] are single packings, of which a mean over packings says
    little. So a direction outside of the bound is no contradiction: nearly equal disks, 150 mg. A chain is along the
    force, not the lattice, if its direction is nearer to the force than to 60 or 0 degrees"""
    yield tuple(_mean(data, "strongest", "nearly equal", 150.0, angle) for angle in (45.0, 30.0))
