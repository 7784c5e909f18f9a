"""Claims B11 to B13, beyond the paper: contact networks against what granular packings are known for (Sec. VI)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims import asked
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "network"
CLAIMS = Claims(GROUP)
#: Contacts per disk at which forces follow from balance alone, in two dimensions.
FRICTIONLESS, FRICTIONAL = 4.0, 3.0


@CLAIMS.measures("B11")
def tail(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "statistics")
    readings = [
        Reading(
            f"δ = {delta:g}, {'at rest' if state == 'rest' else 'under the load'}",
            *(
                asked.near(f"friction {mu:g}", quantity, words, "quite well")
                for mu, quantity in _by_friction(study["tail_variation"].sel(polydispersity=delta, state=state))
            ),
        )
        for state in study["state"].values.tolist()
        for delta in study["polydispersity"].values.tolist()
    ]
    found = [condition.found.value for reading in readings for condition in reading.conditions]
    return Finding(
        f"the coefficient of variation is {min(found):.2f} to {max(found):.2f}; 1 for an exponential", readings
    )


@CLAIMS.measures("B12")
def coordination(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "statistics").sel(state="rest")
    readings, numbers = [], []
    for delta in study["polydispersity"].values.tolist():
        each = _by_friction(study["coordination_number"].sel(polydispersity=delta))
        (_, without), (largest, rough) = each[0], each[-1]
        numbers.append(f"{without.value:.2f} to {rough.value:.2f} (δ = {delta:g})")
        readings.append(
            Reading(
                f"δ = {delta:g}",
                asked.near("friction 0", without, words, "nearly", FRICTIONLESS),
                asked.near(f"friction {largest:g}", rough, words, "nearly", FRICTIONAL),
            )
        )
    return Finding(f"contacts per disk from no friction to the largest: {', '.join(numbers)}", readings)


@CLAIMS.measures("B13")
def isostaticity(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "statistics").sel(state="rest")
    readings, found = [], []
    for delta in study["polydispersity"].values.tolist():
        conditions: list[Condition] = []
        for mu, quantity in _by_friction(study["hyperstaticity"].sel(polydispersity=delta)):
            if mu > 0.0:
                conditions.append(asked.at_most(f"friction {mu:g}", quantity, words, "nearly", "%"))
                found.append(quantity.value)
        readings.append(Reading(f"δ = {delta:g}", *conditions))
    return Finding(
        f"with friction there are {min(found):.0%} to {max(found):.0%} more force components than equations", readings
    )


def _by_friction(values: xr.DataArray) -> list[tuple[float, Quantity]]:
    """Means over realizations, by friction; frictions with fewer than three are left out."""
    found = []
    for mu in values["friction"].values.tolist():
        each = values.sel(friction=mu).values
        if np.isfinite(each).sum() >= 3:
            found.append((mu, over_realizations(each, np.mean)))
    return found
