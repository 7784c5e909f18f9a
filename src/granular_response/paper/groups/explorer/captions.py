"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, Caption

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "explorer": Caption(
            "Not in the paper: response at x = 0 of the slabs of the explorer that no other figure shows. (a) Ordered "
            "slabs with a small k_T/k_N, and (b) single disordered slabs, smoothed with "
            f"w = {parameters.width:g} {RADIUS}, up to the last force before they collapse.",
            "Two plots of the response at x = 0 against the force, a curve for each slab.",
        )
    }
