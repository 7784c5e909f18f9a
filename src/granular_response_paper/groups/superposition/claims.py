"""Claims U1, U3 and U4: two loads at once (Sec. VI.B)."""

from __future__ import annotations

from ...claims.bootstrap import over_realizations, part_of
from ...claims.bounds import lower_by, more_than
from ...claims.claim import SLAB, Ask, Claims, Data, Numbers, at
from ...claims.numbers import needs

GROUP = "superposition"
claim = Claims(GROUP, {**SLAB, "scene.contact.friction": 0.05, "scene.packing.polydispersity": 0.01}, disorder=True)

#: Errors by what they are of.
ERRORS = {"floor forces": "floor_error_largest", "all contact forces": "contact_error_largest"}


def _hold(data: Data, force: float, word: str) -> Numbers:
    """The packings in which no error at any distance is larger than the threshold of the word."""
    study = at(data.get(GROUP, "errors"), force=force)
    for case, name in ERRORS.items():
        errors = study[name]
        needs(errors.notnull().all(), f"errors holds packings without {name}")
        yield case, part_of(errors.max("distance") <= data.words[word])


@claim("U1", "VI.B, Fig. 23",
       Ask("packings in which sum and whole differ by a twentieth at most", more_than(0.5, "holds"), "part"),
       primary="floor forces")  # fmt: skip
def holds(data: Data) -> Numbers:
    """As shown in Fig. 23, superposition holds even on the microscopic scale, i.e., for individual forces without
    coarse graining.
    Short: Superposition holds for individual forces
    Here: In the paper's test, floor forces at 0.2 mg, superposition holds within 5 % in {0} of the packings. For all
    contact forces it holds in {all contact forces|0}.
    Remark: The text calls the packing of Fig. 23 typical, so that it must hold in most. At all distances of the
    loads"""
    yield from _hold(data, 0.2, "holds")


@claim("U3", "VI.B, Fig. 24",
       Ask("packings in which sum and whole differ by a fifth at most", more_than(0.5, "quite well"), "part"),
       primary="floor forces")  # fmt: skip
def quite_well(data: Data) -> Numbers:
    """Interestingly, we find that superposition holds quite well even beyond the linear regime, as shown in Fig. 24
    (for F_ext = mg).
    Short: It holds quite well beyond the linear range
    Here: At 1 mg superposition holds within a fifth for the floor forces in {0} of the packings, and for all contact
    forces in {all contact forces|0}.
    Remark: It must hold in most packings. At all distances of the loads"""
    yield from _hold(data, 1.0, "quite well")


@claim("U4", "VI.B, VIII", Ask("rms deviation in the deepest row per the largest of any row", lower_by("marked"), "%"),
       primary="loads 2 apart", figures=[24])  # fmt: skip
def falls_with_depth(data: Data) -> Numbers:
    """The validity of superposition beyond the linear elastic regime indicates that sufficiently far from the applied
    load, the system responds (nearly) elastically even though it is not elastic everywhere.
    Short: Superposition holds far from the loads
    Here: At 1 mg and for the nearest loads, the deviation from superposition in the deepest row is {0} of the largest
    in any row.
    Remark: Each deviation is per force in its row. It falls with the distance of the loads from each other far more
    than with the depth below them"""
    study = at(data.get(GROUP, "errors"), force=1.0).sortby("gap")
    error = study["row_error"].transpose("distance", "realization", "gap").values
    needs(error.shape[2] > 1, "errors holds one depth")
    for distance, one in zip(study["distance"].values.tolist(), error, strict=True):
        yield f"loads {distance:g} apart", over_realizations(one[:, -1] / one.max(axis=1))
