"""Claims F4 to F9: the ordered slab without friction (Sec. IV)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from ...claims.words import Bounds

GROUP = "frictionless_crossover"
CLAIMS = Claims(GROUP)

#: The paper's stiffness of contacts.
STIFFNESS = 3000.0

#: Distance of two rows of disks, and of two disks in a row (mean radii): the resolution of a region's size.
ROW, DISK = float(np.sqrt(3.0)), 2.0


def _crossovers(data: Data, words: Bounds) -> dict[str, Quantity]:
    """The crossover force by what counts as two peaks."""
    response = data.get(GROUP, "response")
    return {
        "peaks on both sides": data.event(GROUP, "crossover"),
        asked.VISIBLE: asked.dips_from(response, "force", words),
    }


@CLAIMS.measures("F4a")
def crossover(data: Data, words: Bounds) -> Finding:
    ends = _crossovers(data, words)
    largest = float(data.get(GROUP, "response")["force"].max())
    return asked.each(
        "two peaks from ", ends, lambda event: Condition("two peaks from", event, 0.0, largest, unit="mg"), "mg"
    )


@CLAIMS.measures("F4b")
def before_the_floor(data: Data, words: Bounds) -> Finding:
    ends, floor = _crossovers(data, words), data.event(GROUP, "teardrop_reaches_floor")
    what, least = "crossover per force at the floor", 1.0 - words["slightly"]
    return Finding(
        f"two peaks from {asked.listed(ends, unit='mg')}, the open region at the floor from {floor.text('mg')}",
        [Reading(name, Condition(what, end.per(floor), least, 1.0, ("slightly",))) for name, end in ends.items()],
    )


def _open_regions(data: Data) -> list[tuple[float, float, np.ndarray]]:
    """Force, horizontal share of the opened contacts, and contacts by row from below, until the floor is reached."""
    states = data.get(GROUP, "states")
    first, second = states["contact_disk"].values, states["contact_partner"].values
    found = []
    for k in range(states.sizes["force"]):
        inside = states["teardrop"].values[k].astype(bool)
        if not inside.any():
            continue
        height = states["position"].values[k][:, 1]
        share = float((np.abs(height[first] - height[second])[inside] < 0.5 * ROW).mean())
        rows = np.round(0.5 * (height[first] + height[second])[inside] / ROW).astype(int)
        if rows.min() > 1:
            found.append((float(states["force"].values[k]), share, np.bincount(rows - rows.min())))
    return found


@CLAIMS.measures("F5a")
def horizontal(data: Data, words: Bounds) -> Finding:
    regions = _open_regions(data)
    least = min(share for _, share, _ in regions)
    return asked.one_reading(
        f"horizontal part of the opened contacts until their region reaches the floor: at least {least:.1%}",
        "until the region reaches the floor",
        asked.hardly_lower("smallest horizontal part of the opened contacts", least, words, "visible", "%"),
    )


@CLAIMS.measures("F5b")
def teardrop(data: Data, words: Bounds) -> Finding:
    regions = [counts for _, _, counts in _open_regions(data)]
    depth = data.get(GROUP, "response")["teardrop_depth"].values
    widest = regions[-1]
    CLAIMS.needs(len(widest) > 3, "no region of four rows that has not reached the floor")
    return asked.one_reading(
        f"contacts by row, from below, before the region reaches the floor: {', '.join(map(str, widest))}; depth grows "
        f"from {depth[0]:.1f} to {depth.max():.1f} R",
        "as described",
        Condition(
            "widest row per the wider end", Quantity.exact(widest.max() / max(widest[0], widest[-1])), 1.0, strict=True
        ),
        Condition(
            "smallest growth of the depth with the force, rows (known to half a row)",
            Quantity.exact(float(np.diff(depth).min() / ROW)),
            -0.5,
        ),
        Condition("growth of the depth, rows", Quantity.exact(float((depth.max() - depth[0]) / ROW)), 0.5),
    )


def size_in_steps(size: np.ndarray, step: float) -> Quantity:
    """The mean of a size over evenly spaced forces at which it grows by whole steps.

    A size is rounded down, by half a step in the mean over each whole step that it grows. So the mean lacks half a
    step, to within half a step over the number of steps grown.
    """
    steps = max(1.0, float(size.max() - size.min()) / step)
    mean, off = float(size.mean()) + 0.5 * step, 0.5 * step / steps
    return Quantity(mean, mean - off, mean + off, "bracket")


@CLAIMS.measures("F6")
def teardrop_and_depth(data: Data, words: Bounds) -> Finding:
    readings, texts = [], []
    for stiffness, slabs in _by_stiffness(data, "regions", paper_first=True):
        layers = [f"{count:.0f} layers" for count in slabs["layers"].values]
        use = (slabs["reaches_floor"].values[0] == 0) & (slabs["teardrop_depth"].values[0] > 2.0 * ROW)
        for k in range(1, len(layers)):
            conditions = []
            for what, step in (("depth", ROW), ("width", DISK)):
                thin, deep = (size_in_steps(slabs[f"teardrop_{what}"].values[slab, use], step) for slab in (0, k))
                text = f"{what} per that in {layers[0]}"
                conditions.append(asked.hardly_lower(text, deep.per(thin), words, "slightly"))
            texts.append(f"{conditions[0].found.value:.2f} in {layers[k]} (k_N = {stiffness:g})")
            readings.append(Reading(f"{layers[k]}, k_N = {stiffness:g}", *conditions, change=_change(stiffness)))
    return Finding("depth of the open region per that in the thinnest slab, same forces: " + ", ".join(texts), readings)


def _by_stiffness(data: Data, name: str, *, paper_first: bool = False) -> list[tuple[float, xr.Dataset]]:
    """Slabs by the number of their layers, for each stiffness of contacts; in order, or the paper's first."""
    study = data.get(GROUP, name).sortby("layers")
    stiffnesses = np.unique(study["normal_stiffness"].values).tolist()
    if paper_first:
        stiffnesses.sort(key=lambda stiffness: abs(stiffness - STIFFNESS))
    return [(one, study.isel(slab=np.isclose(study["normal_stiffness"].values, one))) for one in stiffnesses]


