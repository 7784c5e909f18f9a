"""Claims F13 and S3: stress inside slabs with and without friction (Secs. IV and V.C)."""

from __future__ import annotations

import numpy as np

from granular_response.observe.peaks import central_dip
from granular_response_paper.claims.claim import Data, Numbers, at

#: "Near the load": within this distance (mean radii). Pressure is compared where it exceeds this part of its maximum.
NEAR, FAINT = 6.0, 0.1


def two_sided(data: Data) -> Numbers:
    """F13, on the lowest line of the grid, away from the side walls: one-sided contacts, and two-sided springs."""
    study = at(data.get("friction_fields", "stress"), friction=0.0).sortby("z").isel(z=0)
    x = study["x"].values
    inside = np.abs(x) < np.abs(x).max() - 10.0
    yield "", *(central_dip(x, study[name].values, interior=inside) for name in ("stress_zz", "stress_zz_lattice"))


def antisymmetric(data: Data) -> Numbers:  # S3
    study = data.get("friction_fields", "stress")
    study = study.sel(friction=study["friction"] > 0.0)
    x, z = np.meshgrid(study["x"].values, study["z"].values)
    odd = 0.5 * np.abs(study["stress_xz"].values - study["stress_zx"].values)
    pressure = 0.5 * (study["stress_xx"].values + study["stress_zz"].values)
    there = pressure > FAINT * pressure.max(axis=(1, 2), keepdims=True)
    there &= np.hypot(x, z - float(study["load_height"])) < NEAR
    yield "per the largest pressure", study["antisymmetric_near"].values.max()
    yield "local", np.divide(odd, pressure, out=np.zeros_like(odd), where=there).max()
    yield "root mean squares", study["antisymmetric_near_mean"].values.max()
