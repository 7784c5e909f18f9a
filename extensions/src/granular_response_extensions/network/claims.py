"""Claims B11 to B13, beyond the paper: contact networks against what granular packings are known for (Sec. VI)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)

#: Contacts per disk at which forces follow from balance alone, in two dimensions.
FRICTIONLESS, FRICTIONAL = 4.0, 3.0


def _means(data: Data, name: str, state: str) -> Iterator[tuple[str, list[tuple[float, Quantity]]]]:
    """By polydispersity: means over realizations by friction; frictions with fewer than three are left out."""
    study: xr.DataArray = data.get("network", "statistics")[name].sel(state=state)
    for delta in study["polydispersity"].values.tolist():
        each = {mu: study.sel(polydispersity=delta, friction=mu).values for mu in study["friction"].values.tolist()}
        known = {mu: values for mu, values in each.items() if np.isfinite(values).sum() >= 3}
        yield f"δ = {delta:g}", [(mu, over_realizations(values, np.mean)) for mu, values in known.items()]


@CLAIMS.measures("B11")
def tail(data: Data, words: Words) -> list[Test]:
    return [
        Test(f"coefficient of variation, friction {mu:g}", found, bounds.near(words, "quite well"), f"{delta}, {state}")
        for state in ("rest", "loaded")
        for delta, means in _means(data, "tail_variation", state)
        for mu, found in means
    ]


@CLAIMS.measures("B12")
def coordination(data: Data, words: Words) -> list[Test]:
    tests = []
    for delta, means in _means(data, "coordination_number", "rest"):
        for (mu, found), isostatic in ((means[0], FRICTIONLESS), (means[-1], FRICTIONAL)):
            tests.append(
                Test(f"contacts per disk, friction {mu:g}", found, bounds.near(words, "nearly", isostatic), delta)
            )
    return tests


@CLAIMS.measures("B13")
def isostaticity(data: Data, words: Words) -> list[Test]:
    return [
        Test(f"components beyond equations, friction {mu:g}", found, bounds.at_most(words, "nearly"), delta, "%")
        for delta, means in _means(data, "hyperstaticity", "rest")
        for mu, found in means
        if mu > 0.0
    ]
