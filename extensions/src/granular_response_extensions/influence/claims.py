"""Claim B1, beyond the paper: St. Venant's principle in packings (Sec. VI)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.bounds import within
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, at
from granular_response_paper.claims.numbers import Quantity

claim = Claims("influence")

#: Polydispersity and friction of the packings; of a lattice there is one.
CASES = ((0.0, 0.0), (0.0, 0.2), (0.01, 0.2), (0.1, 0.2), (0.25, 0.2), (0.1, 0.0))


@claim("B1", "beyond the paper, VI", Ask("exponent of the decay with the distance", within("quite well", 2.0)),
       primary="polydispersity 0, friction 0", source="hypothesis")  # fmt: skip
def decays(data: Data) -> Numbers:
    """This explanation is similar to St. Venant's principle (see, e.g., [95]), which states (for a linear elastic
    system) that the difference in stresses and strains in the interior of an elastic body due to two separate but
    statically equivalent systems of surface tractions (same overall force and torque), are negligible sufficiently far
    from the area where the loads are applied.
    Short: Statically equivalent loads act alike far away in packings too
    Here: In the lattice without friction the difference on the floor decays with the exponent {0}; 2 is that of an
    elastic body.
    Remark: The sentence is a theorem on elastic bodies; that packings follow it is our hypothesis. Small loads on the
    disks of every row, in the initial equilibrium"""
    for delta, mu in CASES:
        study = at(data.get("influence", "saint_venant"), polydispersity=delta, friction=mu)
        exponent = study["exponent"].isel(separation=0).transpose("realization", "fit").values
        fits = Quantity.over(exponent[0].tolist()) if delta == 0.0 else over_realizations(exponent[:, 0], np.mean)
        yield f"polydispersity {delta:g}, friction {mu:g}", fits
