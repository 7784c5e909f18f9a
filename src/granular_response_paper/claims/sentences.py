"""Sentences of the paper that no claim judges, with what the stored datasets say of each.

They name no number, and a bound chosen once the values are known would decide nothing; or what they speak of is not
simulated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.state import SLIDING

from .. import TOO_LITTLE
from .asked import listed, material
from .claim import Data, NotMeasured, at

#: The group that holds means of five and contact angles, and no claim.
MEANS = "polydisperse_averages"
#: Smoothing of Fig. 19, and of Fig. 21.
NARROW, WIDE = 3.0, 6.0


@dataclass(frozen=True)
class Sentence:
    """What the paper says, where, and how it is looked at; ``found`` raises NotMeasured where nothing is stored."""

    place: str
    paper: str
    found: Callable[[Data], str]


def sliding_spreads(data: Data) -> str:
    states = data.get("friction_linear_range", "states_mu_0.2")
    first, second = states["contact_disk"].values, states["contact_partner"].values
    depths = {}
    for k, force in enumerate(states["force"].values.tolist()):
        height = states["position"].values[k][:, 1]
        slides = states["contact_status"].values[k] == SLIDING
        if slides.any() and force in (2.0, 5.0, 10.0, 15.0):
            away = height[int(states["loaded_disk"])] - 0.5 * (height[first] + height[second])[slides]
            depths[f"{force:g} mg"] = float(np.quantile(away, 0.9))
    return "Friction 0.2: nine tenths of the sliding contacts lie less deep than " + listed(depths, ".1f") + " radii"


def far_beyond(data: Data) -> str:
    runs = data.get("friction_linear_range", "large_forces").sortby("force")
    beyond = runs.isel(force=runs["force"].values > 100.0)
    if not beyond.sizes["force"]:
        raise NotMeasured("data/friction_linear_range.nc: large_forces ends at 100 mg")
    sizes = dict(zip((f"{f:g} mg" for f in beyond["force"].values), beyond["asymmetry"].values.tolist(), strict=True))
    return "Friction 1: the response stays lopsided; its asymmetry falls: " + listed(sizes, ".2f")


def rough_walls(data: Data) -> str:
    events = data.get("preparation", "events")
    parts = []
    for way in ("at once", "slow 100", "without friction"):
        here = (events["name"].values == "linear_range") & (events["friction"].values == 1.0)
        here &= events["way"].values.astype(str) == way
        ends = dict(zip(events["wall_friction"].values[here].tolist(), events["low"].values[here], strict=True))
        if set(ends) >= {0.0, 1.0}:
            parts.append(f"{ends[0.0]:.3g} and {ends[1.0]:.3g} mg (gravity {way})")
    if not parts:
        raise NotMeasured("data/preparation.nc: events holds no linear range beside rough walls")
    return "Friction 1, end of the linear range (1 %) beside smooth and beside rough walls: " + ", ".join(parts)


def _usual(study: xr.Dataset) -> NDArray[np.bool_]:
    """(case,) where the start is that of the first case."""
    starts = study["lattice_constant"].values.astype(str)
    return np.asarray(starts == starts[0])


def missing_contacts(data: Data) -> str:
    shapes = at(data.get("phase_diagram", "shapes"), width=NARROW)
    dips = {}
    for case in np.flatnonzero(_usual(shapes) & (shapes["friction"].values == 0.0)):
        one = shapes.isel(case=case, step=0)
        name = f"polydispersity {float(one['polydispersity']):g}, {float(one['applied_force']):g} mg"
        dips[name] = float(one["shape"])
    return "No friction, dip of the mean response under the smallest force: " + listed(dips, ".0%")


def stopping_energy(data: Data) -> str:
    largest = data.get("numerics", "stop_energy")["response_error"].max("friction")
    errors = {f"{float(one['stop_kinetic_energy']):g}": float(one) for one in largest}
    return "Largest error of the response by the energy at which a run stops: " + listed(errors, ".2%")


def contact_angles(data: Data) -> str:
    study = data.get(MEANS, "packings")
    angle = study["angle"].values
    near = np.zeros(angle.size, bool)
    for direction in np.radians([0.0, 60.0, 120.0, 180.0]):
        near |= np.abs(angle - direction) < np.radians(12.0)
    parts: dict[str, float] = {}
    for case in np.flatnonzero((study["friction"].values == 0.0) & (study["polydispersity"].values > 0.0)):
        density = np.nanmean(study["contact_angle_density"].transpose("case", ..., "angle").values[case], axis=0)
        name = f"polydispersity {float(study['polydispersity'][case]):g}"
        parts.setdefault(name, float(density[near].sum() / density.sum()))
    return (
        "Contacts within 10 degrees of a lattice direction: "
        + listed(parts, ".0%")
        + f"; {near.mean():.0%} if all directions were alike"
    )


def rearrangements(data: Data) -> str:
    rows = data.get("phase_diagram", "realizations")
    found = []
    for case in np.flatnonzero(_usual(rows) & (rows["polydispersity"].values > 0.0)):
        one = rows.isel(case=case)
        force = one["collapse_force"].values
        if np.isfinite(force).any():
            gone = f"{np.isfinite(force).sum()} of {int(one['realizations'])}"
            found.append(f"{gone} ({material(one)}, from {np.nanmin(force):g} mg on)")
    return "Packings that collapse: " + (", ".join(found) or "none")


def nearly_symmetrical(data: Data) -> str:
    few = at(data.get(MEANS, "averages"), width=WIDE)
    mean = few["mean_of_few"].transpose("case", "step", "x").values[(few["polydispersity"].values > 0.0)]
    with np.errstate(invalid="ignore"):
        lean = (np.abs(mean - mean[..., ::-1]).max(axis=-1) / mean.max(axis=-1)).ravel()
    lean = lean[np.isfinite(lean)]
    least, middle, most = np.quantile(lean, [0.0, 0.5, 1.0])
    return (
        f"Largest difference of a point and its mirror image in {lean.size} means of five, per largest response: "
        f"{least:.0%} to {most:.0%}, median {middle:.0%}"
    )


def not_simulated(what: str) -> Callable[[Data], str]:
    return lambda data: f"Not simulated: {what}"


SENTENCES: Sequence[Sentence] = (
    Sentence(
        "II.A",
        "the response of a lattice of springs is narrower than the isotropic one for K2/K1 < 1, wider for K2/K1 > 1, "
        "and double-peaked for large ratios",
        not_simulated("lattices of two kinds of springs. K2 and K6 judge the criterion of two peaks"),
    ),
    Sentence("III.C", "1e-13 is needed for an accuracy of 1 % (N1 judges that it is enough)", stopping_energy),
    Sentence(
        "IV.C",
        "missing horizontal contacts give a hyperbolic-like response to an infinitesimal force",
        missing_contacts,
    ),
    Sentence("V.A", "rough walls support some of the force, which makes the response nonlinear", rough_walls),
    Sentence(
        "V.D",
        "force chains along directions that are not those of the lattice, under oblique forces",
        not_simulated("the experiments with oblique forces; T1 has one at 30 degrees"),
    ),
    Sentence("V.E", "sliding contacts spread gradually downward with the force", sliding_spreads),
    Sentence("V.E", "beyond the loss of symmetry the shape remains similar for much larger forces", far_beyond),
    Sentence("VI.A", "five realizations give, in some cases, nearly symmetrical graphs", nearly_symmetrical),
    Sentence("VI.A", "very large forces may cause major rearrangements of disordered packings", rearrangements),
    Sentence("VI.A", "contact angles prefer directions close to those of the lattice", contact_angles),
)


def looked_at(data: Data) -> list[dict[str, str]]:
    """Every sentence as it is stored; what is missing is said in its place."""
    found = []
    for sentence in SENTENCES:
        try:
            text = sentence.found(data)
        except (NotMeasured, *TOO_LITTLE) as missing:
            text = str(missing)
        found.append({"place": sentence.place, "paper": sentence.paper, "found": text})
    return found
