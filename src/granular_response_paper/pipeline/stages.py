"""The pipeline of a collection (``dvc.yaml``), made from its figure groups and from what their modules import.

Each figure group has two stages: ``simulate`` stores datasets, ``draw`` reads nothing else, so a change of style reruns
no simulation. Then ``claims`` and ``report``. One list of dependencies serves all groups of a stage, since DVC has one
for all items of a ``foreach``; modules of a group itself stand in it by the name of the group.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml

from granular_response_paper import digitised, report
from granular_response_paper.claims import preparations, table
from granular_response_paper.pipeline.imports import closure, file_of
from granular_response_paper.registry import PAPER, Collection

FILE = "dvc.yaml"

#: A folder stands for its files where at least this part of them is imported. DVC reads and writes the whole lock
#: around every stage, and a name less is a line less in each of them.
FOLDED = 0.5

HEAD = """\
# Made by `granular-response-paper stages{option}` from the figure groups and what their modules import: edit those.
"""

_PAPER = "granular_response_paper"


def document(collection: Collection = PAPER, root: Path = Path(".")) -> str:
    """The pipeline file as text; ``root`` is the folder of the checkout."""
    option = "" if collection == PAPER else f" --collection {collection.name}"
    text = yaml.safe_dump(_stages(collection, root, option), sort_keys=False, width=120)
    return HEAD.format(option=option) + text


def write(collection: Collection = PAPER, root: Path = Path(".")) -> Path:
    """Write the pipeline file of a collection; returns its path."""
    path = root / collection.folder / FILE
    path.write_text(document(collection, root), encoding="utf-8")
    return path


def starts(collection: Collection, kind: str, group: str) -> list[str]:
    """The modules at which a stage of a group starts, but for those that only its command line imports."""
    own, module = f"{collection.package}.{group}", {"simulate": "simulation", "draw": "drawing"}[kind]
    return [f"{_PAPER}.pipeline.{module}", f"{own}.parameters", f"{own}.{kind}"]


def judging(collection: Collection) -> list[str]:
    """The modules at which the stage ``claims`` starts."""
    claims = [f"{collection.package}.{group}.claims" for group in collection.groups]
    return [f"{_PAPER}.claims.table", *(name for name in claims if file_of(name))]


def _stages(collection: Collection, root: Path, option: str) -> dict[str, Any]:
    base = (root / collection.folder).resolve()
    groups = collection.groups

    def near(path: Path) -> str:
        """A path as the pipeline names it."""
        return Path(os.path.relpath(path, base)).as_posix()

    def code(modules: Iterable[str], own: Iterable[str] = ()) -> list[str]:
        """Files of modules as the pipeline names them; what stands inside a figure group is ``own``."""
        files = {path for name in closure(modules) if (path := file_of(name))}
        named = _folded({path for path in files if collection.path not in path.parent.parents})
        # the data of a module stand beside it under its name
        named += [
            data for path in named if path.is_file() for data in path.parent.glob(f"{path.stem}.*") if data != path
        ]
        return sorted([*map(near, named), *own])

    simulated = [name for group in groups for name in starts(collection, "simulate", group)]
    drawn = [name for group in groups for name in starts(collection, "draw", group)]
    item = f"{near(collection.path)}/${{item}}"
    reads_survey = "survey/data" in (root / collection.folder / "params.yaml").read_text(encoding="utf-8")
    judged = [f"data/{group}.nc" for group in table.groups_read(collection)]
    judged += [preparations.OUTPUT.as_posix()] if collection == PAPER else []
    pictures = [f"figures/{group}" for group in groups]
    documents = near(root / "docs" / "_generated")
    written = [f"{documents}/{name}" for name in report.fragments(root, collection)]
    tables = [name for group in groups if file_of(name := f"{collection.package}.{group}.tables")]
    stages: dict[str, Any] = {
        "simulate": {
            "foreach": list(groups),
            "do": {
                "desc": "Simulations of the figure group",
                "cmd": "granular-response-paper simulate ${item}",
                "deps": [
                    *code(simulated, [f"{item}/parameters.py", f"{item}/simulate"]),
                    *([near(root / "survey" / "data")] if reads_survey else []),
                ],
                "params": ["common", "${item}"],
                "outs": ["data/${item}.nc"],
            },
        },
        "draw": {
            "foreach": list(groups),
            "do": {
                "desc": "Figures of the group",
                "cmd": "granular-response-paper draw ${item}",
                "deps": ["data/${item}.nc", digitised.FOLDER.as_posix(), *code(drawn, [item])],
                "outs": [{"figures/${item}": {"cache": False}}],
            },
        },
        "claims": {
            "desc": "What is claimed against the datasets",
            "cmd": f"granular-response-paper claims{option}",
            "deps": [*judged, *code(judging(collection)), near(collection.path)],
            "metrics": [{"figures/claims.json": {"cache": False}}],
        },
        "report": {
            "desc": "The page with verdicts and figures",
            "cmd": f"granular-response-paper report{option} --fragments {documents}",
            "deps": [
                *(f"data/{group}.nc" for group in report.datasets_read(collection)),
                "figures/claims.json",
                near(root / "requirements.lock"),
                *pictures,
                *code([f"{_PAPER}.report", *tables]),
            ],
            "outs": [{path: {"cache": False}} for path in ("figures/report.html", *written)],
        },
    }
    if collection != PAPER and "preparation" in groups:
        # Its file is no output: the paper's claims read it, and would else run this collection to bring it up to date.
        stages["summary"] = {
            "desc": "What the claims of the paper read of other preparations",
            "cmd": "granular-response-paper summary --data data/preparation.nc -o summary.nc",
            "deps": ["data/preparation.nc", *code([f"{_PAPER}.claims.preparations"])],
        }
    return {"stages": stages}


def _folded(files: set[Path]) -> list[Path]:
    """Files, or their folders where these stand for them."""
    inside: dict[Path, set[Path]] = defaultdict(set)
    for path in files:
        inside[path.parent].add(path)
    found: set[Path] = set()
    for folder, some in inside.items():
        every = list(folder.rglob("*.py"))
        deeper = {path for path in files if folder in path.parents}
        top = file_of(folder.name) is not None  # a whole package has too much beside it
        found |= {folder} if not top and len(deeper) >= FOLDED * len(every) and len(every) > 1 else some
    return [path for path in found if not any(folder in path.parents for folder in found)]
