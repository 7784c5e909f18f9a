"""Claims U1 to U4: two loads at once (Sec. VI.B)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bootstrap import over_realizations, part_of
from granular_response_paper.claims.claim import Case, Data, Numbers, at, needs

GROUP = "superposition"

#: The paper's linear range, and errors by what they are of.
LINEAR = 0.4
ERRORS = {"floor forces": "floor_error_largest", "all contact forces": "contact_error_largest"}


def superposition(data: Data, force: float, word: str) -> Numbers:
    """U1, U3: packings in which no error at any distance is larger."""
    study = at(data.get(GROUP, "errors"), force=force)
    for case, name in ERRORS.items():
        yield case, part_of(study[name].max("distance") <= data.words[word])


def linear_range(data: Data) -> Numbers:
    """U2: ends below the largest and above the smallest force that is about the paper's."""
    study = data.get(GROUP, "linear_range")
    until, beyond = study["linear_until"].values, study["nonlinear_from"].values
    # a path that does not end is beyond all others
    ends = np.where(np.isfinite(beyond), 0.5 * (until + beyond), np.inf)
    low, high = ((1.0 + sign * data.words["about"]) * LINEAR for sign in (-1.0, 1.0))
    yield Case(of=f"{high:g}"), part_of(ends < high), None
    yield Case(of=f"{low:g}"), None, part_of(ends > low)


def falls_with_depth(data: Data) -> Numbers:  # U4
    study = at(data.get(GROUP, "errors"), force=1.0).sortby("gap")
    error = study["row_error"].transpose("distance", "realization", "gap").values
    needs(error.shape[2] > 1, "errors holds one depth")
    for distance, one in zip(study["distance"].values.tolist(), error, strict=True):
        yield f"loads {distance:g} apart", over_realizations(one[:, -1] / one.max(axis=1))
