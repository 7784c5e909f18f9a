"""Claims of Secs. I and V: ordered slabs with friction under growing forces."""

from __future__ import annotations

from itertools import product

import numpy as np
import xarray as xr

from granular_response.state import OPEN, SLIDING, FloatArray
from granular_response_paper.claims import preparations
from granular_response_paper.claims.claim import Data, Numbers, Quantity, at, first, needs, rise

GROUP = "friction_linear_range"

#: Frictions of the paper (Fig. 6, Sec. V.B), and how far off a response may no longer be linear.
FRICTIONS, TOLERANCES = (0.0, 0.2, 1.0), (0.01, 0.02, 0.05)


def _curve(data: Data, friction: float, name: str) -> xr.Dataset:
    """The response at a friction, at the forces at which this is measured."""
    curve = at(data.get(GROUP, "response"), friction=friction)
    return curve.isel(force=np.isfinite(curve[name].values))


def _linear(data: Data, friction: float, tolerance: float) -> Quantity:
    """The end of the linear range: located to 1 %, else between two stored forces."""
    if tolerance == TOLERANCES[0]:
        return data.event(GROUP, "linear_range", friction)
    curve = _curve(data, friction, "response_at_centre")
    response = curve["response_at_centre"].values
    return first(curve, "force", np.abs(response / response[0] - 1.0) > tolerance)


def _frictions(data: Data) -> list[float]:
    return np.unique(data.get(GROUP, "response")["friction"].values).tolist()


def linear_range(data: Data) -> Numbers:
    """R1, per that without friction."""
    own = {part: {mu: _linear(data, mu, part) for mu in FRICTIONS} for part in TOLERANCES}
    rows = [(f"response {part:.0%} off", list(ends.values())) for part, ends in own.items()]
    others = preparations.along(data, "linear_range", FRICTIONS, own[TOLERANCES[0]])
    for case, (without, *ends) in [*rows, *others]:
        yield case, *(end.per(without) for end in ends)


def range_grows(data: Data) -> Numbers:  # A1
    for name, frictions in (("frictions 0, 0.2 and 1", FRICTIONS), ("all frictions", _frictions(data))):
        for part in TOLERANCES:
            yield f"response {part:.0%} off, {name}", rise([_linear(data, mu, part) for mu in frictions])
        yield f"first opening, {name}", rise([data.event(GROUP, "first_opening", mu) for mu in frictions])
    for event in ("first_opening", "linear_range"):
        own = {mu: data.event(GROUP, event, mu) for mu in FRICTIONS}
        for way, ends in preparations.along(data, event, FRICTIONS, own):
            yield way, rise(ends)


def smaller_anisotropy(data: Data) -> Numbers:
    """A2: growth and fall with friction."""
    axis = data.get(GROUP, "friction_axis").sortby("friction")
    largest = _curve(data, _frictions(data)[-1], "response_at_centre")
    elastic = largest["floor_response"].transpose("force", "floor_disk").values[0]
    response = axis["floor_response"].transpose("friction", "floor_disk").values
    off = np.sqrt(((response - elastic) ** 2).sum(axis=1) / (elastic**2).sum())
    for case, size in (("dip at x = 0", axis["central_dip"].values), ("difference from the elastic response", off)):
        yield case, np.diff(size).max(), 1.0 - size[-1] / size[0]


def elastic_without_friction(data: Data) -> Numbers:  # F11
    curve = _curve(data, 0.0, "response_at_centre")
    until = data.event(GROUP, "first_opening", 0.0).low
    before = curve["response_at_centre"].values[curve["force"].values <= until]
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
    yield "", rise([Quantity.exact(-np.quantile(away[slides, 1], 0.1)) for slides, away, _ in found])


def reorganized(data: Data) -> Numbers:
    """R4c, in the region that has opened contacts: below the load, as far to each side as it is deep there."""
    parts = []
    for force in (20.0, 30.0):
        slides, away, level = _slides(data, force)
        below = np.abs(away[:, 0]) < -away[:, 1] / np.sqrt(3.0)
        needs((slides & below).any(), f"states_mu_0.2 holds no sliding contact below the load at {force:g} mg")
        parts.append(Quantity.exact(level[slides & below].mean()))
    yield "", parts[0], parts[1].per(parts[0])


def _jump(data: Data) -> tuple[xr.Dataset, int]:
    """The dynamic runs at large forces, in order, and the index of the first asymmetric one."""
    runs = data.get(GROUP, "large_forces").sortby("force")
    lost = np.flatnonzero(runs["asymmetry"].values > 0.1)
    needs(lost[:1].any(), "large_forces holds no forces on both sides of the loss of symmetry")
    return runs, int(lost[0])


def sharp(data: Data) -> Numbers:  # R5b
    runs, first = _jump(data)
    yield "", np.diff(runs["asymmetry"].values)[first - 1]


def sliding_drops(data: Data) -> Numbers:  # R6a
    runs, first = _jump(data)
    sliding = runs["mobilised_contacts"].transpose("force", "margin").values
    for margin, before, after in zip(runs["margin"].values, sliding[first - 1], sliding[first], strict=True):
        if before > 0:
            yield f"within {margin:.0%}", after / before


def network_asymmetric(data: Data) -> Numbers:
    """R6b: before, and the smallest part after."""
    runs, first = _jump(data)
    network = runs["network_asymmetry"].values
    yield "", network[first - 1], network[first:].min()


def network_changes(data: Data) -> Numbers:  # R6c
    runs, first = _jump(data)
    states = data.get(GROUP, "large_force_states")
    states = states.assign_coords(force=states["force"])
    ends = (at(states, force=float(runs["force"][k]))["contact_status"].values != OPEN for k in (first - 1, first))
    before, after = ends
    yield "", (before != after).sum() / before.sum()


def by_sliding(data: Data) -> Numbers:  # R6d
    states = data.get(GROUP, "states_mu_1")
    force, status = states["force"].values, states["contact_status"].values
    rest, last = status[0], status[np.flatnonzero(force <= 90.0)[-1]]
    opened = ((rest != OPEN) & (last == OPEN)).sum()
    needs(opened > 0, "states_mu_1 holds no opened contact")
    yield "", (last == SLIDING).sum() / opened


def mirror_images(data: Data) -> Numbers:
    """R7. The paper's pair lies between 91 and 95 mg."""
    runs, first = _jump(data)
    after = runs.isel(force=slice(first, None))
    response, force, sign = (after[name].values for name in ("floor_response", "force", "asymmetry_sign"))
    apart = [
        float(np.abs(response[a] - response[b][::-1]).max() / response[a].max())
        for a, b in product(range(len(force)), repeat=2)
        if sign[a] * sign[b] < 0 and 0.0 < force[b] - force[a] <= 4.0
    ]
    yield "", min(apart, default=1.0)


def similar_beyond(data: Data) -> Numbers:  # R7b
    runs, first = _jump(data)
    size, force = runs["asymmetry"].values, runs["force"].values
    far = np.flatnonzero(force >= 150.0)
    for k in far[[0, -1]]:
        yield f"{force[k]:g} mg", size[k] / size[first]


def crossover_rises(data: Data) -> Numbers:  # R9
    found = {}
    for mu in _frictions(data):
        curve = _curve(data, mu, "double_peaked")
        found[mu] = first(curve, "force", curve["double_peaked"].values > 0.0)
    for case, ends in [("", list(found.values())), *preparations.along(data, "crossover", list(found), found)]:
        yield case, rise(ends)
