"""Claims S1 to S4 and A3: forces and stress inside slabs with and without friction (Secs. V.C and V.D)."""

from __future__ import annotations

import numpy as np

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, Quantity, Reading, at
from ...claims.words import Bounds

GROUP = "friction_fields"
CLAIMS = Claims(GROUP)

#: "Near the load": within this distance (mean radii). Pressure is compared where it exceeds this part of its maximum.
NEAR, FAINT = 6.0, 0.1


@CLAIMS.measures("S1a")
def along_lattice(data: Data, words: Bounds) -> Finding:
    tilt = float(at(data.get(GROUP, "stress"), friction=0.0)["misalignment"])
    return asked.one_reading(
        f"added forces {tilt:.2f} degrees off the contact lines",
        "friction 0",
        asked.at_most("sine of the mean angle to the contact lines", np.sin(np.radians(tilt)), words, "visible"),
    )


@CLAIMS.measures("S1b")
def vertical_chain(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "stress")
    without, full = at(study, friction=0.0), at(study, friction=1.0)
    angle, ratio = float(full["axis_angle"]), float(full["axis_share"]) / float(without["axis_share"])
    return Finding(
        f"forces below the load {angle:.1f} degrees off the vertical, carrying {ratio:.1f} times the share of "
        "friction 0",
        [
            Reading(
                "friction 1",
                # nearer to the vertical than to a lattice line, which is 30 degrees off it
                Condition(
                    "angle of the forces below the load to the vertical, degrees", Quantity.exact(angle), most=15.0
                ),
                asked.higher("their share of the force per that at friction 0", ratio, words, "marked"),
            )
        ],
    )


@CLAIMS.measures("S2")
def stress(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "stress")
    value = {mu: float(at(study, friction=mu)["distance_to_lattice"]) for mu in (0.0, 1.0)}
    return asked.one_reading(
        f"rms difference from the isotropic harmonic lattice: {value[1.0]:.1%} at friction 1, {value[0.0]:.0%} at 0",
        "farther than 6 radii from the load",
        asked.at_most("rms difference at friction 1", value[1.0], words, "similar", "%"),
        asked.lower("that difference per the one at friction 0", value[1.0] / value[0.0], words, "marked"),
    )


@CLAIMS.measures("A3")
def closer_with_friction(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "stress").sortby("friction")
    distance = study["distance_to_lattice"].values
    worst = float((distance[1:] / distance[:-1]).max())
    return asked.one_reading(
        "rms difference of sigma_zz from the isotropic harmonic lattice: "
        + asked.listed(asked.by_friction(study, "distance_to_lattice"), ".1%"),
        "farther than 6 radii from the load",
        asked.lower("largest ratio of neighbouring frictions", worst, words, "visible"),
    )


@CLAIMS.measures("S3")
def antisymmetric(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "stress")
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
    return Finding(
        f"antisymmetric part over pressure at friction {', '.join(f'{mu:g}' for mu in study['friction'].values)}: "
        + "; ".join(f"{name} {', '.join(f'{v:.1%}' for v in found)}" for name, found in values.items()),
        [
            Reading(name, asked.at_most("antisymmetric part over pressure", max(found), words, "few per cent", "%"))
            for name, found in values.items()
        ],
    )


@CLAIMS.measures("S4")
def profiles(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "profiles")
    off = float(at(study, friction=0.0)["axis_magnitude"].max())
    on = float(at(study, friction=1.0)["axis_magnitude"].min())
    without = asked.lower("below the load per largest, friction 0", off, words, "marked")
    what = "below the load per largest, friction 1"
    return Finding(
        f"below the load at most {off:.2f} of the largest force at its depth at friction 0, at least {on:.2f} at 1",
        [
            Reading("a chain: half of the largest force", without, asked.hardly_lower(what, on, words, "marked")),
            Reading("the chain: the largest force", without, asked.hardly_lower(what, on, words, "visible")),
        ],
    )
