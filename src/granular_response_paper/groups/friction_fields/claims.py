"""Claims F13, S3 and S4a: stress inside slabs with and without friction (Secs. IV, V.C and V.D)."""

from __future__ import annotations

import numpy as np

from granular_response.observe.peaks import central_dip
from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Data, NotMeasured, Quantity, Test, at
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

#: "Near the load": within this distance (mean radii). Pressure is compared where it exceeds this part of its maximum.
NEAR, FAINT = 6.0, 0.1


@CLAIMS.measures("F13")
def two_sided(data: Data, words: Words) -> list[Test]:
    """On the lowest line of the grid, away from the side walls."""
    study = at(data.get("friction_fields", "stress"), friction=0.0).sortby("z").isel(z=0)
    x = study["x"].values
    inside = np.abs(x) < np.abs(x).max() - 10.0
    one, two = (
        Quantity.exact(central_dip(x, study[name].values, interior=inside))
        for name in ("stress_zz", "stress_zz_lattice")
    )
    return [
        Test("dip with one-sided contacts, per largest stress", one, bounds.at_least(words, "visible"), unit="%"),
        Test("dip with two-sided springs, per largest stress", two, bounds.at_most(words, "visible"), unit="%"),
    ]


@CLAIMS.measures("S3")
def antisymmetric(data: Data, words: Words) -> list[Test]:
    study = data.get("friction_fields", "stress")
    study = study.sel(friction=study["friction"] > 0.0)
    x, z = np.meshgrid(study["x"].values, study["z"].values)
    odd = 0.5 * np.abs(study["stress_xz"].values - study["stress_zx"].values)
    pressure = 0.5 * (study["stress_xx"].values + study["stress_zz"].values)
    there = pressure > FAINT * pressure.max(axis=(1, 2), keepdims=True)
    there &= np.hypot(x, z - float(study["load_height"])) < NEAR
    values = {
        "per the largest pressure": study["antisymmetric_near"].values,
        "local": np.divide(odd, pressure, out=np.zeros_like(odd), where=there).max(axis=(1, 2)),
        "root mean squares": study["antisymmetric_near_mean"].values,
    }
    few = bounds.at_most(words, "few per cent")
    return [
        Test("antisymmetric part per pressure, largest of all frictions", Quantity.exact(max(found)), few, case, "%")
        for case, found in values.items()
    ]


@CLAIMS.measures("S4a")
def fits(data: Data, words: Words) -> list[Test]:
    raise NotMeasured("the measured profiles of the experiments are not stored here")
