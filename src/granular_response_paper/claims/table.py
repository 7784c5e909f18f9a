"""The claims against the stored datasets: the table, ``figures/claims.json``, that the page and the README quote."""

from __future__ import annotations

import json
import math
import os
import re
from collections import Counter
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from granular_response.inputs import read_json
from granular_response.store import atomic
from granular_response.store import files as store

from ..registry import PAPER, Collection
from . import declared, preparations
from .claim import PREPARATION, Claim, ClaimsError, Data, Quantity, Test
from .verdict import MEANINGS, SCHEME, Verdict, judge, key
from .words import WORDS

#: Where the table is kept.
OUTPUT = Path("figures") / "claims.json"

#: Parts of the table, with what each is.
PARTS = {
    "ordered": "ordered slabs, piles, theory and method",
    "disorder": "disordered packings",
    "extension": "questions beyond the paper",
}

#: What a stored table lists of each claim.
LISTED = {"id", "group", "part", "verdict", "star", "elsewhere", "here", "paper", "tests"}

#: Sections of the paper, in order.
SECTIONS = ("abstract", "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "beyond")


def _place(claim: Claim) -> tuple[int, int, str, str, int, str]:
    """Statements on order, then disorder, then what goes beyond; each by section."""
    section, _, further = re.split(r"[ ,;]", claim.place)[0].partition(".")
    letter, number, part = re.fullmatch(r"([A-Z])(\d+)([a-z]?)", claim.id).groups()  # type: ignore[union-attr]
    return list(PARTS).index(claim.part), SECTIONS.index(section), further, letter, int(number), part


@cache
def claims_in(collection: Collection) -> tuple[Claim, ...]:
    """All claims of a collection in the order of the table."""
    groups = [group for group in collection.groups if (collection.path / group / declared.TEXTS).is_file()]
    found = (claim for group in groups for claim in declared.read(f"{collection.package}.{group}"))
    return tuple(sorted(found, key=_place))


def groups_read(collection: Collection) -> list[str]:
    """The figure groups whose datasets the claims of a collection read."""
    return sorted({claim.group for claim in claims_in(collection)})


def collect(folder: str | os.PathLike[str], others: str | os.PathLike[str], collection: Collection = PAPER) -> Data:
    """The stored datasets that claims read, and the summary of ``others``, preparations that are not the paper's.

    A file that is not there is left out; raises StoreError if one cannot be read.
    """
    groups = {path.stem: store.read(path) for path in _paths(folder, collection) if path.exists()}
    if Path(others).exists():
        groups[PREPARATION] = groups.get(PREPARATION, {}) | store.read(Path(others))
    return Data(groups)


def _paths(folder: str | os.PathLike[str], collection: Collection) -> list[Path]:
    return [Path(folder) / f"{group}.nc" for group in groups_read(collection)]


def document(entries: Sequence[Verdict]) -> dict[str, Any]:
    """Everything about the verdicts, as it is stored; ``counts`` are scalars for ``dvc metrics show``."""
    number = Counter((entry.claim.part, entry.verdict) for entry in entries)
    return {
        "counts": {part: {key(kind): number[part, kind] for kind in MEANINGS} for part in PARTS},
        "scheme": list(SCHEME),
        "verdicts": [{"verdict": verdict, "meaning": meaning} for verdict, meaning in MEANINGS.items()],
        "words": [{"word": word, "bound": bound, "sentence": text} for word, (bound, text) in WORDS.items()],
        "table": [_row(entry) for entry in entries],
    }


def _row(entry: Verdict) -> dict[str, Any]:
    return {
        **_named(entry.claim, "id", "place", "paper", "source", "measured", "figures", "group", "part"),
        **_named(entry, "verdict", "star", "elsewhere", "here", "cases", "preparations"),
        "remark": entry.claim.remark,
        **_interval(entry.tests[0].found if entry.tests else None),
        "tests": [_tested(test) for test in entry.tests],
    }


def _tested(test: Test) -> dict[str, Any]:
    found = test.found
    ends = "the number itself" if found.kind == "none" else f"both ends of the {found.kind}"
    return {
        **_named(test, "what", "case", "prepared", "outcome"),
        "found": found.text(test.unit),
        "bound": test.bound.text(test.unit),
        "word": test.bound.word,
        "method": found.method or ends,
        "samples": found.samples,
        **_interval(found),
    }


def _named(one: object, *names: str) -> dict[str, Any]:
    return {name: getattr(one, name) for name in names}


def _interval(quantity: Quantity | None) -> dict[str, Any]:
    """A value with its interval and the kind of it; null without them, and for an end that is open."""
    if quantity is None or quantity.kind == "none":
        return {"value": quantity and _rounded(quantity.value), "interval": None, "interval_kind": ""}
    kind = "95 % confidence" if quantity.kind == "confidence" else quantity.kind
    ends = [_rounded(quantity.low), _rounded(quantity.high)]
    return {"value": _rounded(quantity.value), "interval": ends, "interval_kind": kind}


def _rounded(value: float) -> float | None:
    """To six digits, so that the last ones of a machine do not show; None for nan and inf, which JSON lacks."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


def write(
    output: str | os.PathLike[str] = OUTPUT,
    folder: str | os.PathLike[str] = "data",
    others: str | os.PathLike[str] = preparations.OUTPUT,
    collection: Collection = PAPER,
) -> dict[str, Any]:
    """Judge the claims of a collection on the datasets in ``folder`` and store the result; returns it.

    Raises ClaimsError if there are none, StoreError if one cannot be read, OSError if the output cannot be written
    or is one of the files that are read.
    """
    target, read_ = Path(output), _paths(folder, collection)
    atomic.check_output(target, [*read_, Path(others)])
    if not any(path.exists() for path in read_):
        raise ClaimsError(f"{folder}: holds none of the datasets that claims read; make them with dvc repro")
    data = collect(folder, others, collection)
    found = document([judge(claim, data) for claim in claims_in(collection)])
    target.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_bytes(target, (json.dumps(found, indent=1, ensure_ascii=False) + "\n").encode())
    return found


def read(path: str | os.PathLike[str] = OUTPUT) -> dict[str, Any]:
    """The stored table. Raises ClaimsError if it is missing or damaged."""
    try:
        found = read_json(Path(path))
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise ClaimsError(f"{path}: {problem}; make it with granular-response-paper claims") from None
    try:
        whole = bool(quoted(found)) and all(set(row) >= LISTED for row in found["table"])
    except (AttributeError, KeyError, TypeError, ValueError):
        whole = False
    if not whole:
        raise ClaimsError(f"{path}: is not a whole table of claims; make it with granular-response-paper claims")
    return found


def quoted(found: dict[str, Any]) -> str:
    """The counts in words: a line for each part of the table, and one on thresholds and preparations of the paper's."""
    lines = []
    for part, text in PARTS.items():
        number = found["counts"][part]
        named = {"derivation": "derivations"} if number["derivation"] > 1 else {}
        parts = [f"{number[key(kind)]} {named.get(kind, kind)}" for kind in MEANINGS if number[key(kind)]]
        if parts:
            lines.append(f"Of {sum(number.values())} statements on {text}: {', '.join(parts)}.")
    own = [row for row in found["table"] if row["part"] != "extension"]
    if not own:  # of a collection that goes beyond the paper
        return "\n".join(lines)
    starred = sum(bool(row["star"]) for row in own)
    tried = [row["elsewhere"] for row in own if row["elsewhere"] != "not tried"]
    lines.append(
        f"{starred} verdicts on the paper's statements change if the threshold of a qualitative term is halved or "
        f"doubled. Under another preparation {len(tried)} were tried: {tried.count('yes')} hold, "
        f"{tried.count('no')} fail, {tried.count('cannot tell')} cannot be told."
    )
    return "\n".join(lines)
