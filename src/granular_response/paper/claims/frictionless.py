"""Claims F1 to F9: ordered slabs, the first openings and the crossover without friction (Secs. IV and V.B)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .claim import Claim, Condition, Data, Finding, NotMeasured, sampled_event

FloatArray = NDArray[np.float64]

GROUP = "frictionless_crossover"
FRICTION = "friction_linear_range"

#: The paper's stiffness of contacts.
STIFFNESS = 3000.0

#: Distance of two rows of disks, and of two disks in a row (mean radii): the resolution of a region's size.
ROW, DISK = float(np.sqrt(3.0)), 2.0


def first_opening(friction: float, paper: float):
    def measure(data: Data) -> Finding:
        bracket = data.event(FRICTION, "first_opening", friction)
        return Finding(
            f"opens at {bracket.text(' mg')}",
            bracket.middle,
            sampled_event("first opening", bracket, paper),
            (bracket.low, bracket.high),
            "The event itself is bracketed here; the paper names the first of its sampled forces",
        )

    return measure


def crossover(data: Data) -> Finding:
    event = data.event(GROUP, "crossover")
    floor = data.event(GROUP, "teardrop_reaches_floor")
    ratio = event.middle / floor.middle
    return Finding(
        f"two peaks from {event.text(' mg')}; the open region reaches the floor at {floor.text(' mg')}",
        event.middle,
        [
            Condition("a crossover to two peaks happens", event.happens, event.text(" mg"), essential=True),
            Condition(
                "crossover between 0.7 and 1 times the force at which the open region reaches the floor",
                event.happens and floor.happens and ratio >= 0.7 and event.high <= floor.low,
                f"crossover at {ratio:.2f} of that force",
            ),
        ],
        (event.low, event.high),
    )


def teardrop_shape(data: Data) -> Finding:
    states = data.get(GROUP, "states", "teardrop", "position", "contact_disk", "contact_partner", "force")
    response = data.get(GROUP, "response", "teardrop_depth", "reaches_floor", "force")
    first, second = states["contact_disk"].values, states["contact_partner"].values
    forces, shares, free, away = states["force"].values, {}, [], []
    for k in range(states.sizes["force"]):
        inside = states["teardrop"].values[k].astype(bool)
        if not inside.any():
            continue
        position = states["position"].values[k]
        height = np.abs(position[first, 1] - position[second, 1])[inside]
        shares[float(forces[k])] = float((height < 0.5 * ROW).mean())
        rows = np.round(0.5 * (position[first, 1] + position[second, 1])[inside] / ROW).astype(int)
        counts = np.bincount(rows - rows.min())
        if rows.min() > 1:
            away.append(float(forces[k]))
        if rows.min() > 1 and len(counts) >= 4:
            free.append(counts)
    depth = response["teardrop_depth"].values
    # the first opening is one contact; from then on the region goes down row by row
    grows = bool((np.diff(depth) > -0.5 * ROW).all() and depth.max() > depth[0] + 2.0 * ROW)
    if not shares or not free:
        raise NotMeasured(f"data/{GROUP}.nc: no state with a region of opened contacts that has not reached the floor")
    widest = free[-1]
    # bincount runs from the lowest row up
    drop = bool(widest.max() > widest[-1] and widest.max() > widest[0])
    growing, least = min(shares[force] for force in away), min(shares, key=lambda force: shares[force])
    share = shares[least]
    return Finding(
        f"horizontal part of the opened contacts: {growing:.1%} until the region reaches the floor, {share:.1%} at "
        f"{least:g} mg; depth grows from {depth[0]:.1f} to {depth.max():.1f} R",
        growing,
        [
            Condition(
                "at least 99 % of the opened contacts are horizontal until their region reaches the floor",
                growing >= 0.99,
                f"{growing:.1%}",
                True,
            ),
            Condition(
                "at least 99 % at every stored force", share >= 0.99, f"{share:.1%} of them horizontal at {least:g} mg"
            ),
            Condition("depth never falls with the force by half a row or more", grows, f"{np.diff(depth).min():.2f} R"),
            Condition(
                "before it reaches the floor the region is widest between its ends",
                drop,
                f"contacts by row, from below: {', '.join(map(str, widest))}",
            ),
        ],
        remark="Large forces open oblique contacts too, close below the load; the paper's pictures end before",
    )


def _sizes(data: Data, *names: str) -> xr.Dataset:
    """Slabs of several depths, all with the paper's stiffness."""
    sizes = data.get(GROUP, "sizes", "layers", "normal_stiffness", "force", *names)
    alike = np.isclose(sizes["normal_stiffness"].values, STIFFNESS)
    if not alike.any():
        raise NotMeasured(f"data/{GROUP}.nc: sizes holds no slab with k_N = {STIFFNESS:g}")
    return sizes.isel(slab=alike)


