"""The tasks of a study: calls by their places, and what they give by the same places."""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable, Mapping
from typing import Any, TypeVar

from granular_response.sweeps.tasks import map_tasks

Found = TypeVar("Found")
Place = TypeVar("Place", bound=Hashable)


def computed(
    tasks: Mapping[Place, Callable[[], Found]], what: str, *, work: Callable[[Place], Any] | None = None
) -> dict[Place, Found]:
    """What each task gives, computed wherever there is room, in the order of ``tasks``.

    A task is a call with its arguments, ``functools.partial(compute, scene, ...)``: of a function of a module, with
    plain values, so that it runs on all cores or a cluster and is kept when a run is interrupted. Those with the most
    ``work`` begin first, so that no worker is left with one at the end. Raises SweepError if a task raises.
    """
    order = sorted(tasks, key=work, reverse=True) if work else list(tasks)
    alone = 1 if len(order) == 1 else None  # in this process: one task is not worth another
    results = map_tasks(operator.call, [tasks[place] for place in order], workers=alone, what=what)
    found = dict(zip(order, results, strict=True))
    return {place: found[place] for place in tasks}
