"""From datasets to a few numbers: what ``dvc metrics`` and ``dvc exp show`` compare of one group, alone.

The table of claims needs every group; this reads one. So what stands here of a claim is what this group's own datasets
say, in the reading that this project uses: how other groups bear on it is in the table.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from granular_response.store import atomic
from granular_response_paper.claims.claim import Claim, Data, rounded
from granular_response_paper.claims.verdict import judge
from granular_response_paper.pipeline import TOO_LITTLE, GroupError, group_member, stored

#: Datasets of a group to numbers by name.
Numbers = Callable[[Mapping[str, xr.Dataset]], Mapping[str, float]]

#: Where the numbers of every group are kept.
FOLDER = Path("figures") / "metrics"


def measure(group: str, data: Path | None = None, output: Path | None = None) -> Path:
    """Write the numbers of a group as JSON; returns the path of the file.

    ``claims`` maps each claim of the group to its number in the first reading with the ends of its interval, and to
    what becomes of it there: holds, fails, open or not measured, also where the datasets hold too little for it.
    ``numbers`` are those of the group's ``numbers.py``.

    Raises
    ------
    GroupError
        If there is no such group, it has neither claims nor numbers, or the datasets are those of another one.
    granular_response.store.files.StoreError
        If its datasets cannot be read.
    OSError
        If the output cannot be written.
    """
    claims, numbers = contents(group)
    if claims is None and numbers is None:
        raise GroupError(f"{group}: has neither claims.py nor numbers.py, so there is nothing to measure")
    path, datasets = stored.datasets(group, data)
    found: dict[str, Any] = {}
    if claims is not None:
        found["claims"] = {claim.id: _claim(claim, group, datasets) for claim in claims}
    if numbers is not None:
        try:
            found["numbers"] = {name: rounded(value) for name, value in numbers(datasets).items()}
        except TOO_LITTLE as error:
            problem = " ".join(f"{type(error).__name__}: {error}".split())
            raise GroupError(f"{path}: the numbers of {group} cannot be measured ({problem})") from error
    target = output or FOLDER / f"{group}.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    atomic.check_output(target, [path])
    atomic.write_bytes(target, (json.dumps(found, indent=1) + "\n").encode())
    return target


def contents(group: str) -> tuple[Sequence[Claim] | None, Numbers | None]:
    """The claims of a group and the function that measures its further numbers, as far as it has them."""
    return _member(group, "claims", "CLAIMS"), _member(group, "numbers", "numbers")


def _member(group: str, module: str, name: str) -> Any:
    """What a module calls ``name``; None if the group has no such module."""
    try:
        return group_member(group, module, name)
    except ModuleNotFoundError as error:
        if error.name != f"granular_response_paper.groups.{group}.{module}":
            raise
        return None


def _claim(claim: Claim, group: str, datasets: Mapping[str, xr.Dataset]) -> dict[str, Any]:
    try:
        finding = judge(claim, Data({group: datasets})).finding
    except TOO_LITTLE:  # the table of claims, which has all datasets, is not as lenient
        finding = None
    if finding is None:
        return {"outcome": "not measured"}
    reading = finding.readings[0]
    found = reading.conditions[0].found
    values = {"value": found.value, "low": found.low, "high": found.high}
    return {"outcome": reading.outcome, **{name: rounded(value) for name, value in values.items()}}
