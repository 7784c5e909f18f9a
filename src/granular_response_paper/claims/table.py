"""The claims against the stored datasets: the table, ``figures/claims.json``, that the page and the README quote."""

from __future__ import annotations

import json
import os
import re
from collections import Counter
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

from granular_response.inputs import read_json
from granular_response.scene import SceneError
from granular_response.scene import text as yaml
from granular_response.store import atomic
from granular_response.store import files as store

from ..parameters import leaves
from ..registry import PAPER, Collection, group_member
from . import preparations, printed
from .bounds import WORDS
from .claim import (
    OF_THE_TEXT,
    PREPARATION,
    ROBUSTNESS,
    Case,
    Claim,
    ClaimsError,
    Data,
    Kind,
    Test,
    Verdict,
    judge,
    together,
)  # fmt: skip
from .numbers import Quantity, rounded, text

#: Where the table is kept.
OUTPUT = Path("figures") / "claims.json"

#: Parts of the table, with what each is.
PARTS = {
    "ordered": "ordered slabs, piles, theory and method",
    "disorder": "disordered packings",
    "extension": "questions beyond the paper",
}

SCHEME = (
    "Each sentence has one primary case, which its figure, its forces or its words fix; that case alone decides.",
    "The sentence is supported, or not supported, if the number and its whole interval lie on one side of the bound; "
    "otherwise the data cannot tell. What may be, and was not found, is not seen.",
    "The interval is the 95 % confidence over packings, or for events of ordered slabs the range over what the text "
    "leaves open or calls irrelevant: dashpots, time step, integrator, duration of the load ramp and displacements by "
    "10⁻⁹ radii. A number of a single state has none.",
    "Every other case says for what the sentence holds, fails or is open; so do other ways of applying gravity "
    "and other initial lattices.",
    "A star marks a verdict that changes if the threshold of a qualitative term is halved, or doubled to three "
    "quarters at most.",
)

#: Every verdict and what it says.
MEANINGS: dict[Kind, str] = {
    "supported": "the sentence holds in its primary case",
    "not supported": "it does not hold there",
    "cannot tell": "the interval of the number straddles the bound",
    "not seen": "the sentence says that something may be, and it was not found here",
    "not measured": "no stored dataset decides it",
}

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
    names = [name for name in collection.groups if (collection.path / name / "claims.py").is_file()]
    modules = [import_module(f"{collection.package}.{name}.claims") for name in names]
    found = [claim for module in modules for claim in vars(module)["claim"].rows]
    return tuple(sorted(found, key=_place))


def groups_read(collection: Collection) -> list[str]:
    """The figure groups whose datasets the claims of a collection read."""
    return sorted({claim.group for claim in claims_in(collection)})


#: Where the study of what moves the events of ordered slabs is kept.
MOVES = Path("data") / "survey" / f"{ROBUSTNESS}.nc"


def collect(folder: str | os.PathLike[str], others: str | os.PathLike[str], collection: Collection = PAPER) -> Data:
    """The stored datasets that claims read with the parameters of each, the summary of ``others``, preparations that
    are not the paper's, and the study ``robustness``.

    A file that is not there is left out; raises StoreError if one cannot be read.
    """
    paths = {path.stem: path for path in _paths(folder, collection) if path.exists()}
    groups = {name: store.read(path) for name, path in paths.items()}
    given = {name: store.read_attributes(path).get("parameters", "") for name, path in paths.items()}
    whole = {name: _whole(name, yaml.read(one) or {}) for name, one in given.items()}
    parameters = {name: {".".join(path): value for path, value in leaves(of)} for name, of in whole.items()}
    for name, path in ((PREPARATION, Path(others)), (ROBUSTNESS, MOVES)):
        if path.exists():
            groups[name] = groups.get(name, {}) | store.read(path)
    return Data(groups, parameters)


def _whole(group: str, given: dict[str, Any]) -> dict[str, Any]:
    """The parameters of a group with those that its file leaves out; as they stand if of another version."""
    try:
        return group_member(group, "parameters", "Parameters")(**given).model_dump(mode="json")
    except SceneError:
        return given


def _paths(folder: str | os.PathLike[str], collection: Collection) -> list[Path]:
    return [Path(folder) / f"{group}.nc" for group in groups_read(collection)]


def document(entries: Sequence[Verdict], data: Data | None = None) -> dict[str, Any]:
    """Everything about the verdicts, as it is stored; ``counts`` are scalars for ``dvc metrics show``.

    Only statements are counted; ``checks`` are the other rows. ``quantities`` are the numbers that the paper prints.
    """
    statements = [entry for entry in entries if entry.claim.row == "statement"]
    number = Counter((entry.claim.part, entry.verdict) for entry in statements)
    return {
        "counts": {part: {key(kind): number[part, kind] for kind in MEANINGS} for part in PARTS},
        "checks": {"check": len(entries) - len(statements)},
        "scheme": list(SCHEME),
        "verdicts": [{"verdict": verdict, "meaning": meaning} for verdict, meaning in MEANINGS.items()],
        "words": [{"word": word, "bound": bound, "sentence": sentence} for word, (bound, sentence) in WORDS.items()],
        "table": [_row(entry) for entry in entries],
        "quantities": printed.quantities(entries, data) if data else [],
    }


