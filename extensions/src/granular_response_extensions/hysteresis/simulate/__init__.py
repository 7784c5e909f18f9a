"""Loading, unloading and loading again: what is nonlinear, and what of that is irreversible.

Each packing is loaded along one path of equilibria. From every force F at which the load turns it goes back to none and
up to F again; the paths begin at the state that loading has reached, so that each loop is the first one of its packing.

Events, along the first loading: the first opening of a contact, the end of the linear range (the response at x = 0
differs by 1 % from that to the smallest force, as in Figs. 6 and 20), and the end of the reversible range: a loop to
that force leaves some floor force changed by more than a part of the largest change under the load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from functools import partial
from itertools import pairwise

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.solvers.solution import loaded_states
from granular_response.state import FloatArray
from granular_response.store.result import common_candidates
from granular_response.store.variables import WEIGHTS, variable
from granular_response_extensions.hysteresis.parameters import Parameters
from granular_response_extensions.hysteresis.simulate.loops import EVENTS, CycledPacking, ShownLoop, Turn
from granular_response_extensions.surveyed import measured
from granular_response_paper.datasets import labelled
from granular_response_paper.records import axes, column, columns, labels, parts, record, stacked, table


@record
class EventBracket:
    low: float = column(f"force before the event {WEIGHTS}; 0: happened at the first one")
    high: float = column(f"force at which it has happened {WEIGHTS}; nan: not up to low")


@record
class PackingLoops:
    """One packing; ``measured`` has a :class:`Turn` in each line, ``brackets`` a :class:`EventBracket` of EVENTS."""

    measured: FloatArray = column("; ".join(one.long_name for one in columns(Turn).values()), "line", "quantity")
    brackets: FloatArray = column(
        f"forces {WEIGHTS} before and at: {', '.join(EVENTS)}; nan: not up to low", "event", "bracket"
    )
    shown: ShownLoop | None = None  #: not of the survey's


@record
class PackingKey:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column("friction between disks")
    realization: int = column("realization of the disorder")


def grid(forces: Sequence[float], increments: int) -> list[float]:
    """Loads of all ways, from 0 on: ``increments`` steps to each of ``forces`` from the one before.

    Loading and unloading pass the same loads, so where they pass the same states their works cancel to the last digits.
    """
    steps = [0.0]
    for before, force in pairwise((0.0, *forces)):
        steps += [before + (force - before) * k / increments for k in range(1, increments)] + [force]
    return steps


def compute(
    scene: Scene, forces: Sequence[float], increments: int, left: float, width: float, tolerance: float
) -> PackingLoops:
    """One packing.

    ``width`` is that of the Gaussian at x = 0; 0 for a lattice, whose response is not smoothed. Raises what
    ``LoadPath.of`` and ``loaded_states`` raise.
    """
    packing = CycledPacking(scene, width)
    path, loads = packing.path, grid(forces, increments)
    first = [path.rest, *path.through(loads[1:])]
    found = []
    for force in forces:
        turn = loads.index(force)
        ways = [*loads[turn - 1 :: -1], *loads[1 : turn + 1]]
        further = loaded_states(packing.problem, first[turn], ways)[1]
        states = common_candidates([*first[: turn + 1], *further], packing.problem.packing.radius)
        found.append(packing.turn(states, turn, force, forces[0]))
    return PackingLoops(
        np.array([astuple(turn) for turn, _ in found], float),
        np.array(packing.events(forces, left, tolerance)),
        found[-1][1],
    )


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``loops`` (case, realization, turn), ``events`` (case, realization, event), ``curves`` and ``floor``."""
    cases, along = parameters.cases, ("case", "realization")
    # roughly how long a packing takes: friction, then how far it is loaded
    work = [case.forces[-1] * (1.0 + 10.0 * (case.friction > 0.0)) for case in cases]
    outcomes = measured(parameters, "packings", packings, task, PackingLoops, work=lambda place: work[place[0]])
    coordinates = labels("case", cases, polydispersity="polydispersity", friction="friction between disks")
    loops = table({at: Turn(*row) for at, row in parts(outcomes, "measured").items()}, *along, "turn")
    force = stacked({(c,): case.forces for c, case in enumerate(cases)}, float)
    loops["force"] = variable(("case", "turn"), force, f"force at which the load turns {WEIGHTS}")
    events = table({at: EventBracket(*ends) for at, ends in parts(outcomes, "brackets").items()}, *along, "event")
    events["definition"] = variable("event", list(EVENTS.values()), "what counts as the event")
    shown = table([outcomes[c, 0].shown for c in range(len(cases))], "case")
    shown = shown.assign_coords(coordinates | axes(branch=(("loading", "unloading", "loading again"), "way")))
    event = axes(event=(EVENTS, "what happens"))
    datasets = {
        "loops": loops.assign_coords(coordinates),
        "events": events.assign_coords(coordinates | event).assign_attrs(left=parameters.left),
        "curves": shown[["load", "displacement"]],
        "floor": shown[["added", "x"]],
    }
    return labelled(datasets, parameters.base)


def packings(parameters: Parameters, *, surveyed: bool) -> dict[tuple[int, int], PackingKey]:
    """The packings of the survey, or all others, by their cases and realizations."""
    return {
        (c, r): PackingKey(case.polydispersity, case.friction, r)
        for c, case in enumerate(parameters.cases)
        for r in range(case.realizations + case.surveyed)
        if (r >= case.realizations) == surveyed
    }


def task(parameters: Parameters, key: PackingKey) -> partial[PackingLoops]:
    """One of these packings."""
    case = next(one for one in parameters.cases if (one.polydispersity, one.friction) == astuple(key)[:2])
    width = parameters.width if case.polydispersity else 0.0
    scene = parameters.of(case, key.realization)
    return partial(compute, scene, case.forces, case.increments, parameters.left, width, parameters.tolerance)
