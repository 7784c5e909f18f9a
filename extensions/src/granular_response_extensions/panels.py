"""What figures of several groups repeat beyond those of the paper."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from granular_response.plot import style
from granular_response_paper.panels import family, material

#: Lines to compare curves with, behind these.
GUIDE: dict[str, Any] = {"color": style.BLACK, "linewidth": 0.9, "zorder": 0.5}


def materials(polydispersity: ArrayLike, friction: ArrayLike) -> list[tuple[str, dict[str, Any]]]:
    """Name and look of each of some materials (m,): colour by the polydispersity, marker and dashes by the friction."""
    spreads, frictions = (np.asarray(values, dtype=float).tolist() for values in (polydispersity, friction))
    colours = dict(family(sorted(set(spreads)), of="polydispersity"))
    dashes = dict(family(sorted(set(frictions)), of="friction", dashed=True))
    return [
        (material(delta, mu), dashes[mu] | {"color": colours[delta]["color"]})
        for delta, mu in zip(spreads, frictions, strict=True)
    ]