def _slightly(depth: FloatArray, width: FloatArray, use: NDArray[np.bool_], deep: int) -> tuple[bool, float, float]:
    """Whether depth and width in slab ``deep`` are only slightly below those in slab 0, and their mean ratios."""
    slight = True
    ratios: list[float] = []
    for values, step in ((depth, ROW), (width, DISK)):
        a, b = values[0, use], values[deep, use]
        slight &= bool((b <= a + 1.05 * step).all() and (b >= 0.75 * a - 1.05 * step).all())
        ratios.append(float(b.sum() / a.sum()))
    return slight, ratios[0], ratios[1]


def teardrop_and_depth(data: Data) -> Finding:
    study = data.get(GROUP, "sizes", "layers", "normal_stiffness", "teardrop_depth", "teardrop_width", "reaches_floor")
    stiffnesses = np.unique(study["normal_stiffness"].values)
    if not np.isclose(stiffnesses, STIFFNESS).any():
        raise NotMeasured(f"data/{GROUP}.nc: sizes holds no slab with k_N = {STIFFNESS:g}")
    asked = [STIFFNESS] + [float(k) for k in stiffnesses[-1:] if k > 1.01 * STIFFNESS]
    conditions, texts, ratios = [], [], []
    remark = ""
    for stiffness in asked:
        slabs = study.isel(slab=np.isclose(study["normal_stiffness"].values, stiffness)).sortby("layers")
        layers, floor = slabs["layers"].values, slabs["reaches_floor"].values
        depth, width = slabs["teardrop_depth"].values, slabs["teardrop_width"].values
        use = (floor[0] == 0) & (depth[0] > 2.0 * ROW)
        if len(layers) < 2 or not use.any():
            raise NotMeasured(f"data/{GROUP}.nc: sizes holds one depth, or no open region away from the floor")
        found = [_slightly(depth, width, use, k) for k in range(1, len(layers))]
        slight, deep, wide = found[-1]
        texts.append(f"depth {deep:.2f}, width {wide:.2f} times at k_N = {stiffness:g}")
        conditions.append(
            Condition(
                f"k_N = {stiffness:g}: depth and width at least 3/4 of those in the thinnest slab less one lattice "
                "step, and at most one step above them",
                slight,
                texts[-1],
            )
        )
        ratios.append(deep)
        holding = [entry[0] for entry in found]
        if stiffness == STIFFNESS and not slight:
            last = layers[holding.index(False)]
            remark = (
                f"With the paper's stiffness it holds up to {last:.0f} layers. In deeper slabs gravity compresses "
                "the disks so much that horizontal contacts are pressed together and open later"
            )
    return Finding(
        f"{layers[-1]:.0f} against {layers[0]:.0f} layers, same force: {'; '.join(texts)}",
        ratios[0],
        conditions,
        (min(ratios), max(ratios)) if len(ratios) > 1 else None,
        remark,
    )


def deep_and_shallow(data: Data) -> Finding:
    sizes = _sizes(data, "double_peaked")
    layers, double = sizes["layers"].values, sizes["double_peaked"].values.astype(bool)
    thin, deep = int(np.argmin(layers)), int(np.argmax(layers))
    force = sizes["force"].values
    both = double[thin] & ~double[deep]
    against = ~double[thin] & double[deep]
    forces = force[both]
    where = f"{forces.min():g} to {forces.max():g} mg" if both.any() else "no stored force"
    return Finding(
        f"two peaks at {layers[thin]:.0f} layers and one at {layers[deep]:.0f}: {where}",
        float(forces.max()) if both.any() else float("nan"),
        [
            Condition("at some force the thinnest slab has two peaks, the deepest one", bool(both.any()), where, True),
            Condition("at no force it is the other way round", not against.any(), f"{against.sum()} forces"),
        ],
        (float(forces.min()), float(forces.max())) if both.any() else None,
    )


