"""Loops of all packings, for the documents."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from granular_response.state import FloatArray
from granular_response_paper.claims.numbers import digits, shown
from granular_response_paper.report.markdown import table

#: Parts of a work or a force that count as none.
NOTHING = 1e-8
#: Within which most loops balance.
BALANCED = 1e-4


def markdown(datasets: Mapping[str, xr.Dataset]) -> str:
    """A line for each packing of the group ``hysteresis``, of disorder median, least and largest; and the balance."""
    measured, events = datasets["loops"], datasets["events"]
    forces = (f"{name} (mg)" for name in ("first opening", "linear up to", "reversible up to", "F"))
    heads = ["packing", *forces, "residual floor forces", "dissipation, first loop", "second loop"]
    rows = []
    off: dict[str, list[FloatArray]] = {"lattices": [], "disorder": []}
    count = 0
    for case in range(measured.sizes["case"]):
        one, ends = measured.isel(case=case), events.isel(case=case)
        delta, friction = float(one["polydispersity"]), float(one["friction"])
        last = int(np.flatnonzero(np.isfinite(one["force"].values))[-1])
        there = np.isfinite(one["work"].values[:, last])
        count = max(count, int(there.sum()))
        brackets = [
            np.stack([ends[end].sel(event=event).values[there] for end in ("low", "high")], axis=1)
            for event in ("first_opening", "linear_range", "reversible_range")
        ]
        one = one.isel(realization=there)
        gone = [one[f"slid{again}"] + one[f"crossed{again}"] for again in ("", "_again")]
        for again, lost in zip(("", "_again"), gone, strict=True):
            balance = ((one[f"lost{again}"] - one[f"kept{again}"] - lost) / one["work"]).values
            off["disorder" if delta else "lattices"].append(np.abs(balance[np.isfinite(balance)]))
        at = one.isel(turn=last)
        rows.append(
            [
                f"δ = {delta:g}, µ = {friction:g}" if delta else f"lattice, µ = {friction:g}",
                *map(_range, brackets),
                f"{float(at['force']):g}",
                _part(at["floor_left"].values),
                *(_part((lost.isel(turn=last) / at["work"]).values) for lost in gone),
            ]
        )
    lines = [table(heads, rows), "", f"Disorder: median of {count} realizations (least to largest)."]
    for name, found in off.items():
        every = np.concatenate(found) if found else np.zeros(0)
        if every.size:
            close = float((every < BALANCED).mean())
            most = f", in {shown(close, 'part')} of them within {digits(BALANCED, 1)}" if close < 1.0 else ""
            lines.append(
                f"Work, stored energy and dissipation balance within {digits(max(every.max(), BALANCED), 1)} of the "
                f"work of the first loading in all loops of {name}{most}."
            )
    return "\n".join(lines)


def _range(brackets: FloatArray) -> str:
    """Forces (r, 2), nan above for what was not reached: the bracket of one packing, median and ends of several."""
    low, high = brackets.T
    if np.isnan(high).all():
        return f"above {low.min():.3g}"
    most = f"above {low[np.isnan(high)].max():.3g}" if np.isnan(high).any() else f"{high.max():.3g}"
    if len(brackets) == 1:
        least = f"{low[0]:.3g}"
        return most if least == most else f"{least} to {most}"
    middle = float(np.median(np.where(np.isnan(high), np.inf, 0.5 * (low + high))))
    half = f"{middle:.3g}" if np.isfinite(middle) else "in fewer than half"
    return f"{half} ({low.min():.3g} to {most})"


def _part(values: FloatArray) -> str:
    """Parts (r,) as per cent."""
    if np.abs(values).max() < NOTHING:
        return "nothing"

    def said(value: float) -> str:
        return f"{100.0 * value:.2g}" if abs(value) >= NOTHING else "0"

    if len(values) == 1:
        return f"{said(values[0])} %"
    return f"{said(float(np.median(values)))} ({said(values.min())} to {said(values.max())}) %"
