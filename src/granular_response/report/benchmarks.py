"""Stored benchmark metrics as small tables."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def tables(folder: Path) -> list[dict[str, Any]]:
    """One table for each list of records in each ``folder/*.json``: name, columns, rows; scalars as notes."""
    found = []
    for path in sorted(folder.glob("*.json")):
        try:
            metrics = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if not isinstance(metrics, dict):
            continue
        notes = [f"{_words(k)}: {_cell(v)}" for k, v in metrics.items() if isinstance(v, (str, int, float))]
        for name, records in metrics.items():
            if isinstance(records, list) and records and all(isinstance(record, dict) for record in records):
                columns = list(dict.fromkeys(key for record in records for key in record))
                columns = [c for c in columns if not any(isinstance(r.get(c), (list, dict)) for r in records)]
                rows = [[_cell(record.get(column)) for column in columns] for record in records]
                title = f"{_words(path.stem)}, {_words(name)}"
                found.append({"title": title, "notes": notes, "columns": [_words(c) for c in columns], "rows": rows})
    return found


def _words(name: str) -> str:
    return str(name).replace("_", " ")


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.3g}"
    return str(value)
