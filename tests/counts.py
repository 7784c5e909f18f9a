"""Counts of the outcomes of many trials, stored with what repeats them: number, seed, code and versions."""

from __future__ import annotations

import argparse
import json
import platform
from collections import Counter
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path

from granular_response import __version__
from granular_response.inputs import read_json
from granular_response.store import atomic
from granular_response.sweeps.keys import sources


def arguments(what: str, seed: int) -> argparse.Namespace:
    """``number``, ``seed`` and ``output`` of a command that tries as many as it is asked to."""
    parser = argparse.ArgumentParser(description=what)
    parser.add_argument("number", type=int, help="how many to try")
    parser.add_argument("--seed", type=int, default=seed, help="the same ones for the same seed")
    parser.add_argument("--output", type=Path, help="file of the counts (JSON)")
    return parser.parse_args()


def write(path: Path, number: int, seed: int, outcomes: Mapping[str, Mapping[str, int]]) -> None:
    """Write how many of which kind (the keys of ``outcomes``) had which outcome.

    Raises OSError if the file cannot be written.
    """
    versions = {name: metadata.version(name) for name in ("numba", "numpy", "scipy")}
    made = {
        "number": number,
        "seed": seed,
        "outcomes": {kind: dict(sorted(counts.items())) for kind, counts in sorted(outcomes.items())},
        "package_version": __version__,
        "sources": sources("", "granular_response_paper"),
        "versions": {"python": platform.python_version(), **versions},
    }
    atomic.write_bytes(path, (json.dumps(made, indent=1) + "\n").encode())


def totals(path: Path) -> dict[str, int]:
    """How many of all kinds together had which outcome. Raises OSError and ValueError for a file that is not one."""
    return sum(map(Counter, read_json(path)["outcomes"].values()), Counter())