def _change(stiffness: float) -> str:
    return "" if np.isclose(stiffness, STIFFNESS) else "stiffness"


def _deep_and_shallow(slabs: xr.Dataset, same_width: bool) -> list[tuple[int, int]]:
    """Pairs of the thinnest slab and each deeper one, by their place; of the same width with as many disks in a row."""
    layers, row = slabs["layers"].values, slabs["disks_per_row"].values
    deeper, thinnest = (np.flatnonzero(one).tolist() for one in (layers > layers[0], layers == layers[0]))
    if not same_width:
        return [(0, deep) for deep in deeper]
    # rows of one disk more or less: the lattice needs both numbers odd or both even
    return [(thin, deep) for deep in deeper for thin in thinnest if abs(row[deep] - row[thin]) <= 1]


@CLAIMS.measures("F7")
def deep_and_shallow(data: Data, words: Bounds) -> Finding:
    rows = []
    for name in ("sizes", "widths"):  # of the first, the width grows with the depth
        for stiffness, slabs in _by_stiffness(data, name):
            for pair in _deep_and_shallow(slabs, name == "widths"):
                thin, deep = (Quantity.bracket(*slabs["crossover_bracket"].values[k]) for k in pair)
                shapes = [f"{slabs['layers'].values[k]} x {slabs['disks_per_row'].values[k]}" for k in pair]
                reading = Reading(
                    f"{shapes[1]} against {shapes[0]} disks, k_N = {stiffness:g}",
                    Condition("crossover force, deep per shallow", deep.per(thin), 1.0, strict=True),
                    change=_change(stiffness),
                )
                rows.append((f"{deep.text('mg')} against {thin.text('mg')}", reading))
    return asked.told("crossover in the deep and in the shallow slab: ", rows)


