"""Claims of Secs. I and V: ordered slabs with friction under growing forces."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import product

import numpy as np
import xarray as xr

from granular_response.state import OPEN, SLIDING, FloatArray
from granular_response.studies import first_change, linear_end
from granular_response_paper.claims import preparations
from granular_response_paper.claims.claim import Data, Numbers, Quantity, at, needs, rise
from granular_response_paper.claims.words import TOLERANCES

GROUP = "friction_linear_range"

#: Of the paper (Fig. 6, Sec. V.B).
FRICTIONS = (0.0, 0.2, 1.0)


def _curve(data: Data, friction: float, name: str) -> xr.DataArray:
    """What is measured at a friction, along the forces at which it is."""
    return at(data.get(GROUP, "response"), friction=friction)[name].dropna("force")


def _linear(data: Data, friction: float, tolerance: float) -> Quantity:
    """The end of the linear range: located to 1 %, else between two stored forces."""
    if tolerance == TOLERANCES[0]:
        return data.event(GROUP, "linear_range", friction=friction)
    curve = _curve(data, friction, "response_at_centre")
    return Quantity.bracket(*linear_end(curve["force"], curve, tolerance))


def _frictions(data: Data) -> list[float]:
    return np.unique(data.get(GROUP, "response")["friction"].values).tolist()


def linear_range(data: Data) -> Numbers:
    """R1, per that without friction."""

    def ratios(data: Data, tolerance: float = TOLERANCES[0]) -> list[Quantity]:
        without, *ends = (_linear(data, mu, tolerance) for mu in FRICTIONS)
        return [end.per(without) for end in ends]

    for part in TOLERANCES:
        yield f"response {part:.0%} off", *ratios(data, part)
    for way, found in preparations.along(data, ratios):
        yield way, *found


def range_grows(data: Data) -> Numbers:  # A1
    def grows(event: str, frictions: Sequence[float], data: Data) -> Quantity:
        return rise(data.event(GROUP, event, friction=mu) for mu in frictions)

    for name, frictions in (("frictions 0, 0.2 and 1", FRICTIONS), ("all frictions", _frictions(data))):
        for part in TOLERANCES:
            yield f"response {part:.0%} off, {name}", rise(_linear(data, mu, part) for mu in frictions)
        yield f"first opening, {name}", grows("first_opening", frictions, data)
    for event in ("first_opening", "linear_range"):
        yield from preparations.along(data, partial(grows, event, FRICTIONS))


def smaller_anisotropy(data: Data) -> Numbers:
    """A2: growth and fall with friction."""
    axis = data.get(GROUP, "friction_axis").sortby("friction")
    elastic = _curve(data, _frictions(data)[-1], "floor_response").transpose("force", ...).values[0]
    response = axis["floor_response"].transpose("friction", "floor_disk").values
    off = np.sqrt(((response - elastic) ** 2).sum(axis=1) / (elastic**2).sum())
    for case, size in (("dip at x = 0", axis["central_dip"].values), ("difference from the elastic response", off)):
        yield case, np.diff(size).max(), 1.0 - size[-1] / size[0]


def elastic_without_friction(data: Data) -> Numbers:  # F11
    curve = _curve(data, 0.0, "response_at_centre")
    before = curve.values[curve["force"].values <= data.event(GROUP, "first_opening", friction=0.0).low]
    needs(before.size > 1, "response holds too few forces before the first opening")
    yield "", np.ptp(before) / before[0]


def _slides(data: Data, force: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Which contacts of disks slide at friction 0.2 under a force; where those that touch are, from the load; and if
    they are horizontal.
    """
    states = data.get(GROUP, "states_mu_0.2")
    one = at(states.assign_coords(force=states["force"]), force=force)
    position, first, second = (one[name].values for name in ("position", "contact_disk", "contact_partner"))
    touching = one["contact_status"].values != OPEN
    away = 0.5 * (position[first] + position[second]) - position[int(one["loaded_disk"])]
    level = np.abs(position[first, 1] - position[second, 1]) < 0.5 * np.sqrt(3.0)
    return (one["contact_status"].values == SLIDING)[touching], away[touching], level[touching]


