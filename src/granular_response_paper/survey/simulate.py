"""Simulates a block of the survey and stores it.

An ensemble is a block of the survey's own parameter file. Other packages add blocks of their own: packings of a figure
group that a pipeline has no time for.

Every finished task is kept, under a name made from the sources that its outcome depends on and from the task itself.
So a run that was stopped goes on where it was, a block with more realizations computes the new ones alone, and a change
of what is measured on stored responses costs nothing. Tasks run in this process, over all cores or over an executor,
as those of every sweep.
"""

from __future__ import annotations

import json
import operator
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response.errors import GranularError
from granular_response.inputs import read_text
from granular_response.scene import Scene, SceneError, text
from granular_response.store import files as store
from granular_response.store.variables import variable
from granular_response.sweeps.keys import sources
from granular_response.sweeps.resources import using
from granular_response.sweeps.tasks import Progress, map_tasks
from granular_response_paper import PACKAGE
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles.datasets import Place, ensembles_dataset, packings_dataset, places
from granular_response_paper.ensembles.parameters import Case
from granular_response_paper.ensembles.realizations import Realization, ensemble_task
from granular_response_paper.survey.datasets import gravity_ramp
from granular_response_paper.survey.parameters import Parameters

#: The sources that every outcome depends on, and those of a realization of an ensemble.
LIBRARY = ("contact", "kernels", "linalg", "machine", "observe", "scene", "solvers", "state", "studies")
MECHANICS = (*LIBRARY, f"{PACKAGE}/slab_response.py")
SOURCES = (*MECHANICS, f"{PACKAGE}/ensembles")

#: What is kept of the responses and of the packings.
RESPONSES = ("force", "x", "floor_response", "outcome", "message", "lost", "by_motion")
PACKINGS = (
    "coordination_number",
    "coordination_number_bulk",
    "coordination_number_with_walls",
    "horizontal_contacts",
    "oblique_contacts",
    "loose_disks",
    "force_residual",
    "settling_steps",
)

#: Binary digits after the point of stored responses and positions: errors of 4e-6 and 1e-4, far below the
#: scatter of realizations.
RESPONSE_DIGITS, POSITION_DIGITS = 17, 12


class SurveyError(GranularError):
    """No such block, or no parameters. The message is one line."""


@dataclass(frozen=True)
class Block:
    """What one run makes."""

    name: str
    tasks: Mapping[Any, partial[Any]]  #: by what tells them apart, in the order in which they are begun
    datasets: Callable[[dict[Any, Any]], dict[str, xr.Dataset]]  #: of what they find
    scene: Scene  #: that those of the tasks are changes to
    given: Mapping[str, Any]  #: the parameters
    parts: tuple[str, ...]  #: the sources that an outcome depends on
    packages: tuple[str, ...] = (PACKAGE,)  #: that hold the functions and classes of the tasks


def read_parameters(path: Path) -> Parameters:
    """The survey's parameter file.

    Raises SurveyError if it cannot be read, SceneError for a parameter that is missing, unknown or not what it must be.
    """
    try:
        return Parameters(**text.read(read_text(path)))
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise SurveyError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def ensemble(name: str, parameter_file: Path, realizations: int | None = None) -> Block:
    """A block of the survey's parameter file.

    ``realizations`` is the most that any case gets; None leaves the numbers of the parameters.

    Raises what ``read_parameters`` raises, and SurveyError for a block that is not there.
    """
    parameters = read_parameters(parameter_file)
    if name not in parameters.blocks:
        raise SurveyError(f"block {name}: there is none of this name, must be one of {', '.join(parameters.blocks)}")
    cases = [
        replace(case, realizations=min(case.realizations, realizations or case.realizations))
        for case in parameters.cases(name)
    ]
    tasks = {(c, r): ensemble_task(parameters, cases[c], r) for c, r in places(cases)}
    given = parameters.model_dump(mode="json", exclude={"blocks", "scene"})
    return Block(name, tasks, partial(block_datasets, cases), parameters.base, given, SOURCES)


def run(block: Block, folder: Path, *, workers: int | None = None, progress: Progress | None = None) -> Path:
    """Simulate a block and store it below ``folder``, as ``NAME.nc``; returns the path.

    Raises SweepError and StoreError.
    """
    output = folder / f"{block.name}.nc"
    store.check_writable(output)  # before the work
    with using(packages=block.packages):
        found = map_tasks(
            operator.call,
            block.tasks.values(),
            workers=workers,
            progress=progress,
            checkpoint=folder / ".realizations.checkpoint",
            parts=block.parts,
            what=f"tasks of {block.name}",
        )
    datasets = block.datasets(dict(zip(block.tasks, found, strict=True)))
    seed = str(block.scene.packing.model_dump()["seed"])
    attributes = {"block": block.name, "parameters": text.write(block.given), **made_by(block.parts), "seed": seed}
    store.write(output, labelled(datasets, block.scene), attributes)
    return output


def made_by(parts: Sequence[str]) -> dict[str, str]:
    """Attributes of a file: the sources of these parts, and versions of what computes."""
    versions = {name: metadata.version(name) for name in ("numba", "numpy", "scipy")}
    return {
        "sources": f"{sources(*parts)} ({', '.join(parts)})",
        "versions": json.dumps({"python": platform.python_version(), **versions}),
    }


def block_datasets(cases: list[Case], found: Mapping[Place, Realization]) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles`` and ``packings`` of a block, in the layout of ``polydisperse_averages`` and small."""
    walls = [case.friction if case.wall_friction is None else case.wall_friction for case in cases]
    added = {
        "wall_friction": variable(("case",), walls, "coefficient of friction of the walls"),
        "gravity_ramp": gravity_ramp(["" if one.gravity_ramp is None else f"{one.gravity_ramp:g}" for one in cases]),
    }
    ensembles = ensembles_dataset(cases, found)[list(RESPONSES)].assign_coords(added)
    for name, digits in (("floor_response", RESPONSE_DIGITS), ("x", POSITION_DIGITS)):
        values = ensembles[name].values
        ensembles[name] = ensembles[name].copy(data=(np.round(values * 2.0**digits) / 2.0**digits).astype(np.float32))
    packings = packings_dataset(cases, found)[list(PACKINGS)].assign_coords(added)
    return {"ensembles": ensembles, "packings": packings.astype(np.float32)}
