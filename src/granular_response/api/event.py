"""Where something happens for the first time: bisection along the load or along a key of the scene."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Callable, Mapping
from typing import Any

from ..observe.events import Bracket, bisect_event
from ..scene import Scene, SceneError
from ..sweeps.tasks import Progress
from .result import Result, described, solve
from .terminal import TerminalProgress


def find_event(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    happened: Callable[[Result], bool],
    low: float,
    high: float,
    *,
    key: str = "load",
    tolerance: float | None = None,
    progress: Progress | bool = True,
) -> Bracket:
    """Narrow down where an event happens between two loads, or two values of a key.

    Parameters
    ----------
    scene : a scene, nested mappings, or the path of a scene file.
    happened : called with a :class:`Result`, says whether it has happened in its last state, such as
        ``lambda result: (result.loaded[-1].pairs.touching != result.rest.pairs.touching).any()``.
    low, high : between these, and different at both: factors of the scene's loads, ``low`` above 0, or values of the
        key.
    key : the load, which grows from ``low``, each state reached from the nearest one below it; or the path of a key
        with real values, such as contact.friction, where each value is a packing of its own.
    tolerance : width of the bracket at which to stop; a thousandth of the whole range if left out.
    progress : as of :func:`sweep`.

    Returns
    -------
    A bracket ``low``, ``high`` with ``at_low``, what ``happened`` says at its lower end; at the upper one it says the
    opposite. If it changes several times in between, this is one of the changes.

    Raises
    ------
    granular_response.observe.events.EventNotBracketed
        If it says the same at both ends.
    ValueError
        For an empty range, or a tolerance or a smallest load that is not positive.
    granular_response.scene.SceneError, granular_response.solve.SOLVE_ERRORS
        For a key or a value that is not allowed, for a scene without loads where these grow, and where there is no
        equilibrium.
    """
    base = described(scene)
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ValueError(f"low = {low}, high = {high}: must be finite, and low below high")
    if key == "load" and not base.loads:
        raise SceneError("loads: none in this scene, must be one or more to look along the load; or name a key")
    if key == "load" and low <= 0.0:
        raise ValueError(f"low = {low}: must be greater than 0, a factor of the scene's loads")
    tolerance = 1e-3 * (high - low) if tolerance is None else tolerance
    states: dict[float, Result] = {}
    total = 2 + max(math.ceil(math.log2(high - low) - math.log2(tolerance)), 0) if tolerance > 0 else 2

    def at(value: float) -> Result:
        if key != "load":
            return solve(base.updated({key: value}))
        below = [factor for factor in states if factor < value]
        if not below:
            return solve(base, load_factors=[value])
        return states[max(below)].continued([value])

    with contextlib.ExitStack() as stack:
        report = stack.enter_context(TerminalProgress()) if progress is True else progress or None
        done = 0

        def predicate(value: float) -> bool:
            nonlocal done
            if report:
                report(done, total, "event")
            result = at(value)
            if key == "load":
                states[value] = result
            done += 1
            return bool(happened(result))

        bracket = bisect_event(predicate, float(low), float(high), tolerance)
        if report:
            report(total, total, "event")
    return bracket