def far_from_the_load(data: Data) -> Numbers:  # I1
    for force in (5.0, 15.0):
        slides, away, _ = _slides(data, force)
        far = np.hypot(*away.T) > 20.0
        needs(far.any(), "states_mu_0.2 holds no contact farther than 20 radii from the load")
        yield f"per contact there, {force:g} mg", slides[far].mean()
        yield f"per sliding contact, {force:g} mg", far[slides].sum() / max(slides.sum(), 1)


def sliding_near(data: Data) -> Numbers:  # R12
    for radius, force in product((6.0, 10.0, 15.0), (3.0, 5.0, 10.0, 15.0)):
        slides, away, _ = _slides(data, force)
        needs(slides.any(), f"states_mu_0.2 holds no sliding contact under {force:g} mg")
        yield f"within {radius:g} R at {force:g} mg", (np.hypot(*away[slides].T) < radius).mean()


def spreads_downward(data: Data) -> Numbers:  # R13
    found = (_slides(data, force) for force in (2.0, 5.0, 10.0, 15.0))
    yield "", rise(Quantity.exact(-np.quantile(away[slides, 1], 0.1)) for slides, away, _ in found)


def reorganized(data: Data) -> Numbers:
    """R4c, in the region that has opened contacts: below the load, as far to each side as it is deep there."""
    parts = []
    for force in (20.0, 30.0):
        slides, away, level = _slides(data, force)
        below = np.abs(away[:, 0]) < -away[:, 1] / np.sqrt(3.0)
        needs((slides & below).any(), f"states_mu_0.2 holds no sliding contact below the load at {force:g} mg")
        parts.append(level[slides & below].mean())
    yield "", parts[0], parts[1] / parts[0]


def _jump(data: Data, asymmetric: float) -> tuple[xr.Dataset, xr.Dataset]:
    """Of the dynamic runs at large forces the last one before the asymmetry exceeds this, and those after it."""
    runs = data.get(GROUP, "large_forces").sortby("force")
    lost = np.flatnonzero(runs["asymmetry"].values > asymmetric)
    needs(lost[:1].any(), "large_forces holds no forces on both sides of the loss of symmetry")
    return runs.isel(force=lost[0] - 1), runs.isel(force=slice(lost[0], None))


def sharp(data: Data, asymmetric: float) -> Numbers:  # R5b
    before, after = (runs["asymmetry"].values for runs in _jump(data, asymmetric))
    yield "", after[0] - before


def network_changes(data: Data, asymmetric: float) -> Numbers:  # R6c
    states = data.get(GROUP, "large_force_states")
    states = states.assign_coords(force=states["force"])
    forces = (float(runs["force"].values.flat[0]) for runs in _jump(data, asymmetric))
    before, after = (at(states, force=force)["contact_status"].values != OPEN for force in forces)
    yield "", (before != after).sum() / before.sum()


def by_sliding(data: Data) -> Numbers:  # R6d
    states = data.get(GROUP, "states_mu_1")
    force, status = states["force"].values, states["contact_status"].values
    rest, last = status[0], status[np.flatnonzero(force <= 90.0)[-1]]
    opened = ((rest != OPEN) & (last == OPEN)).sum()
    needs(opened > 0, "states_mu_1 holds no opened contact")
    yield "", (last == SLIDING).sum() / opened


def mirror_images(data: Data, asymmetric: float) -> Numbers:
    """R7. The paper's pair lies between 91 and 95 mg."""
    _, after = _jump(data, asymmetric)
    response, force, sign = (after[name].values for name in ("floor_response", "force", "asymmetry_sign"))
    apart = [
        float(np.abs(response[a] - response[b][::-1]).max() / response[a].max())
        for a, b in product(range(len(force)), repeat=2)
        if sign[a] * sign[b] < 0 and 0.0 < force[b] - force[a] <= 4.0
    ]
    yield "", min(apart, default=1.0)


def crossover_rises(data: Data) -> Numbers:  # R9
    curves = {mu: _curve(data, mu, "double_peaked") for mu in _frictions(data)}
    own = {mu: Quantity.bracket(*first_change(one["force"].values, one.values > 0.0)) for mu, one in curves.items()}
    yield "", rise(own.values())
    yield from preparations.along(
        data, lambda other: rise(other.event(GROUP, "crossover", friction=mu) if mu else own[mu] for mu in own)
    )
