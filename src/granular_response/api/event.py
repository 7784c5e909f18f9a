"""Where something happens for the first time: read from the events of a load path, or narrowed down by bisection."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from numbers import Real
from typing import Any

from ..errors import check_positive, require
from ..scene import Scene, SceneError
from ..state import Event
from ..studies.brackets import Bracket, EventNotBracketed
from ..studies.path import Happening, LoadPath
from ..studies.search import bisect_event, unchanged
from ..sweeps.tasks import Progress
from .event_table import check_kind
from .result import Result, described, solve, vouched
from .terminal import shown

#: Load (mean disk weights) before and beyond an event at which its contact has its status before and after: a thousand
#: times what a path leaves of the event.
BESIDE = 1e-6
#: Part by which a path that takes events together may exceed the load within which it does.
LONGER = 1.1


def find_event(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    happened: Callable[[Result], bool] | str,
    low: float,
    high: float,
    *,
    where: Callable[[Event], bool] | None = None,
    key: str = "load",
    tolerance: float | None = None,
    progress: Progress | bool = True,
) -> Bracket:
    """Find the load, or the value of a scene parameter, at which something happens.

    Parameters
    ----------
    scene : a scene, nested mappings, or the path of a scene file.
    happened : a kind of event, such as ``"opens"``: the first one along the path is found. Or a function that is called
        with a :class:`Result` and returns whether its last state fulfils a condition, such as
        ``lambda result: result.floor_response.max() > 0.2``.
    low, high : ends of the range, at which the condition must differ: load factors (``low`` above 0, or 0 for a kind of
        event), or values of the scene parameter.
    where : restricts events: ``lambda event: event.at_wall``.
    key : "load": the load grows, and each state continues from the nearest one below it. Or a scene parameter with real
        values, such as contact.friction: each value is solved separately, under its whole load programme.
    tolerance : width of the bracket at which bisection stops; a thousandth of the range if left out.
    progress : as of :func:`sweep`.

    Returns
    -------
    A bracket ``low``, ``high``; ``at_low`` is the value of the condition at its lower end.

    A kind of event along the load is read from one load path. ``low`` and ``high`` coincide unless equilibrium is lost
    there, or events were processed in a batch; then they are the ends of the dynamic jump or of the increment.

    A function of the result is bisected, along a load path among its events first. The bracket then either contains one
    event and is 2e-6 mg wide, or contains none, so that the response is smooth within it. If the condition changes
    several times between ``low`` and ``high``, one of the changes is found.

    Raises
    ------
    granular_response.EventNotBracketed
        If the condition is the same at both ends, or no such event lies between them.
    ValueError
        For an empty range, a tolerance or lower load that is not positive, an unknown kind of event, or ``where`` with
        a function of the result.
    granular_response.SceneError, granular_response.SolveError
        For a key or a value that is not allowed, a scene without loads, a kind of event if the scene is not solved
        along a load path, and if there is no equilibrium.

    Examples
    --------
    >>> scene = gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9), loads=[gr.Load(disk="top-centre", force=(0, -2))])
    >>> opening = gr.find_event(scene, "opens", 0.0, 1.0).low  # load factor of the first contact that opens
    >>> more = gr.find_event(scene, lambda result: len(result.events) > 20, 0.01, 1.0, tolerance=1e-3)
    >>> 0.0 < opening < 1.0, more.low < more.high
    (True, True)
    """
    base = described(scene)
    kind = happened if isinstance(happened, str) else None
    if kind is not None:
        check_kind(kind)
    elif not callable(happened):
        raise ValueError(f"happened = {happened!r}: must be a kind of event, or a function of the result")
    elif where is not None:
        raise ValueError("where: is asked of events, must be left out with a function of the result")
    ends: tuple[Any, Any] = low, high
    rule = f"low = {low!r}, high = {high!r}: must be finite numbers, and low below high"
    require(all(isinstance(end, Real) and math.isfinite(end) for end in ends) and low < high, rule)
    low, high = float(low), float(high)
    rule = "loads: none in this scene, must be one or more to look along the load; or name a key"
    require(key != "load" or base.loads, rule, SceneError)
    if key == "load" and (low < 0.0 or (kind is None and low == 0.0)):
        least = "greater than 0" if kind is None else "0 or greater"
        raise ValueError(f"low = {low}: must be {least}, a factor of the scene's loads")
    tolerance = 1e-3 * (high - low) if tolerance is None else tolerance
    check_positive(tolerance=tolerance)
    with shown(progress) as asked_for:
        report: Progress = asked_for or (lambda *_: None)
        if kind is not None and key == "load":
            report(0, 1, "event")
            bracket = _first(solve(base, load_factors=[high], progress=False), kind, where, low)
        else:
            asked = happened if callable(happened) else lambda result: bool(_events(result, happened, where))
            bracket = _searched(base, asked, key, low, high, tolerance, report)
        report(bracket.evaluations, bracket.evaluations, "event")
    return bracket


def _events(result: Result, kind: str, where: Callable[[Event], bool] | None) -> list[Event]:
    """The events of a kind on the way to the last state. Raises SceneError where no path was followed."""
    choice = result._solved.load_choice
    if choice is None or choice.method != "path":
        raise SceneError(
            f"protocol.method = {result.scene.protocol.method}: must be path where events are asked for, "
            f"this scene's loads are followed by {choice.method if choice else 'none'}"
        )
    return [event for event in result.events.of(kind) if where is None or where(event)]


def _first(result: Result, kind: str, where: Callable[[Event], bool] | None, low: float) -> Bracket:
    """The load of the first event of a kind from the load factor ``low`` on."""
    event = next((event for event in _events(result, kind, where) if event.load_factor >= low), None)
    if event is None:
        (high,) = result.load_factors
        asked = "" if where is None else " of those asked for"
        raise EventNotBracketed(f"no event {kind!r}{asked} between load factors {low:g} and {high:g}")
    begin, end = float(event.load_factor), max(float(event.load_factor), float(event.until))
    within = result.loaded[-1].reached.events_within
    if within is not None and begin == end:
        begin = max(end - LONGER * within / result._solved.problem.load_size, 0.0)
    return Bracket(low=begin, high=end, at_low=False, evaluations=1)


def _searched(
    base: Scene,
    happened: Callable[[Result], bool],
    key: str,
    low: float,
    high: float,
    tolerance: float,
    report: Progress,
) -> Bracket:
    """By bisection; along the load among the events of the path first, each looked at from both sides."""
    total = 2 + max(math.ceil(math.log2(high - low) - math.log2(tolerance)), 0)  # both ends, and each halving
    known: dict[float, bool] = {}
    path: LoadPath | None = None

    def says(value: float) -> bool:
        if value not in known:
            report(len(known), max(total, len(known) + 1), "event")
            one = vouched(path.solution(value)) if path else solve(base.updated({key: value}), progress=False)
            known[value] = bool(happened(one))
        return known[value]

    if key != "load":
        return bisect_event(says, low, high, tolerance)
    report(0, total, "event")
    path = LoadPath.from_solution(solve(base, load_factors=[low, high], progress=False)._solved)
    if says(low) == says(high):
        raise EventNotBracketed(unchanged(says(low), low, high))
    changed = Happening(lambda state: says(state.load_factor) != says(low), "what is asked for has changed")
    ends = path.first([low, high], changed, tolerance=tolerance, beside=BESIDE / path.problem.load_size)
    return Bracket(*ends, says(low), len(known))
