"""How much each reading of the paper matters: the stored sensitivities as a table for the notes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import resources
from typing import Any

import xarray as xr

from granular_response.scene import text

from ..claims.numbers import digits
from . import markdown as tables

#: Where the paper leaves a choice: ``question``, ``choice`` and another ``option``, by the variant that tries the
#: latter; the order is that of the table.
READINGS: Mapping[str, Mapping[str, str]] = text.read(
    resources.files(__package__).joinpath("readings.yaml").read_text("utf-8")
)


def _columns(datasets: Mapping[str, xr.Dataset], name: str) -> dict[str, dict[str, Any]]:
    """For each dataset of the study that holds it, a variable by variant, without the reference."""
    found = {}
    for slab, data in datasets.items():
        if set(data.variables) >= {name, "text", "largest_difference"}:
            pairs = zip(data["variant"].values.tolist(), data[name].values.tolist(), strict=True)
            found[slab] = {str(variant): value for variant, value in pairs if str(variant) != "reference"}
    return found


def markdown(datasets: Mapping[str, xr.Dataset]) -> str:
    """The readings that the datasets of the study ``sensitivity`` hold as a table in Markdown, and below it what else
    the notes quote of the study. Equal data give equal text.

    Each reading has the largest difference of the floor response in each slab, empty where it was not tried. A variant
    that has no words here is shown with those of the study.
    """
    changes = _columns(datasets, "largest_difference")
    words = {variant: str(text) for column in _columns(datasets, "text").values() for variant, text in column.items()}
    slabs = [name.replace("mu_", "µ = ") for name in changes]
    heads = ["interpretation", "choice", "other option", *(f"change, {slab}" for slab in slabs)]
    rows, before = [], ""
    for variant in sorted(words, key=[*READINGS, *words].index):
        reading = READINGS.get(variant, {"question": words[variant], "choice": "", "option": ""})
        differences = [digits(column[variant], 2) if variant in column else "" for column in changes.values()]
        said = ("", "") if reading["question"] == before else (reading["question"], reading["choice"])
        rows.append([*said, reading["option"], *differences])
        before = reading["question"]
    quoted = []
    for variant, name, form, what in _QUOTED:
        values = [form(column[variant]) for column in _columns(datasets, name).values() if variant in column]
        if values:
            quoted.append(f"* {what}: {', '.join(values)} ({', '.join(slabs)})")
    return "\n".join([tables.table(heads, rows), *([""] if quoted else []), *quoted])


#: What else the notes speak of: variant, variable, how it is written, in words.
_QUOTED: tuple[tuple[str, str, Callable[[float], str], str], ...] = (
    ("stop_1e-9", "response_sum", "{:.4f}".format, "Sum of the response, stopped at 1e-9 per disk"),
    ("no_static_finish", "response_sum", "{:.4f}".format, "Sum of the response, stopped at 1e-13 per disk"),
    ("literal_friction", "kinetic_energy", partial(digits, number=2), "Kinetic energy per disk at the end, friction "
     "law as printed"),
)  # fmt: skip
