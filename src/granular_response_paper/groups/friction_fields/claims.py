"""Claims F13 and S1 to S4: stress and forces inside slabs with and without friction (Secs. IV, V.C and V.D)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from granular_response.observe.peaks import central_dip

from ...claims.bounds import at_least, at_most, higher_by, lower_by, more_than
from ...claims.claim import SLAB, Ask, Claims, Data, Numbers, at
from ...claims.numbers import needs

GROUP = "friction_fields"
claim = Claims(GROUP, {**SLAB, "force": 15.0, "frictions": [0.0, 0.2, 1.0]})

#: "Near the load": within this distance (mean radii). Pressure is compared where it exceeds this part of its maximum.
NEAR, FAINT = 6.0, 0.1


def _stress(data: Data, name: str, friction: float) -> float:
    return data.value(GROUP, f"stress.{name}", friction=friction)


@claim("F13", "IV", Ask("dip with one-sided contacts per largest stress", at_least("visible"), "%"),
       Ask("dip with two-sided springs per largest stress", at_most("visible"), "%"), figures=[14])  # fmt: skip
def two_sided(data: Data) -> Numbers:
    """The stress distribution obtained for unilateral springs [29] is anisotropic, and shows two peaks at the floor.
    Short: With one-sided contacts the stress has two peaks at the floor
    Here: With one-sided contacts the stress above the floor dips by {0} at x = 0. In the isotropic lattice of two-sided
    springs it has one peak."""
    study = at(data.get(GROUP, "stress"), friction=0.0).sortby("z").isel(z=0)
    x = study["x"].values
    inside = np.abs(x) < np.abs(x).max() - 10.0
    yield tuple(central_dip(x, study[name].values, interior=inside) for name in ("stress_zz", "stress_zz_lattice"))


@claim("S1", "V.D, Fig. 13", Ask("mean angle to the contact lines without friction, degrees", at_most(0.57)),
       Ask("the same at friction 1", more_than(0.57)),
       Ask("angle below the load to the vertical, degrees", at_most(15.0)),
       Ask("share of the force per that without friction", higher_by("marked")))  # fmt: skip
def chains(data: Data) -> Numbers:
    """The most prominent effect of friction on the force chains (Fig. 13) is that the forces (and hence the chains) no
    longer need to be aligned with the (here, triangular) lattice direction, as they are in the absence of tangential
    forces. In particular, a vertical force chain is evident for µ = 1.
    Short: With friction forces leave the lattice lines; a vertical chain is evident
    Here: Without friction the incremental forces are along the contact lines to {0} degrees, at friction 1 they are {1}
    degrees off. At friction 1 the forces below the load are {2} degrees off the vertical and carry {3} times the share
    of the load that they carry without friction.
    Remark: 0.57 degrees: a part of a hundred across the line. 15 degrees: nearer to the vertical than to a lattice
    line, 30 degrees off it"""
    off = [_stress(data, "misalignment", mu) for mu in (0.0, 1.0)]
    share = _stress(data, "axis_share", 1.0) / _stress(data, "axis_share", 0.0)
    yield *off, _stress(data, "axis_angle", 1.0), share


@claim("S2", "V.D, Fig. 14", Ask("difference at friction 1", at_most("similar"), "%"),
       Ask("difference at friction 1 per that without", lower_by("marked"), "%"),
       Ask("fall from one friction to the next, smallest ratio", higher_by("visible")))  # fmt: skip
def isotropic(data: Data) -> Numbers:
    """In particular, the reduced anisotropy is apparent in the stress field (the stress field for µ = 1 is quite
    similar to that obtained in the case of an isotropic harmonic lattice [29]).
    Short: The stress at friction 1 is that of an isotropic lattice
    Here: Farther than 6 radii from the load, the stress at friction 1 differs from that of the harmonic lattice by {0}
    in root mean squares, which is {1} of the difference without friction. From each of the frictions 0, 0.2 and 1 to
    the next the difference falls by a factor of {2} at least.
    Remark: So does Sec. VIII: friction renders the response even closer to that predicted by isotropic elasticity"""
    off = [_stress(data, "distance_to_lattice", mu) for mu in (1.0, 0.2, 0.0)]
    yield off[0], off[0] / off[2], min(after / before for before, after in pairwise(off))


@claim("S3", "V.C", Ask("antisymmetric part per pressure, largest of all frictions", at_most("few per cent"), "%"),
       primary="per the largest pressure", figures=[14])  # fmt: skip
def antisymmetric(data: Data) -> Numbers:
    """We verified (in the DEM simulations) that they are very small, even near the point of application of the external
    force, where the magnitude of the antisymmetric part of the stress is only a few percent of the pressure.
    Short: The antisymmetric stress is a few per cent of the pressure
    Here: Within 6 radii of the load the antisymmetric part of the stress is {0} of the largest pressure, {local|0} of
    the local pressure and {root mean squares|0} in root mean squares.
    Remark: The largest local ratio is where the pressure itself is small, a tenth of its maximum or little more"""
    study = data.get(GROUP, "stress")
    study = study.sel(friction=study["friction"] > 0.0)
    x, z = np.meshgrid(study["x"].values, study["z"].values)
    odd = 0.5 * np.abs(study["stress_xz"].values - study["stress_zx"].values)
    pressure = 0.5 * (study["stress_xx"].values + study["stress_zz"].values)
    there = pressure > FAINT * pressure.max(axis=(1, 2), keepdims=True)
    there &= np.hypot(x, z - float(study["load_height"])) < NEAR
    yield "per the largest pressure", study["antisymmetric_near"].values.max()
    yield "local", (odd[there] / pressure[there]).max()
    yield "root mean squares", study["antisymmetric_near_mean"].values.max()


@claim("S4a", "V.D, Fig. 15")
def fits(data: Data) -> Numbers:
    """The inclusion of friction does provide a better fit to the experimental results obtained in [18, 22] for the
    monodisperse ordered packing: the force magnitudes vs. the horizontal coordinate at different depths in DEM
    simulations with frictionless and frictional (µ = 1; for the particles used in the experiments, µ ≃ 0.94 [76]) are
    shown in Fig. 15.
    Short: Friction fits the measured force profiles better"""
    needs(False, "The sentence is about measured profiles, which are not stored here.")
    yield


@claim("S4b", "V.D, Fig. 15",
       Ask("largest force below the load per largest at its depth, friction 0", lower_by("marked"), "%"),
       Ask("smallest force below the load per largest at its depth, friction 1", at_least("marked"), "%"),
       requires={"profiles.force": 150.0})  # fmt: skip
def chain(data: Data) -> Numbers:
    """These are reproduced quite well by our DEM simulations with friction (see Sec. V).
    Short: Simulations with friction have the chain of the experiments
    Here: Directly below the load the incremental force under 150 mg is {1} of the largest at its depth at least at
    friction 1, and {0} at most without friction.
    Remark: The experiments have a vertical chain ("Such a chain is actually observed"). A chain is taken as half of the
    largest force"""
    name = "profiles.axis_magnitude"
    yield data.value(GROUP, name, np.max, friction=0.0), data.value(GROUP, name, np.min, friction=1.0)
