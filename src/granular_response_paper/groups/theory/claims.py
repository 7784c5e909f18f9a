"""Claims K2 and K3: the spring model without horizontal springs (Sec. V.C)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bounds import at_most, between
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers

claim = Claims("theory")


@claim(
    "K2", "V.C", Ask("root of r(β) without horizontal springs", between(0.29145, 0.29155), "", 0.2915),
    figures=[10, 11], row="derivation"
)  # fmt: skip
def root(data: Data) -> Numbers:
    """Hence (in the physically relevant range β > 0), two peaks are expected for β ≲ 0.2915, which is consistent with
    the value k_T/k_N ≃ 0.3 obtained in the simulation (Fig. 10).
    Short: The criterion has its root at 0.2915
    Here: Without horizontal springs the criterion r changes its sign at k_T/k_N = {0:4}.
    Remark: Eq. (5) keeps the disks from turning; the paper's disks turn"""
    yield data.value("theory", "peak_criterion.root", rotations="suppressed")


@claim(
    "K3", "V.C, eqs. (7)-(10)", Ask("largest difference per largest modulus", at_most(1e-10)), figures=[11],
    row="derivation"
)  # fmt: skip
def moduli(data: Data) -> Numbers:
    """In order to obtain the elastic moduli corresponding to the continuum limit of the considered system, an affine
    deformation (which is appropriate for a lattice configuration) is defined by a symmetric, uniform strain field.
    Short: Moduli of the spring model
    Here: The four moduli agree with those measured on a periodic lattice, strained and relaxed, to {0} of the largest
    modulus.
    Remark: Eq. (6) as printed gives shear half its energy; its d is twice that of eq. (10), which the root uses"""
    yield data.value("theory", "moduli.error", np.max, rotations="suppressed")
