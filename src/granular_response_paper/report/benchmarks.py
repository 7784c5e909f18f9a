"""Stored benchmark metrics: goals, pictures and tables."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granular_response.inputs import read_json

from . import pictures

#: Goals beside what was measured, by ``benchmarks/document.py``; and their picture folder.
SUMMARY, PICTURES = "summary", "figures"

#: What the pictures show, by stem.
CAPTIONS = {
    "arena": "Microseconds per step on one core, ours and those of other codes.",
    "bounces": "Energy that a disk keeps when it bounces off a wall with friction, by angle, ours and by other codes.",
    "convergence": "Dynamics approaches the load path like one over the ramp time.",
    "depth": "Depth and width of the region of contacts that a load opens without friction, in slabs up to 240 layers "
    "deep; open symbols: it has reached the floor.",
    "kernel": "Disks times time steps per second on one core.",
    "linear": "Factorisations of the tangent stiffness of slabs at rest, ours beside those of libraries.",
    "precision": "Run time against the error of the floor response. Open symbols of integrators: without the static "
    "finish.",
    "responses": "Processor time against the error of the floor response of 908 disks, ours and by other codes.",
    "scale": "Time and memory of whole runs against the number of disks.",
    "skipping": "What a scene pays if a part that it does not need is forced on.",
    "trajectory": "Error of trajectories against the time step.",
}


@dataclass(frozen=True)
class Benchmark:
    """One benchmark: its picture, if one is drawn, and its records as tables of ``notes``, ``columns``, ``rows``."""

    title: str
    caption: str
    picture: pictures.Picture | None
    tables: list[dict[str, Any]]


def collect(folder: Path) -> list[Benchmark]:
    """One for each ``folder/*.json`` with records, apart from the summary."""
    found = []
    for path in sorted(folder.glob("*.json")):
        drawn = folder / PICTURES / f"{path.stem}.png"
        records = [] if path.stem == SUMMARY else tables(path)
        if records:
            picture = pictures.embed(drawn) if drawn.exists() else None
            found.append(Benchmark(_words(path.stem).capitalize(), CAPTIONS.get(path.stem, ""), picture, records))
    return found


def goals(folder: Path) -> list[dict[str, Any]]:
    """Records ``what``, ``goal``, ``measured``, ``met`` of the summary, none without one."""
    found = _read(folder / f"{SUMMARY}.json").get("goals")
    return found if isinstance(found, list) else []


def tables(path: Path) -> list[dict[str, Any]]:
    """One table for each list of records in a file: title, columns, rows; scalars as notes."""
    metrics = _read(path)
    found = []
    notes = [f"{_words(k)}: {_cell(v)}" for k, v in metrics.items() if isinstance(v, (str, int, float))]
    for name, records in metrics.items():
        if isinstance(records, list) and records and all(isinstance(record, dict) for record in records):
            columns = list(dict.fromkeys(key for record in records for key in record))
            columns = [c for c in columns if not any(isinstance(r.get(c), (list, dict)) for r in records)]
            rows = [[_cell(record.get(column)) for column in columns] for record in records]
            found.append({"title": _words(name), "notes": notes, "columns": [_words(c) for c in columns], "rows": rows})
    return found


def _read(path: Path) -> dict[str, Any]:
    try:
        metrics = read_json(path)
    except (OSError, ValueError):
        return {}
    return metrics if isinstance(metrics, dict) else {}


def _words(name: str) -> str:
    return str(name).replace("_", " ")


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.3g}"
    return str(value)
