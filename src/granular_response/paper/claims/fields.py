"""Claims K, S, P and T: stiffness ratio, forces and stress inside slabs, piles, torques (Secs. V.B to V.G)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .claim import Claim, Condition, Data, Finding, NotMeasured, at

RATIO = "stiffness_ratio_crossover"
THEORY = "theory"
FRICTION = "friction_linear_range"
FIELDS = "friction_fields"
PILE = "pile_dip"
TORQUE = "torque"


def stiffness_ratio(data: Data) -> Finding:
    end, centre = data.event(RATIO, "two_peaks_end"), data.event(RATIO, "central_maximum_begins")
    response = data.get(RATIO, "response", "response_at_centre", "stiffness_ratio")
    ratio, value = response["stiffness_ratio"].values, response["response_at_centre"].values
    above = (ratio >= 0.4) & (ratio <= 1.0)
    if above.sum() < 3:
        raise NotMeasured(f"data/{RATIO}.nc: response holds too few ratios from 0.4 to 1")
    spread = float(np.ptp(value[above]) / value[above].mean())
    return Finding(
        f"two peaks up to {end.text()}, largest at x = 0 from {centre.text()}; from 0.4 to 1 the response at x = 0 "
        f"varies by {spread:.0%}",
        end.middle,
        [
            Condition("two peaks end, going up", end.happens, end.text(), essential=True),
            Condition("two peaks end within 0.28 to 0.32", end.within(0.28, 0.32), end.text()),
            Condition("the maximum at x = 0 begins within 0.28 to 0.32", centre.within(0.28, 0.32), centre.text()),
            Condition("from 0.4 to 1 the response at x = 0 varies by at most 15 %", spread <= 0.15, f"{spread:.0%}"),
        ],
        (end.low, centre.high),
    )


def root(data: Data) -> Finding:
    study = data.get(THEORY, "peak_criterion", "root", "rotations")
    roots = dict(zip(study["rotations"].values.tolist(), study["root"].values.tolist(), strict=True))
    value = float(roots["suppressed"])
    return Finding(
        f"{value:.6f} (with disks free to turn {roots['free']:.4f})",
        value,
        [Condition("0.2915 to its four digits", abs(value - 0.2915) <= 5e-5, f"{value:.6f}")],
    )


def moduli(data: Data) -> Finding:
    study = data.get(THEORY, "moduli", "error", "rotations", "measured", "formula")
    error = study.sel(rotations="suppressed")["error"].values
    worst = float(error.max())
    return Finding(
        f"largest difference {worst:.1e} of the largest modulus, {error.size} lattices",
        worst,
        [Condition("at most 1e-10 of the largest modulus", worst <= 1e-10, f"{worst:.1e}")],
    )


def friction_crossover(data: Data) -> Finding:
    bracket = data.event(FRICTION, "friction_crossover")
    axis = data.get(FRICTION, "friction_axis", "double_peaked", "friction").sortby("friction")
    double = axis["double_peaked"].values.astype(bool)
    changes = int(np.count_nonzero(double[1:] != double[:-1]))
    return Finding(
        f"two peaks up to friction {bracket.text()}, one above",
        bracket.middle,
        [
            Condition(
                "two peaks at the smallest friction, one at the largest",
                bool(double[0] and not double[-1]) and bracket.happens,
                bracket.text(),
                essential=True,
            ),
            Condition("one change along the axis of friction", changes == 1, f"{changes} changes"),
        ],
        (bracket.low, bracket.high),
    )


def chains(data: Data) -> Finding:
    names = ("misalignment", "axis_angle", "axis_share", "friction")
    study = data.get(FIELDS, "stress", *names)
    without, full = at(study, friction=0.0), at(study, friction=1.0)
    tilt, angle = float(without["misalignment"]), float(full["axis_angle"])
    shares = float(without["axis_share"]), float(full["axis_share"])
    ratio = shares[1] / shares[0]
    return Finding(
        f"friction 0: forces {tilt:.2f} degrees off the contact lines; friction 1: forces below the load "
        f"{angle:.1f} degrees off the vertical, carrying {ratio:.1f} times the share of friction 0",
        angle,
        [
            Condition("friction 0: within 1 degree of the lattice directions", tilt <= 1.0, f"{tilt:.2f} degrees"),
            Condition(
                "friction 1: forces below the load within 10 degrees of the vertical", angle <= 10.0, f"{angle:.1f}"
            ),
            Condition("friction 1: these carry at least 3 times the share at friction 0", ratio >= 3.0, f"{ratio:.1f}"),
        ],
    )


def stress(data: Data) -> Finding:
    study = data.get(FIELDS, "stress", "distance_to_lattice", "friction")
    without = float(at(study, friction=0.0)["distance_to_lattice"])
    full = float(at(study, friction=1.0)["distance_to_lattice"])
    return Finding(
        f"rms difference from the isotropic harmonic lattice: {full:.1%} at friction 1, {without:.0%} at 0",
        full,
        [
            Condition("at most 10 % at friction 1", full <= 0.1, f"{full:.1%}"),
            Condition("at most a quarter of that at friction 0", full <= 0.25 * without, f"{full / without:.2f}"),
        ],
    )


def antisymmetric(data: Data) -> Finding:
    study = data.get(FIELDS, "stress", "antisymmetric_near", "friction")
    value = {mu: float(at(study, friction=mu)["antisymmetric_near"]) for mu in (0.2, 1.0)}
    return Finding(
        f"largest antisymmetric part near the load: {value[0.2]:.1%} of the largest pressure at friction 0.2, "
        f"{value[1.0]:.1%} at 1",
        value[1.0],
        [
            Condition("at most 5 % of the pressure", max(value.values()) <= 0.05, f"{max(value.values()):.1%}"),
            Condition("at friction 1 at least 1 %", value[1.0] >= 0.01, f"{value[1.0]:.1%}"),
        ],
        (min(value.values()), max(value.values())),
    )


def profiles(data: Data) -> Finding:
    study = data.get(FIELDS, "profiles", "axis_magnitude", "strongest_x", "friction", "row")
    without, full = at(study, friction=0.0), at(study, friction=1.0)
    off, on = float(without["axis_magnitude"].max()), float(full["axis_magnitude"].min())
    reach = without["strongest_x"].values
    return Finding(
        f"below the load at most {off:.2f} of the largest force at its depth at friction 0, at least {on:.2f} at 1",
        on / off,
        [
            Condition("friction 0: below the load at most half of the largest, every depth", off <= 0.5, f"{off:.2f}"),
            Condition("friction 1: below the load at least 3/4 of the largest, every depth", on >= 0.75, f"{on:.2f}"),
            Condition(
                "friction 0: the strongest contacts are farther out at the deepest than at the shallowest row",
                bool(reach[-1] > reach[0]),
                f"{reach[0]:.1f} to {reach[-1]:.1f} R",
            ),
        ],
    )


#: A dip, in parts of the largest stress, that a figure shows.
VISIBLE = 0.01


def _dip(data: Data, case: str) -> float:
    study = data.get(PILE, "stress", "dip", "case")
    return float(study["dip"].sel(case=case))


def dip_without_friction(data: Data) -> Finding:
    dip = _dip(data, "frictionless")
    return Finding(
        f"{dip:.2%} of the largest vertical stress",
        dip,
        [Condition(f"a dip of at least {VISIBLE:.0%} of the largest stress", dip >= VISIBLE, f"{dip:.2%}")],
    )


def no_dip_with_friction(data: Data) -> Finding:
    dip = _dip(data, "frictional")
    return Finding(
        f"{dip:.2%} of the largest vertical stress",
        dip,
        [Condition(f"no dip, or one below {VISIBLE:.0%} of the largest stress", dip < VISIBLE, f"{dip:.2%}")],
    )


def pile_regions(data: Data) -> Finding:
    names = {"central_open_contacts": "contacts", "central_height": "height", "central_width": "width"}
    study = data.get(PILE, "piles", *names, "case")
    conditions, ratios = [], {}
    for name, text in names.items():
        values = [float(study[name].sel(case=case)) for case in ("frictionless", "frictional")]
        ratios[text] = values[1] / values[0]
        conditions.append(
            Condition(
                f"{text} within 25 % of each other",
                min(values) >= 0.75 * max(values),
                f"{text} {values[1]:.4g} with friction, {values[0]:.4g} without",
            )
        )
    return Finding(
        "with friction over without: " + ", ".join(f"{text} {ratio:.2f}" for text, ratio in ratios.items()),
        ratios["contacts"],
        conditions,
        remark="The paper calls the sizes quite similar and the shapes different",
    )


def torque(data: Data) -> Finding:
    names = ("force_change", "stress_change", "antisymmetric_change", "ring_outer", "ring_inner", "torque")
    rings = data.get(TORQUE, "reach", *names).sortby("torque").isel(torque=-1)
    near, far = rings["ring_outer"].values <= 6.0, rings["ring_inner"].values >= 9.0

    def mean(name: str, where: NDArray[np.bool_]) -> float:
        return float(rings[name].values[where].mean())

    forces = mean("force_change", near)
    field = mean("stress_change", far) / mean("stress_change", near)
    turning = mean("antisymmetric_change", far) / mean("antisymmetric_change", near)
    return Finding(
        f"torque {float(rings['torque']):g}: contact forces within 6 radii change by {forces:.0%}; beyond 9 radii the "
        f"stress changes {field:.2f} and its antisymmetric part {turning:.3f} times as much as within 6",
        forces,
        [
            Condition("contact forces within 6 radii change by at least 20 %", forces >= 0.2, f"{forces:.0%}", True),
            Condition(
                "stress changes beyond 9 radii at most a third as much as within 6",
                field <= 1.0 / 3.0,
                f"stress changes {field:.2f} times as much",
            ),
            Condition("its antisymmetric part at most a tenth as much", turning <= 0.1, f"{turning:.3f}"),
        ],
        remark="Changes are counted per stress of the force alone in the same ring, which falls with the distance",
    )


CLAIMS = (
    Claim(
        "K1",
        "V.B, Fig. 10",
        "friction 10, F = 15 mg: ratios k_T/k_N at which two peaks end and at which the maximum at x = 0 begins",
        "crossover at about 0.3, nearly independent above",
        stiffness_ratio,
        (10,),
        RATIO,
    ),
    Claim("K2", "V.C", "root of r(beta) without horizontal springs", "0.2915", root, (10, 11), THEORY),
    Claim(
        "K3",
        "V.C, eqs. (7)-(10)",
        "lattice moduli a, b, c, d against the moduli of a periodic lattice, strained and relaxed",
        "exact",
        moduli,
        (11,),
        THEORY,
    ),
    Claim(
        "K4",
        "V.D, Fig. 12",
        "F = 15 mg, k_T/k_N = 0.8: friction at which two peaks turn into one, by bisection",
        "exists",
        friction_crossover,
        (12,),
        FRICTION,
    ),
    Claim(
        "S1",
        "V.D, Fig. 13",
        "F = 15 mg: mean angle of the added forces to the contact lines (friction 0); their angle to the vertical and "
        "their share below the load (friction 1)",
        "friction 0: along lattice directions; friction 1: a vertical chain",
        chains,
        (13,),
        FIELDS,
    ),
    Claim(
        "S2",
        "V.D, Fig. 14",
        "F = 15 mg: sigma_zz against that of a harmonic lattice, farther than 6 radii from the load",
        "friction 1: close to the isotropic one",
        stress,
        (14,),
        FIELDS,
    ),
    Claim(
        "S3",
        "V.C",
        "antisymmetric part of the stress over the pressure, within 6 radii of the load",
        "a few per cent",
        antisymmetric,
        (14,),
        FIELDS,
    ),
    Claim(
        "S4",
        "V.D, Fig. 15",
        "F = 150 mg: added contact forces below the load over the largest at the same depth",
        "maxima along two lattice lines at friction 0, one below the load at friction 1",
        profiles,
        (15,),
        FIELDS,
    ),
    Claim(
        "P1",
        "V.F, Fig. 17",
        "pile of 11 layers without friction: sigma_zz on the axis below the lower maximum beside it, 4 radii above the "
        "floor",
        "a dip",
        dip_without_friction,
        (17,),
        PILE,
    ),
    Claim(
        "P2",
        "V.F, Fig. 17",
        "the same with friction 0.94, walls 0.35, k_T/k_N = 0.5",
        "no dip",
        no_dip_with_friction,
        (17,),
        PILE,
    ),
    Claim(
        "P3",
        "V.F, Fig. 17e, f",
        "number of contacts, height and width of the region of open contacts on the axis, with friction and without",
        "nearly the same size in both",
        pile_regions,
        (17,),
        PILE,
    ),
    Claim(
        "T1",
        "V.G, Fig. 18",
        "25 x 13 disks, delta = 0.001, F = 10 mg at 30 degrees: what the largest torque changes in the contact forces "
        "and in the stress, in rings around the load",
        "force chains change strongly, the stress only near the load",
        torque,
        (18,),
        TORQUE,
    ),
)
