"""How far each variant of the protocol moves the floor response: no claim of the paper, but what readings rest on."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Largest difference of the floor response from the reference, by variant and friction."""
    return {
        f"{variant}, {name}".replace("_", " ").replace("mu", "friction"): float(difference)
        for name, study in datasets.items()
        for variant, difference in zip(
            study["variant"].values.tolist(), study["largest_difference"].values, strict=True
        )
        if variant != "reference"
    }