def key(kind: str) -> str:
    """Of a verdict in the stored table."""
    return kind.replace(" ", "_")


def _row(entry: Verdict) -> dict[str, Any]:
    return {
        **_named(entry.claim, "id", "place", "paper", "short", "source", "figures", "group", "part", "row", "primary"),
        **_named(entry, "verdict", "star", "here", "cases"),
        "remark": entry.claim.remark,
        "gravity": _held(entry, "gravity"),
        "lattice": _held(entry, "lattice"),
        **_interval(entry.primary[0].found if entry.primary else None),
        "tests": [_tested(test) for test in entry.tests],
    }


def _held(entry: Verdict, prepared: Literal["gravity", "lattice"]) -> dict[str, Any]:
    """In how many preparations a sentence holds, of how many that were tried, and the words for it, also where not
    every number of it was asked. The primary case counts alone if it was prepared so.
    """
    found, asked = entry.others(prepared), Counter(one.case for one in entry.tests)
    by_outcome = {name: [case for case, one in found.items() if one == name] for name in ("yes", "no", "cannot tell")}
    own = {case: one for case, one in found.items() if entry.claim.primary in case} or found
    outcomes = Counter(own.values())
    holds, open_in, of = outcomes["yes"], outcomes["cannot tell"], len(own)
    literal = [one for case, one in own.items() if OF_THE_TEXT in case]
    said = "open in all" if open_in == of else f"holds in {holds}" + (f", open in {open_in}" if open_in else "")
    whole = all(asked[Case(case, prepared)] == len(entry.claim.asks) for case in own)
    said = f"{said} of {of}{'' if whole else ', asked in part'}" if of else "not tried"
    in_text = together(literal) if literal else ""
    return {"holds": holds, "of": of, "whole": whole, "text": said, "literal": in_text, **by_outcome}


def _tested(test: Test) -> dict[str, Any]:
    found = test.found
    ends = "the number itself" if found.kind == "none" else f"both ends of the {found.kind}"
    return {
        "what": test.ask.what,
        "case": test.case.name,
        "prepared": test.case.prepared,
        "outcome": test.outcome,
        "found": text(found, test.ask.unit),
        "bound": test.limits.text(test.ask.unit),
        "word": test.ask.bound.word,
        "method": found.method or ends,
        "samples": found.samples,
        **_interval(found),
    }


def _named(one: object, *names: str) -> dict[str, Any]:
    return {name: getattr(one, name) for name in names}


def _interval(quantity: Quantity | None) -> dict[str, Any]:
    """A value with its interval and the kind of it; null without them, and for an end that is open."""
    if quantity is None or quantity.kind == "none":
        return {"value": quantity and rounded(quantity.low), "interval": None, "interval_kind": ""}
    kind = "95 % confidence" if quantity.kind == "confidence" else quantity.kind
    ends = [rounded(quantity.low), rounded(quantity.high)]
    return {"value": rounded(quantity.value), "interval": ends, "interval_kind": kind}


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
    found = document([judge(claim, data) for claim in claims_in(collection)], data if collection == PAPER else None)
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
        quoted(found)
    except (AttributeError, KeyError, TypeError):
        raise ClaimsError(
            f"{path}: is not a whole table of claims; make it with granular-response-paper claims"
        ) from None
    return found


def quoted(found: dict[str, Any]) -> str:
    """The counts in words: a line for each part of the table, and one on what is not counted and on thresholds."""
    lines = []
    for part, title in PARTS.items():
        number = found["counts"][part]
        rest = "".join(f", {number[key(kind)]} {kind}" for kind in list(MEANINGS)[1:] if number[key(kind)])
        if whole := sum(number.values()):
            lines.append(f"{number['supported']} of {whole} statements on {title} are supported{rest}.")
    statements = [row for row in found["table"] if row["part"] != "extension" and row["row"] == "statement"]
    if not statements:  # of a collection that goes beyond the paper
        return "\n".join(lines)
    starred = sum(bool(row["star"]) for row in statements)
    tried = {name: [row[name] for row in statements if row[name]["of"]] for name in ("gravity", "lattice")}
    held = {name: sum(one["holds"] == one["of"] and one["whole"] for one in some) for name, some in tried.items()}
    literal = [one["literal"] for one in tried["lattice"] if one["literal"]]
    lines.append(
        f"{starred} of these verdicts change if the threshold of a qualitative term is halved or doubled. With gravity "
        f"applied in other ways {held['gravity']} of {len(tried['gravity'])} statements hold in every way, from "
        f"other initial lattices {held['lattice']} of {len(tried['lattice'])}, from that of the text "
        f"{literal.count('yes')} of {len(literal)}. Not counted: statements that can hardly fail "
        f"({found['checks']['check']})."
    )
    return "\n".join(lines)
