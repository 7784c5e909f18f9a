"""From datasets to a few numbers: what ``dvc metrics`` and ``dvc exp show`` compare of one group, alone.

The table of claims needs every group; this reads one. So what stands here of a claim is what this group's own datasets
say, in the reading that this project uses: how other groups bear on it is in the table.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import xarray as xr

from granular_response.store import atomic
from granular_response_paper import TOO_LITTLE
from granular_response_paper.claims.claim import Claim, Data, rounded
from granular_response_paper.claims.verdict import judge
from granular_response_paper.pipeline import GroupError, group_member, stored

#: Datasets of a group to numbers by name.
Numbers = Callable[[Mapping[str, xr.Dataset]], Mapping[str, float]]

#: Where the numbers of every group are kept.
FOLDER = Path("figures") / "metrics"


def measure(group: str, data: Path | None = None, output: Path | None = None) -> Path:
    """Write the numbers of a group as JSON, each under a name that says what it is; returns the path of the file.

    ``holds``, ``fails``, ``open`` and ``not measured`` list the claims of the group by what becomes of each in its
    first interpretation; then come their numbers there, the lower bound where that is all there is, and those of the
    group's ``numbers.py``.

    Raises GroupError if there is no such group, it has neither claims nor numbers, or the datasets are those of another
    one; StoreError if its datasets cannot be read, OSError if the output cannot be written.
    """
    claims, numbers = contents(group)
    if claims is None and numbers is None:
        raise GroupError(f"{group}: has neither claims.py nor numbers.py, so there is nothing to measure")
    path, datasets = stored.datasets(group, data)
    found = _claims(claims or (), group, datasets)
    if numbers is not None:
        try:
            found |= {name: rounded(value) for name, value in numbers(datasets).items()}
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
    claims = group_member(group, "claims", "CLAIMS", optional=True)
    return claims, group_member(group, "numbers", "numbers", optional=True)


def _claims(claims: Sequence[Claim], group: str, datasets: Mapping[str, xr.Dataset]) -> dict[str, str | float | None]:
    outcomes: dict[str, list[str]] = {"holds": [], "fails": [], "open": [], "not measured": []}
    values = {}
    for claim in claims:
        finding = judge(claim, Data({group: datasets})).finding
        if finding is None:
            outcomes["not measured"].append(claim.id)
            continue
        outcomes[finding.readings[0].outcome].append(claim.id)
        condition = finding.readings[0].conditions[0]
        value = condition.found.value
        values[f"{claim.id} {condition.what}"] = rounded(value if math.isfinite(value) else condition.found.low)
    return {outcome: " ".join(ids) for outcome, ids in outcomes.items() if ids} | values
