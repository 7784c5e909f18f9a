"""Packings of figure groups that the pipeline has no time for: higher ones, and more realizations.

A group says in its section of ``params.yaml`` which packings are the survey's. ``survey`` of its ``simulate.py`` has
their tasks by what tells them apart, so they are made as those of the pipeline are. Finished ones are kept as those of
:mod:`.simulate`, under names made from all sources that an outcome depends on and from the task.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from granular_response.scene import text
from granular_response.store import files as store
from granular_response.sweeps.resources import using
from granular_response.sweeps.tasks import Progress, map_tasks
from granular_response_paper import PACKAGE
from granular_response_paper.datasets import labelled
from granular_response_paper.pipeline import group_member, simulation
from granular_response_paper.survey import packings
from granular_response_paper.survey.simulate import clocked, origin

#: Groups with packings of this kind.
GROUPS = ("peak_width", "moduli", "crossover_scaling", "hysteresis")


def sources_of(group: str) -> tuple[str, ...]:
    """The sources that an outcome depends on."""
    mechanics = ("contact", "kernels", "linalg", "machine", "observe", "scene", "solvers", "state", "theory")
    return (*mechanics, f"{PACKAGE}/slab_response.py", f"{PACKAGE}/groups/{group}/simulate.py")


def run(
    group: str,
    parameter_file: Path,
    folder: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Path:
    """Simulate the packings that ``parameter_file`` leaves to the survey, and store them under ``folder``.

    Returns the path of the file. The smallest come first.

    Raises what ``simulation.parameters`` raises, SweepError and StoreError.
    """
    given, parameters = simulation.parameters(group, parameter_file)
    output = folder / "data" / f"{group}.nc"
    store.check_writable(output, [parameter_file])
    tasks: dict[Any, functools.partial[Any]] = group_member(group, "simulate", "survey")(parameters)
    # the first argument of each is its scene
    order = sorted(tasks, key=lambda key: tasks[key].args[0].packing.disk_count)
    with using(packages=(PACKAGE,)):
        found = map_tasks(
            clocked,
            [tasks[key] for key in order],
            workers=workers,
            scheduler=scheduler,
            progress=progress,
            checkpoint=folder / ".realizations.checkpoint",
            parts=sources_of(group),
            what=f"packings of {group}",
        )
    by_key = dict(zip(order, found, strict=True))
    dataset = packings.dataset({key: by_key[key].found for key in tasks}, [by_key[key].seconds for key in tasks])
    scene = parameters.base  # type: ignore[attr-defined]
    attributes = {"block": group, "parameters": text.write(given)} | origin(sources_of(group), scene)
    store.write(output, labelled({packings.DATASET: dataset}, scene), attributes)
    return output
