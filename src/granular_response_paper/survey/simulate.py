"""Runs a block of the survey and stores it.

Every finished realization is kept, under a name made from the sources of the mechanics and from its own task. So a run
that was stopped goes on where it was, a block with more realizations computes the new ones alone, and a change of what
is measured on stored responses costs nothing. Tasks run in this process, over all cores or over a Dask cluster, as
those of every sweep.
"""

from __future__ import annotations

import json
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
import xarray as xr

from granular_response.errors import GranularError
from granular_response.scene import Scene, SceneError, text
from granular_response.store import files as store
from granular_response.store.result import variable
from granular_response.sweeps.keys import sources
from granular_response.sweeps.resources import using
from granular_response.sweeps.tasks import Progress, map_tasks
from granular_response_paper import PACKAGE
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles.datasets import ensembles_dataset, packings_dataset
from granular_response_paper.ensembles.realizations import (
    Realization,
    Task,
    ensemble_task,
    realize,
)
from granular_response_paper.groups.polydisperse_averages.parameters import Case
from granular_response_paper.survey.parameters import Parameters

Found = TypeVar("Found")

#: The sources that a realization depends on.
SOURCES = (
    "contact",
    "kernels",
    "linalg",
    "machine",
    "observe",
    "scene",
    "solvers",
    "state",
    f"{PACKAGE}/ensembles",
    f"{PACKAGE}/slab_response.py",
)

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
class Timed(Generic[Found]):
    """What a task found and the processor time that it took, in seconds."""

    found: Found
    seconds: float


def clocked(task: Callable[[], Found]) -> Timed[Found]:
    """What a task finds."""
    start = time.process_time()
    found = task()
    return Timed(found, time.process_time() - start)


def timed(task: Task) -> Timed[Realization]:
    """One realization; what fails is part of the result."""
    return clocked(partial(realize, task))


def read_parameters(path: Path) -> Parameters:
    """The survey's parameter file.

    Raises
    ------
    SurveyError
        If it cannot be read.
    granular_response.scene.SceneError
        If a parameter is missing, unknown or not what it must be.
    """
    try:
        return Parameters(**text.read(path.read_text(encoding="utf-8")))
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise SurveyError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def run(
    block: str,
    parameter_file: Path,
    *,
    realizations: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Path:
    """Simulate a block and store it beside the parameter file; returns the path.

    ``realizations`` is the most that any case gets; None leaves the numbers of the parameters.

    Raises what ``read_parameters`` raises, SurveyError for a block that is not there, SweepError and StoreError.
    """
    parameters = read_parameters(parameter_file)
    if block not in parameters.blocks:
        raise SurveyError(f"block {block}: there is none of this name, must be one of {', '.join(parameters.blocks)}")
    cases = [
        replace(case, realizations=min(case.realizations, realizations or case.realizations))
        for case in parameters.cases(block)
    ]
    output = parameter_file.parent / "data" / f"{block}.nc"
    store.check_writable(output, [parameter_file])
    with using(packages=(PACKAGE,)):
        found = map_tasks(
            timed,
            [
                ensemble_task(parameters, case, realization)
                for case in cases
                for realization in range(case.realizations)
            ],
            workers=workers,
            scheduler=scheduler,
            progress=progress,
            checkpoint=parameter_file.parent / ".realizations.checkpoint",
            parts=SOURCES,
            what=f"realizations of {block}",
        )
    datasets = block_datasets(cases, found)
    store.write(output, labelled(datasets, parameters.base), provenance(parameters, block))
    return output


def block_datasets(cases: list[Case], found: list[Timed[Realization]]) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles`` and ``packings`` of a block, in the layout of ``polydisperse_averages`` and small."""
    realized = [one.found for one in found]
    walls = [case.friction if case.wall_friction is None else case.wall_friction for case in cases]
    wall_friction = variable(("case",), walls, "coefficient of friction of the walls")
    ensembles = ensembles_dataset(cases, realized)[list(RESPONSES)].assign_coords(wall_friction=wall_friction)
    for name, digits in (("floor_response", RESPONSE_DIGITS), ("x", POSITION_DIGITS)):
        values = ensembles[name].values
        ensembles[name] = ensembles[name].copy(data=(np.round(values * 2.0**digits) / 2.0**digits).astype(np.float32))
    packings = packings_dataset(cases, realized)[list(PACKINGS)].drop_vars("angle", errors="ignore")
    packings = packings.assign_coords(wall_friction=wall_friction)
    seconds = np.full(packings["coordination_number"].shape, np.nan)
    left = iter(found)
    for c, case in enumerate(cases):
        seconds[c, : case.realizations] = [next(left).seconds for _ in range(case.realizations)]
    packings["processor_time"] = variable(("case", "realization"), seconds, "processor time of the realization (s)")
    return {"ensembles": ensembles, "packings": packings.astype(np.float32)}


def provenance(parameters: Parameters, block: str) -> dict[str, str]:
    """Attributes of the file: what it was made from, and by what."""
    return {
        "block": block,
        "parameters": text.write(parameters.model_dump(mode="json", exclude={"blocks", "scene"})),
        **origin(SOURCES, parameters.base),
    }


def origin(parts: Sequence[str], scene: Scene) -> dict[str, str]:
    """Attributes of the file: the sources of ``parts``, versions, the seed of the packings."""
    versions = {name: metadata.version(name) for name in ("numba", "numpy", "scipy")}
    return {
        "sources": f"{sources(*parts)} ({', '.join(parts)})",
        "versions": json.dumps({"python": platform.python_version(), **versions}),
        "seed": str(scene.packing.model_dump()["seed"]),
    }
