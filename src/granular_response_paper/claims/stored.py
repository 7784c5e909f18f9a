"""The stored table of claims: read back, and its counts in the words that the README and the page quote."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from granular_response.errors import GranularError
from granular_response.inputs import read_json
from granular_response.store import generated

from .verdict import MEANINGS, key

#: Where the table of claims is kept.
OUTPUT = Path("figures") / "claims.json"

#: Name of the generated lines in the README.
BLOCK = "claims"

#: What a stored table holds, and what it lists of each claim.
KEYS = {"counts", "robustness", "verdict_kinds", "robustness_kinds", "changes", "words", "sensitivity"}
KEYS |= {"sentences", "table"}
LISTED = {"id", "group", "verdict", "robustness", "robustness_reason", "ours", "reason", "interval_kind"}


class ClaimsError(GranularError):
    """Nothing to judge, or no stored table. The message is one line."""


def read(path: str | os.PathLike[str] = OUTPUT) -> dict[str, Any]:
    """The stored table. Raises ClaimsError if it is missing or damaged."""
    try:
        found = read_json(Path(path))
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise ClaimsError(f"{path}: {problem}; make it with granular-response-paper claims") from None
    try:
        whole = set(found) >= KEYS and all(set(row) >= LISTED for row in found["table"])
        whole = whole and all("verdict" in kind for kind in found["verdict_kinds"])
        quoted(found)
    except (AttributeError, KeyError, TypeError, ValueError):
        whole = False
    if not whole:
        raise ClaimsError(f"{path}: is not a whole table of claims; make it with granular-response-paper claims")
    return found


def sentence(found: dict[str, Any]) -> str:
    """The counts in words; derivations are counted apart."""
    number = found["counts"]
    named = [(number[key(v)], v) for v in MEANINGS if v not in ("derivation", "not measured")]
    judged = sum(n for n, _ in named)
    parts = [
        f"{n} {'depend' if n != 1 else 'depends'} on the interpretation" if v.startswith("depends") else f"{n} {v}"
        for n, v in named
        if n
    ]
    text = f"Of {judged} claims of the paper that were measured in its own set-up: {', '.join(parts) or 'none'}."
    algebra, missing, beyond = number["derivation"], number["not_measured"], number.get("beyond", 0)
    if algebra:
        text += f" {algebra} more {'are' if algebra != 1 else 'is'} algebra that no simulation can fail."
    if beyond:
        text += f" {beyond} more {'goes' if beyond == 1 else 'go'} beyond what the paper measured."
    if missing:
        text += f" {missing} {'are' if missing != 1 else 'is'} not measured."
    return text


def robustness(found: dict[str, Any]) -> str:
    """The counts of the second column in words."""
    number = found["robustness"]
    varied = sum(n for kind, n in number.items() if kind != "not_varied")
    changes = ", ".join(row["change"] for row in found["changes"])
    return (
        f"Of {varied} that were also measured in variants of it ({changes}): "
        f"{number['robust']} hold in all, {number['breaks']} fail in one or more, {number['open']} are open."
    )


def firmness(found: dict[str, Any]) -> str:
    """How far the counts move with the words, in a sentence."""
    reproduced = [row["counts"]["reproduced"] for row in found["sensitivity"]]
    moved = {name for row in found["sensitivity"] for name in row["changed"]}
    return (
        f"If the threshold of any one qualitative term is halved or doubled, {min(reproduced)} to {max(reproduced)} "
        f"are reproduced ({found['counts']['reproduced']} as it stands); {len(moved)} claims change their verdict in "
        "some of these."
    )


def quoted(found: dict[str, Any]) -> str:
    """The counts and how firm they are, a line for each."""
    return f"{sentence(found)}\n{robustness(found)}\n{firmness(found)}"


def renew(readme: str | os.PathLike[str], found: dict[str, Any]) -> None:
    """Renew the counts that a file quotes. Raises GeneratedError if it cannot be read or has no place for them."""
    generated.renew(readme, BLOCK, quoted(found))
