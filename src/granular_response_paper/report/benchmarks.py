"""Stored benchmark metrics: goals and pictures."""

from __future__ import annotations

from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

from granular_response.inputs import read_json
from granular_response.scene import text

from . import pictures

#: Goals beside what was measured, by ``benchmarks/document.py``; and the folder of pictures.
SUMMARY, PICTURES = "summary", "figures"


def collect(folder: Path, page: Path, *, embedded: bool = False) -> list[dict[str, Any]]:
    """Records ``title``, ``caption``, ``picture`` for each ``folder/figures/*.png``, as a page in a folder shows it."""
    found, captions = [], text.read(resources.files(__package__).joinpath("benchmarks.yaml").read_text("utf-8"))
    for drawn in sorted((folder / PICTURES).glob("*.png")):
        said = captions.get(drawn.stem, {"title": drawn.stem.replace("_", " ").capitalize(), "caption": ""})
        picture = replace(pictures.shown(drawn, page, embedded=embedded), alternative=said["caption"])
        found.append({**said, "picture": picture})
    return found


def goals(folder: Path) -> list[dict[str, Any]]:
    """Records ``what``, ``goal``, ``measured``, ``met`` of the summary, none without one."""
    try:
        found = read_json(folder / f"{SUMMARY}.json")["goals"]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    return found if isinstance(found, list) else []
