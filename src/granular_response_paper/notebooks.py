"""A notebook for each figure group, from its own parameters: simulation, figures and captions, step by step."""

from __future__ import annotations

import inspect
import json
from collections.abc import Sequence
from pathlib import Path
from pprint import pformat
from typing import Any

from granular_response.inputs import read_text
from granular_response.scene import text
from granular_response.store import atomic
from granular_response_paper.groups import NAMES
from granular_response_paper.pipeline import group_member, simulation

#: The groups at a size that takes seconds.
REDUCED = Path("notebooks") / "reduced.yaml"

#: The code of the cells.
_IMPORTS = """\
from IPython.display import Image, Markdown, display

from granular_response.plot import style
from granular_response.sweeps.resources import using
from {group}.draw import captions, draw
from {group}.parameters import Parameters
from {group}.simulate import simulate"""
_SURVEY = """\
from pathlib import Path

from granular_response.scene import text
from granular_response_paper.survey import simulate as survey

file = Path("{folder}") / "params.yaml"
file.parent.mkdir(exist_ok=True)
file.write_text(text.write({section}))
for block in survey.read_parameters(file).blocks:
    survey.run(survey.ensemble(block, file), file.parent, workers=1)"""
_RUN = """\
# own has the sizes of the paper and takes up to minutes; without workers all cores are used
parameters = Parameters(**reduced)
with using(workers=1):
    datasets = simulate(parameters)
for name, dataset in datasets.items():
    print(name, dict(dataset.sizes))"""
_DRAW = """\
texts = captions(datasets, parameters)
for name, figure in draw(datasets).items():
    display(Image(style.render(figure, "png", dpi=100)), Markdown(texts[name].whole))"""


def write(
    folder: Path, groups: Sequence[str] = NAMES, *, own: Path = simulation.PARAMETERS, reduced: Path = REDUCED
) -> list[Path]:
    """Write ``folder/GROUP.ipynb`` for each group, without outputs; returns the paths.

    ``own`` has the parameters of the reproduction, ``reduced`` those that the notebook begins with.

    Raises
    ------
    granular_response_paper.pipeline.GroupError
        If there is no such group, or a parameter file or a section of it is missing.
    granular_response.scene.SceneError
        If a parameter is not what it must be.
    OSError
        If a notebook cannot be written, or would replace a parameter file.
    """
    made = {
        folder / f"{group}.ipynb": json.dumps(_notebook(group, own, reduced), indent=1, ensure_ascii=False) + "\n"
        for group in groups
    }
    folder.mkdir(parents=True, exist_ok=True)
    for path, content in made.items():
        atomic.check_output(path, [own, reduced])
        atomic.write_bytes(path, content.encode())
    return list(made)


def _notebook(group: str, own: Path, reduced: Path) -> dict[str, Any]:
    """The content of a notebook, in its format 4.5."""
    simulate = group_member(group, "simulate", "simulate")
    about = inspect.cleandoc(inspect.getmodule(simulate).__doc__ or "").replace("``", "`")
    full, _ = simulation.parameters(group, own)
    small, _ = simulation.parameters(group, reduced)
    cells = [
        ("markdown", f"# Figure group `{group}`\n\n{about}"),
        ("code", _IMPORTS.format(group=f"granular_response_paper.groups.{group}")),
        ("markdown", f"The parameters of the group, as in `{own.name}`, and those of a run that takes seconds."),
        ("code", f"own = {_literal(full)}"),
        ("code", f"reduced = {_literal(small)}"),
    ]
    if "survey" in full:
        section = text.read(read_text(reduced))["survey"]
        code = _SURVEY.format(folder=Path(small["survey"]).parent, section=_literal(section))
        cells += [
            ("markdown", "It reads the survey of disordered slabs (`make survey`), here a small one."),
            ("code", code),
        ]
    cells += [("code", _RUN), ("code", _DRAW)]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {
        "cells": [_cell(f"{group}-{number}", *cell) for number, cell in enumerate(cells)],
        "metadata": {"kernelspec": kernel},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def _cell(name: str, kind: str, text: str) -> dict[str, Any]:
    code: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": name, "metadata": {}, "source": text.splitlines(keepends=True), **code}


def _literal(section: dict[str, Any]) -> str:
    return pformat(section, width=100, sort_dicts=False)
