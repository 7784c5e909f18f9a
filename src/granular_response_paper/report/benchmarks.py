"""Stored benchmark metrics: goals and pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from granular_response.inputs import read_json

from . import pictures

#: Goals beside what was measured, by ``benchmarks/document.py``; and the folder of pictures.
SUMMARY, PICTURES = "summary", "figures"

#: What each picture is about and what it shows, by stem.
CAPTIONS = {
    "arena": ("Comparison with other codes", "Microseconds per step on one core."),
    "bounces": (
        "Single collisions",
        "Energy that a disk keeps when it bounces off a wall with friction, by angle, ours and by other codes.",
    ),
    "convergence": ("Dynamics and path", "Dynamics approaches the load path like one over the ramp time."),
    "depth": (
        "Deep slabs",
        "Depth and width of the region of contacts that a load opens without friction, in slabs up to 240 layers deep; "
        "open symbols: it has reached the floor.",
    ),
    "kernel": ("Kernel", "Disks times time steps per second on one core."),
    "linear": (
        "Factorizations",
        "Factorisations of the tangent stiffness of slabs at rest, ours beside those of libraries.",
    ),
    "precision": (
        "Precision",
        "Run time against the error of the floor response. Open symbols of integrators: without the static finish.",
    ),
    "responses": (
        "Responses by other codes",
        "Processor time against the error of the floor response of 908 disks, ours and by other codes.",
    ),
    "scale": ("Large packings", "Time and memory of whole runs against the number of disks."),
    "skipping": ("Work that is skipped", "What a scene pays if a part that it does not need is forced on."),
    "trajectory": ("Trajectories", "Error of trajectories against the time step."),
}


@dataclass(frozen=True)
class Benchmark:
    """One benchmark that is drawn."""

    title: str
    caption: str
    picture: pictures.Picture


def collect(folder: Path, page: Path, *, embedded: bool = False) -> list[Benchmark]:
    """One for each ``folder/figures/*.png``, as the page in a folder shows it."""
    found = []
    for drawn in sorted((folder / PICTURES).glob("*.png")):
        title, caption = CAPTIONS.get(drawn.stem, (drawn.stem.replace("_", " ").capitalize(), ""))
        found.append(
            Benchmark(title, caption, replace(pictures.shown(drawn, page, embedded=embedded), alternative=caption))
        )
    return found


def goals(folder: Path) -> list[dict[str, Any]]:
    """Records ``what``, ``goal``, ``measured``, ``met`` of the summary, none without one."""
    try:
        found = read_json(folder / f"{SUMMARY}.json")["goals"]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    return found if isinstance(found, list) else []
