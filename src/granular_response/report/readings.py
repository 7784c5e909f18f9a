"""How much each reading of the paper matters: the stored sensitivities as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr


def table(datasets: Mapping[str, xr.Dataset]) -> list[dict[str, str]]:
    """Rows ``case``, ``text`` and ``difference`` from every dataset with variants and their largest difference."""
    rows = []
    for case, dataset in datasets.items():
        if not {"text", "largest_difference"} <= set(dataset.variables):
            continue
        texts, values = dataset["text"].values, dataset["largest_difference"].values
        for name, text, value in zip(dataset["variant"].values, texts, values, strict=True):
            if str(name) != "reference":
                rows.append({"case": case.replace("_", " "), "text": str(text), "difference": f"{float(value):.1e}"})
    return rows
