"""Claims B4, B5 and B27 to B29, beyond the paper: packings as elastic slabs, slabs under load as incrementally elastic.

See Secs. I, IV, V.C and VIII.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Measure, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

CLAIMS = Claims(__package__)


def described(solid: str) -> Measure:
    """In the highest packings of each case."""

    def measure(data: Data, words: Words) -> list[Test]:
        study, tests = data.get("moduli", "packings"), []
        for case in range(study.sizes["case"]):
            one = study.isel(case=case, size=int(np.nanargmax(study["layers"].values[case])), smoothing=0)
            found = over_realizations(one["difference"].sel(solid=solid).values, np.mean)
            what, name = (
                f"largest difference to the {solid} slab",
                f"{bounds.material(one)}, {float(one['layers']):g} layers",
            )
            tests.append(Test(what, found, bounds.at_most(words, "nearly"), name, "%"))
        return tests

    return measure


CLAIMS.measures("B4")(described("free"))
CLAIMS.measures("B5")(described("isotropic"))


def _slabs(data: Data) -> dict[str, xr.Dataset]:
    """Slabs by friction, without steps that are not there."""
    found = data.get("moduli", "slabs")
    known = np.isfinite(found["force"].values)
    return {f"friction {float(mu):g}": found.isel(slab=k, step=known[k]) for k, mu in enumerate(found["friction"])}


def _crossover(slab: xr.Dataset) -> Quantity:
    return Quantity.bracket(*slab["crossover"].values)


@CLAIMS.measures("B27")
def reach(data: Data, words: Words) -> list[Test]:
    tests = []
    for name, slab in _slabs(data).items():
        crossover, reached = _crossover(slab), slab["reach"].values.reshape(slab.sizes["step"], -1) >= 1.0
        if crossover.happens and reached[-1].all():
            force = slab["force"].values
            first = reached.argmax(axis=0)
            CLAIMS.needs(bool((first > 0).all()), f"{name}: the region of r < 0 reaches the floor at the first force")
            ends = np.concatenate([force[first - 1], force[first]])
            found = Quantity.range(ends, float(ends.mean())).per(crossover)
            tests.append(Test("force per crossover force", found, bounds.near(words, "about"), name))
    CLAIMS.needs(tests, "slabs holds no region of r < 0 that reaches the floor beside a crossover")
    return tests


@CLAIMS.measures("B28")
def incrementally_elastic(data: Data, words: Words) -> list[Test]:
    tests = []
    for name, slab in _slabs(data).items():
        crossover, force = _crossover(slab), slab["force"].values
        below = force <= crossover.low
        parts = {"up to the crossover": below, "beyond it": ~below} if crossover.happens else {"one peak": below}
        for part, inside in parts.items():
            for k, width in enumerate(slab["width"].values.tolist()) if inside.any() else ():
                largest = slab["difference"].isel(width=k).values[inside].max(axis=0)
                case = f"{name}, {part}, averages over {width:g} R"
                found = Quantity.range(largest.ravel(), float("nan"))
                tests.append(Test("difference per largest response", found, bounds.at_most(words, "nearly"), case, "%"))
    return sorted(tests, key=lambda test: not test.case.startswith("friction 0.2, up"))


@CLAIMS.measures("B29")
def peaks(data: Data, words: Words) -> list[Test]:
    tests = []
    for name, slab in _slabs(data).items():
        wrong = (slab["predicted_two_peaks"] != slab["two_peaks"]).sum("step")
        found, case = Quantity.range(wrong.values.ravel()), f"{name}, {slab.sizes['step']} forces"
        tests.append(Test("forces with another number of peaks", found, bounds.NONE, case))
    return tests
