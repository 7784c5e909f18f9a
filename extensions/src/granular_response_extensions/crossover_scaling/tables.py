"""The exponents of all series of layers, for the documents."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr

from granular_response.state import FloatArray
from granular_response_paper.report.markdown import table

CONFINED = {"constant": "constant", "walls": "the paper's walls", "as weight": "proportional to weight"}


def markdown(datasets: Mapping[str, xr.Dataset]) -> str:
    """A line for each series of layers of the group ``crossover_scaling``: powers, and what they lead to."""
    slabs, powers = datasets["slabs"], datasets["powers"]
    far = f"two peaks at {powers.attrs['layers']:g} layers, extrapolated"
    heads = [
        "friction, lateral prestress",
        "layers",
        "two peaks: exponent of N",
        "region at the floor",
        "first opening",
        far,
    ]
    rows = []
    for series in np.flatnonzero(powers["varied"].values == "layers"):
        one = powers.isel(series=series)
        here = slabs["series"].values == str(one["series"].values)
        layers, stored = slabs["layers"].values[here], slabs["surveyed"].values[here] > 0
        deep = f", from {layers[stored].min()} on survey data" if stored.any() else ""
        cells = [
            f"{float(one['friction']):g}, {CONFINED[str(one['confined'].values)]}",
            f"{layers.min()} to {layers.max()}{deep}",
            *(
                _with_ends(one["exponent"].sel(event=event).values, lambda value: f"{round(value, 2) + 0.0:.2f}")
                for event in ("crossover", "reaches_floor", "first_opening")
            ),
            _with_ends(one["extrapolated"].sel(event="crossover").values, lambda value: f"{float(f'{value:.2g}'):,.0f}")
            + " mg",
        ]
        rows.append(cells)
    return table(heads, rows)


def _with_ends(values: FloatArray, said: Callable[[float], str]) -> str:
    """A number and the ends of its interval."""
    value, least, largest = (said(float(number)) for number in values)
    return f"{value} ({least} to {largest})".replace("-", "\N{MINUS SIGN}")