def stiffness_response(data: Data) -> Finding:
    study = data.get(GROUP, "stiffness", "response_change", "compared_stiffness", "force")
    change, force = np.abs(study["response_change"].values), study["force"].values
    soft, stiff = study["compared_stiffness"].values
    if not (abs(soft - 1e3) < 1.0 and abs(stiff - 1e5) < 100.0):
        raise NotMeasured(f"data/{GROUP}.nc: stiffness does not compare 1000 and 1e5")
    small = change <= 0.03
    return Finding(
        f"changes by {change[0]:.1%} at the smallest force and by up to {change.max():.1%}, "
        f"at {force[change.argmax()]:g} mg",
        float(change.max()),
        [
            Condition("at most 3 % at the smallest force", bool(small[0]), f"{change[0]:.1%} at the smallest force"),
            Condition(
                "at most 3 % at every stored force",
                bool(small.all()),
                f"up to {change.max():.1%}, at {force[change.argmax()]:g} mg",
            ),
        ],
        (float(change.min()), float(change.max())),
        "The paper does not name the force at which it compared",
    )


def stiffness_teardrop(data: Data) -> Finding:
    study = data.get(GROUP, "stiffness", "teardrop_depth", "teardrop_width", "reaches_floor", "normal_stiffness")
    stiffness = study["normal_stiffness"].values
    order = np.argsort(stiffness)
    stiffness = stiffness[order]
    depth, width = study["teardrop_depth"].values[order], study["teardrop_width"].values[order]
    use = (depth[-1] > 2.0 * ROW) & ~study["reaches_floor"].values[order].astype(bool).any(axis=0)
    high, low = stiffness >= 2000.0, stiffness < 2000.0
    if not use.any() or not low.any() or high.sum() < 2:
        raise NotMeasured(f"data/{GROUP}.nc: stiffness holds no force or too few stiffnesses to compare")
    depth, width = depth[:, use], width[:, use]
    spread = max(float(np.ptp(depth[high], axis=0).max() / ROW), float(np.ptp(width[high], axis=0).max() / DISK))
    grown = float((depth[-1] - depth[0]).max() / ROW), float((width[-1] - width[0]).max() / DISK)
    return Finding(
        f"k_N of 2000 and more: sizes differ by up to {spread:.2f} lattice steps; softest to stiffest: depth grows by "
        f"up to {grown[0]:.1f} rows, width by {grown[1]:.1f} disks",
        spread,
        [
            Condition(
                "depth or width grows by at least one lattice step", max(grown) > 0.95, f"{max(grown):.1f}", True
            ),
            Condition(
                "for k_N of 2000 and more, depth and width differ by at most one lattice step",
                spread < 1.1,
                f"{spread:.2f} lattice steps",
            ),
        ],
    )


CLAIMS = (
    *(
        Claim(
            f"F{k}",
            "V.B",
            f"friction {mu:g}: smallest force that opens a contact in the central third of the slab, by bisection on "
            "the load path",
            f"{paper:g} mg",
            first_opening(mu, paper),
            figures,
            FRICTION,
        )
        for k, mu, paper, figures in ((1, 0.0, 0.75, (4, 6)), (2, 0.2, 4.0, (8,)), (3, 1.0, 6.0, (9,)))
    ),
    Claim(
        "F4",
        "IV.A, Fig. 3",
        "without friction: force at which the floor response gets two peaks, each above the response at x = 0, and "
        "force at which the open region reaches the lowest row",
        "exists, a little below the force at which the open region reaches the floor",
        crossover,
        (3, 4),
        GROUP,
    ),
    Claim(
        "F5",
        "IV.A, Fig. 4",
        "without friction: directions of the opened contacts, and depth and rows of their connected region below the "
        "load at growing forces",
        "open contacts are the horizontal ones, in the shape of a teardrop that grows with the force",
        teardrop_shape,
        (4, 5),
        GROUP,
    ),
    Claim(
        "F6",
        "IV.B, Fig. 5",
        "depth and width of the open region in the deepest slab over those in the thinnest, at the forces at which the "
        "latter has not reached its floor; with the paper's stiffness and with the largest one stored",
        "fall only slightly with the number of layers",
        teardrop_and_depth,
        (5,),
        GROUP,
    ),
    Claim(
        "F7",
        "IV.B",
        "forces at which the thinnest slab has two peaks and the deepest has one",
        "a deep slab has one peak where a shallow one has two",
        deep_and_shallow,
        (5,),
        GROUP,
    ),
    Claim(
        "F8",
        "IV.C",
        "without friction: relative change of the response at x = 0 from k_N = 1e5 to 1000",
        "about 2 %",
        stiffness_response,
        (5,),
        GROUP,
    ),
    Claim(
        "F9",
        "IV.C",
        "depth and width of the open region against k_N, at forces at which it reaches no floor",
        "grow with k_N and saturate for k_N of 2000 and more",
        stiffness_teardrop,
        (5,),
        GROUP,
    ),
)
