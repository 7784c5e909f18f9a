"""Claims B11 to B13, beyond the paper: contact networks against what granular packings are known for (Sec. VI)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Case, Data, Numbers, Quantity


def _means(data: Data, name: str, state: str) -> list[tuple[str, list[tuple[float, Quantity]]]]:
    """By polydispersity: means over realizations by friction; frictions with fewer than three are left out."""
    study: xr.DataArray = data.get("network", "statistics")[name].sel(state=state)
    found = []
    for delta in study["polydispersity"].values.tolist():
        each = {mu: study.sel(polydispersity=delta, friction=mu).values for mu in study["friction"].values.tolist()}
        known = {mu: values for mu, values in each.items() if np.isfinite(values).sum() >= 3}
        found.append((f"δ = {delta:g}", [(mu, over_realizations(values, np.mean)) for mu, values in known.items()]))
    return found


def tail(data: Data) -> Numbers:  # B11
    for state in ("rest", "loaded"):
        for delta, means in _means(data, "tail_variation", state):
            yield from ((Case(f"{delta}, {state}", f"{mu:g}"), found) for mu, found in means)


def coordination(data: Data) -> Numbers:
    """B12: at the least friction and at the largest."""
    for delta, means in _means(data, "coordination_number", "rest"):
        (least, without), *_, (largest, full) = means
        yield Case(delta, f"{least:g}"), without, None
        yield Case(delta, f"{largest:g}"), None, full


def isostaticity(data: Data) -> Numbers:  # B13
    for delta, means in _means(data, "hyperstaticity", "rest"):
        yield from ((Case(delta, f"{mu:g}"), found) for mu, found in means if mu > 0.0)