def _between(data: Data) -> xr.Dataset:
    """The study of stiffness for k_N from 1000 to 1e5. Raises NotMeasured if it does not span them."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness")
    stiffness = study["normal_stiffness"].values
    chosen = (stiffness >= 999.0) & (stiffness <= 1.001e5)
    there = chosen.any() and stiffness[chosen].min() < 1001.0 and stiffness[chosen].max() > 0.99e5
    CLAIMS.needs(there, "stiffness does not span 1000 to 1e5")
    return study.isel(normal_stiffness=chosen)


@CLAIMS.measures("F8")
def stiffness_response(data: Data, words: Bounds) -> Finding:
    study = _between(data)
    force, values = study["force"].values, study["response_at_centre"].transpose("normal_stiffness", "force").values
    change = np.ptp(values, axis=0) / np.abs(values[-1])
    what, most = "change of the response at x = 0", (1.0 + words["about"]) * 0.02
    return Finding(
        f"changes by {change.min():.2%} (at {force[change.argmin()]:g} mg) to {change.max():.1%} (at "
        f"{force[change.argmax()]:g} mg)",
        [
            Reading(f"{f:g} mg", Condition(what, Quantity.exact(c), most=most, words=("about",), unit="%"))
            for f, c in zip(force.tolist(), change.tolist(), strict=True)
        ],
    )


@CLAIMS.measures("F9")
def stiffness_teardrop(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness")
    stiffness = study["normal_stiffness"].values
    depth, width = study["teardrop_depth"].values, study["teardrop_width"].values
    use = (depth[-1] > 2.0 * ROW) & ~study["reaches_floor"].values.astype(bool).any(axis=0)
    high = stiffness >= 2000.0
    CLAIMS.needs(high.sum() > 1 and not high.all(), "stiffness holds too few stiffnesses to compare")
    conditions = []
    for what, size in (("depth", depth[:, use]), ("width", width[:, use])):
        spread = float((np.ptp(size[high], axis=0) / size[-1]).max())
        conditions.append(
            asked.at_most(f"largest change of the {what} for k_N of 2000 and more", spread, words, "nearly", "%")
        )
    grown = float(((depth[-1] - depth[0])[use] / ROW).max())
    return asked.one_reading(
        f"depth grows by up to {grown:.1f} rows from k_N = {stiffness[0]:g} to {stiffness[-1]:g}; for 2000 and more it "
        f"changes by {conditions[0].found.value:.1%}",
        "forces at which the region reaches no floor",
        *conditions,
        Condition("growth of the depth, rows", Quantity.exact(grown), 0.5),
    )


@CLAIMS.measures("F10")
def crossover_and_stiffness(data: Data, words: Bounds) -> Finding:
    study = _between(data)

    def spread_of(brackets: np.ndarray) -> Quantity:
        ratios = [Quantity.bracket(*one).per(Quantity.bracket(*brackets[-1])) for one in brackets[:-1]]
        return Quantity(ratios[0].value, min(r.low for r in ratios), max(r.high for r in ratios), "range")

    ends = [Quantity.bracket(*one) for one in study["crossover_bracket"].values]
    spread = spread_of(study["crossover_bracket"].values)
    others = [
        f"{spread_of(one).high:.4f} from a dip of {dip:.1%} on"
        for dip, one in zip(study["dip"].values, np.moveaxis(study["crossovers"].values, 1, 0), strict=True)
    ]
    return asked.one_reading(
        f"crossover from k_N = 1000 to 1e5: {ends[0].text('mg')} to {ends[-1].text('mg')}",
        "15 layers",
        asked.near("crossover force per that at the largest k_N", spread, words, "nearly"),
        remark=f"Largest ratio by other definitions of two peaks: {', '.join(others)}",
    )
