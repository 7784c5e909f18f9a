"""The stored table of claims: read back, and its counts in words."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from granular_response.errors import GranularError
from granular_response.inputs import read_json

from .verdict import MEANINGS, key

#: Where the table is kept.
OUTPUT = Path("figures") / "claims.json"

#: Parts of the table, with what each is.
PARTS = {
    "ordered": "ordered slabs, piles, theory and method",
    "disorder": "disordered packings",
    "extension": "what the paper leaves to words (extensions)",
}

#: What a stored table holds, and what it lists of each claim.
KEYS = {"counts", "scheme", "verdicts", "words", "table"}
LISTED = {"id", "group", "part", "verdict", "star", "elsewhere", "here", "paper", "tests"}


class ClaimsError(GranularError):
    """A claim that is not declared as it must be, nothing to judge, or no stored table. The message is one line."""


def read(path: str | os.PathLike[str] = OUTPUT) -> dict[str, Any]:
    """The stored table. Raises ClaimsError if it is missing or damaged."""
    try:
        found = read_json(Path(path))
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise ClaimsError(f"{path}: {problem}; make it with granular-response-paper claims") from None
    try:
        whole = set(found) >= KEYS and all(set(row) >= LISTED for row in found["table"])
        whole = whole and all("verdict" in kind for kind in found["verdicts"])
        quoted(found)
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
