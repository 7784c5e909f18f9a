"""Claims K2 and K3: algebra of the spring model (Sec. V.C), which no simulation can fail."""

from __future__ import annotations

from ...claims import asked
from ...claims.claim import Claims, Condition, Data, Finding, Quantity
from ...claims.words import Bounds

GROUP = "theory"
CLAIMS = Claims(GROUP)


@CLAIMS.measures("K2")
def root(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "peak_criterion")
    roots = dict(zip(study["rotations"].values.tolist(), study["root"].values.tolist(), strict=True))
    return asked.one_reading(
        f"{roots['suppressed']:.6f}; with disks free to turn {roots['free']:.4f} (3/11)",
        "rotations suppressed, as in eq. (5)",
        Condition("root", Quantity.exact(roots["suppressed"]), 0.29145, 0.29155),
    )


@CLAIMS.measures("K3")
def moduli(data: Data, words: Bounds) -> Finding:
    study = data.get(GROUP, "moduli")
    error = study.sel(rotations="suppressed")["error"].values
    return asked.one_reading(
        f"largest difference {error.max():.1e} of the largest modulus, {error.size} lattices",
        "rotations suppressed, as in eq. (5)",
        Condition("largest difference per largest modulus", Quantity.exact(error.max()), most=1e-10),
    )
