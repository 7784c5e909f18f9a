"""Claims B11 to B13, beyond the paper: contact networks against what granular packings are known for (Sec. VI)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby, product
from operator import itemgetter

import numpy as np

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Case, Data, Numbers, Quantity


def _means(data: Data, name: str, state: str) -> Iterator[tuple[str, float, Quantity]]:
    """By polydispersity and friction: means over realizations, where there are three or more."""
    study = data.get("network", "statistics")[name].sel(state=state)
    for delta, mu in product(study["polydispersity"].values, study["friction"].values):
        values = study.sel(polydispersity=delta, friction=mu).values
        if np.isfinite(values).sum() >= 3:
            yield f"δ = {delta:g}", mu, over_realizations(values, np.mean)


def tail(data: Data) -> Numbers:  # B11
    for state in ("rest", "loaded"):
        for delta, mu, found in _means(data, "tail_variation", state):
            yield Case(f"{delta}, {state}", f"{mu:g}"), found


def coordination(data: Data) -> Numbers:
    """B12: at the least friction and at the largest."""
    for delta, means in groupby(_means(data, "coordination_number", "rest"), key=itemgetter(0)):
        (_, least, without), *_, (_, largest, full) = means
        yield Case(delta, f"{least:g}"), without, None
        yield Case(delta, f"{largest:g}"), None, full


def isostaticity(data: Data) -> Numbers:  # B13
    for delta, mu, found in _means(data, "hyperstaticity", "rest"):
        if mu > 0.0:
            yield Case(delta, f"{mu:g}"), found
