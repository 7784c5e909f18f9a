"""Claims B2 and B3, beyond the paper: whether what is nonlinear is irreversible, and what a second loading finds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granular_response_paper.claims import asked
from granular_response_paper.claims.bootstrap import over_brackets, over_realizations
from granular_response_paper.claims.claim import Claims, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "hysteresis"
CLAIMS = Claims(GROUP)
#: Realizations from which on they have an interval of confidence.
FEWEST = 3


def over_packings(each: Sequence[Quantity]) -> Quantity:
    """One packing as it is; of several the median with its interval, of two what they span."""
    if len(each) == 1:
        return each[0]
    if len(each) >= FEWEST:
        return over_brackets(each)
    middle = float(np.median([one.value for one in each]))
    return Quantity(middle, min(one.low for one in each), max(one.high for one in each), "range")


@CLAIMS.measures("B2")
def ranges(data: Data, words: Bounds) -> Finding:
    events = data.get(GROUP, "events")
    readings: list[Reading] = []
    ends: dict[bool, list[Quantity]] = {True: [], False: []}
    for case in range(events.sizes["case"]):
        one = events.isel(case=case)
        linear, reversible = (_brackets(one.sel(event=name)) for name in ("linear_range", "reversible_range"))
        there = [k for k, end in enumerate(linear) if np.isfinite(end.low)]  # realizations that are
        if any(linear[k].happens for k in there):
            found = over_packings([reversible[k].per(linear[k]) for k in there])
            ends[bool(one["friction"] > 0.0)].append(found)
            condition = asked.near("reversible over linear range", found, words, "about")
            readings.append(Reading(asked.material(one), condition))
    parts = [
        f"{'with' if friction else 'without'} friction {_span(found)}" for friction, found in ends.items() if found
    ]
    return Finding(f"the reversible range over the linear one: {', '.join(parts)}", readings)


def _brackets(event: xr.Dataset) -> list[Quantity]:
    return [Quantity.bracket(*ends) for ends in zip(event["low"].values, event["high"].values, strict=True)]


def _span(found: Sequence[Quantity]) -> str:
    low, high = min(one.low for one in found), max(one.high for one in found)
    return f"{low:.2g} to {high:.2g}" if np.isfinite(high) else f"above {low:.2g}"


@CLAIMS.measures("B3")
def repeated(data: Data, words: Bounds) -> Finding:
    loops = data.get(GROUP, "loops")
    readings, lost, changed = [], [], []
    for case in range(loops.sizes["case"]):
        one = loops.isel(case=case)
        last = int(np.flatnonzero(np.isfinite(one["force"].values))[-1])
        one = one.isel(turn=last)
        part = _of_realizations((one["slid_again"] + one["crossed_again"]).values / one["work"].values)
        floor = _of_realizations(one["floor_repeated"].values)
        lost.append(part.value)
        changed.append(floor.value)
        readings.append(
            Reading(
                f"{asked.material(one)}, {float(one['force']):g} mg",
                asked.at_most("part of the work lost again", part, words, "visible", "%"),
                asked.at_most("change of the response", floor, words, "visible", "%"),
            )
        )
    return Finding(
        f"a second loading loses up to {100.0 * max(lost):.2g} % of the work, and changes the response by up to "
        f"{100.0 * max(changed):.1g} %",
        readings,
    )


def _of_realizations(values: np.ndarray) -> Quantity:
    """One packing has no interval, of several the mean has one."""
    found = values[np.isfinite(values)]
    return over_realizations(found, np.mean) if len(found) > 1 else Quantity.exact(found[0])
