"""Solutions as labelled datasets, and states back from them.

A dataset is in reduced units: lengths in mean disk radii, masses in mean disk masses, forces in mean disk
weights. Results have them in ``units`` (``labels.py``); datasets of studies have "1", and the unit in ``long_name``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np
import xarray as xr

from .. import __version__
from ..errors import GranularError
from ..observe.difference import match_candidates, pair_force_difference, wall_force_difference
from ..observe.floor import floor_disks, floor_force
from ..scene import Packing, Scene
from ..scene import text as scene_text
from ..scene.protocol import without_replaced
from ..solvers.problem import Problem
from ..solvers.solution import Solution
from ..solvers.timestep import time_step_reason
from ..state import (
    CONTACT_EVENTS,
    LOST_EVENTS,
    ROLLING_EVENTS,
    Box,
    Certificate,
    Contacts,
    Event,
    Reached,
    State,
    box,
    status,
)
from .labels import labelled

LENGTH, FORCE = "in mean disk radii", "in mean disk weights"

_STATE_VARIABLES = {
    "position": (("disk", "axis"), f"disk centre x, z {LENGTH}"),
    "angle": (("disk",), "rotation since the start of the preparation, counter-clockwise, in radians"),
    "velocity": (("disk", "axis"), "disk velocity in sqrt(radius g)"),
    "angular_velocity": (("disk",), "angular velocity in sqrt(g/radius)"),
}
_CONTACT_VARIABLES = {
    "overlap": f"overlap {LENGTH}; negative is a gap",
    "normal_force": f"normal contact force {FORCE}, positive in compression",
    "tangential_force": f"tangential contact force {FORCE}, along z cross n",
    "spring": f"elongation of the tangential spring {LENGTH}",
    "status": "contact status",
}
#: Stored of contacts that resist rolling.
ROLLING_VARIABLES = {
    "rolling_force": f"rolling force {FORCE}; times the reduced radius it is the couple on the first disk",
    "rolling_spring": f"elongation of the rolling spring {LENGTH}",
    "rolling_status": "status along the rolling: sliding is at the limit of the rolling force",
}
#: The system of units of everything stored.
UNITS = "reduced: mean disk radius, mean disk mass, g"


def flags(meanings: Sequence[str], kind: type[np.integer] = np.int8) -> dict[str, Any]:
    """Attributes of a variable that holds codes, by the CF conventions."""
    return {"flag_values": np.arange(len(meanings), dtype=kind), "flag_meanings": " ".join(meanings)}


STATUSES = flags(status.MEANINGS)
_WALL_FLAGS = flags(box.WALL_MEANINGS, np.int32)
_KINDS = {"pairs": ("contact", "contact"), "walls": ("wall_contact", "wall")}


#: Number of unstable directions in files where it was not determined.
NOT_DETERMINED = -1
#: Parts of a certificate that older files do not have.
ADDED_LATER = frozenset({"certificate_unbalanced_part", "certificate_rolling_excess"})


class ResultError(GranularError, ValueError):
    """A dataset that is not a result, or not one that can be continued. The message is one line."""


def variable(dims, values, long_name: str, **attributes) -> xr.Variable:
    """xr.Variable with the attributes that every stored variable has."""
    dimensions = (dims,) if isinstance(dims, str) else tuple(dims)
    # numpy's arrays are taken as they are: xarray need not find out whether they are Dask's
    return xr.Variable(
        dimensions, np.asarray(values), {"long_name": long_name, "units": "1", **attributes}, fastpath=True
    )


def _dataset(
    data: Mapping[str, xr.Variable], coordinates: Collection[str] = (), attributes: Mapping[str, Any] | None = None
) -> xr.Dataset:
    given = {name: one for name, one in data.items() if name not in coordinates}
    return xr.Dataset(given, {name: one for name, one in data.items() if name in coordinates}, attributes)


def common_candidates(states: Sequence[State], radius) -> list[State]:
    """The states on one list of candidate contacts, so that they subtract contact by contact."""
    states = list(states)
    for _ in range(2):
        for k in range(1, len(states)):
            first, other = states[0], states[k]
            if not (first.pairs.same_candidates(other.pairs) and first.walls.same_candidates(other.walls)):
                states[0], states[k] = match_candidates(first, other, radius)
    return states


def states_dataset(states: Sequence[State], dimension: str = "state") -> xr.Dataset:
    """States of one packing and one candidate list, stacked along ``dimension``."""
    return _dataset(_states(states, dimension), {"axis"})


def _states(states: Sequence[State], dimension: str) -> dict[str, xr.Variable]:
    data: dict[str, xr.Variable] = {}
    for name, (dims, long_name) in _STATE_VARIABLES.items():
        data[name] = variable((dimension, *dims), np.stack([getattr(s, name) for s in states]), long_name)
    for kind, (dim, prefix) in _KINDS.items():
        contacts: list[Contacts] = [getattr(s, kind) for s in states]
        second = "partner" if kind == "pairs" else "wall"
        first_name = f"{prefix}_disk"
        data[first_name] = variable(dim, contacts[0].first, "disk that the contact force acts on")
        if kind == "pairs":
            data[f"{prefix}_{second}"] = variable(dim, contacts[0].second, "other disk")
        else:
            data["wall_index"] = variable(dim, contacts[0].second, "wall", **_WALL_FLAGS)
        rolling = ROLLING_VARIABLES if any(one.rolling for one in contacts) else {}
        for name, long_name in {**_CONTACT_VARIABLES, **rolling}.items():
            values = np.stack([getattr(c, name) for c in contacts])
            coded = STATUSES if name.endswith("status") else {}
            data[f"{prefix}_{name}"] = variable((dimension, dim), values, long_name, **coded)
    data["load_factor"] = variable(dimension, [s.load_factor for s in states], "multiplier of the scene's loads")
    return {**data, "axis": variable("axis", ["x", "z"], "axis labels")}


def certificates_dataset(states: Sequence[State], dimension: str = "state") -> xr.Dataset:
    """The certificates of states along ``dimension``."""
    return _dataset(_certificates(states, dimension))


def _certificates(states: Sequence[State], dimension: str) -> dict[str, xr.Variable]:
    names = {
        "force_residual": f"largest unbalanced force on a disk {FORCE}",
        "torque_residual": "largest unbalanced torque on a disk in mean weight times mean radius",
        "coulomb_excess": f"largest excess of a tangential force over the Coulomb limit {FORCE}",
        "smallest_normal_force": f"smallest normal force of a closed contact {FORCE}",
        "kinetic_energy": "kinetic energy per disk in mean weight times mean radius",
        "negative_modes": f"unstable directions of the tangent stiffness ({NOT_DETERMINED}: not determined)",
        "loose_disks": "disks with fewer than two contacts",
        "unbalanced_part": "largest unbalanced force on a disk, as a part of what it bears",
    }
    if any(contacts.rolling for state in states for contacts in (state.pairs, state.walls)):
        names["rolling_excess"] = f"largest excess of a rolling force over its limit {FORCE}"
    certificates: list[Certificate] = [s.certificate for s in states]

    def number(value: float | None) -> float:
        return NOT_DETERMINED if value is None else value

    return {
        f"certificate_{name}": variable(dimension, [number(getattr(c, name)) for c in certificates], text)
        for name, text in names.items()
    }


#: What is stored of the events of a path: the fields of each, in order.
EVENTS = {
    "load_factor": "load factor at which it happens",
    "kind": "what happens",
    "first": "disk that it happens to; the one that moves farthest where an equilibrium is lost",
    "second": "the other disk, or the wall; -1 where an equilibrium is lost",
    "at_wall": "whether the contact is with a wall",
    "x": f"place of the contact, or of the disk {LENGTH}",
    "z": f"height of the contact, or of the disk {LENGTH}",
    "until": "load factor at which the path goes on",
    "displacement": f"largest displacement of a disk from a lost equilibrium to the next {LENGTH}",
    "reason": "why an equilibrium is lost",
}
EVENT_KINDS = CONTACT_EVENTS + LOST_EVENTS + ROLLING_EVENTS


def described_events(found: Sequence[tuple[int, Event]]) -> dict[str, xr.Variable]:
    """Events with the index of the state that each leads to, along ``event``; no variables where there are none."""
    if not found:
        return {}
    data = {}
    for name, text in EVENTS.items():
        values: Any = [getattr(event, name) for _, event in found]
        attributes: dict[str, Any] = {}
        if name == "kind":
            known = EVENT_KINDS if set(ROLLING_EVENTS) & set(values) else CONTACT_EVENTS + LOST_EVENTS
            values = np.array([known.index(kind) for kind in values], np.int8)
            attributes = flags([kind.replace(" ", "_") for kind in known])
        elif name == "at_wall":
            values, attributes = np.array(values, np.int8), flags(("no", "yes"))
        elif name == "reason":
            values = np.array(values, str)
        data[f"event_{name}"] = variable("event", values, text, **attributes)
    return {**data, "event_state": variable("event", [k for k, _ in found], "state that the event leads to")}


def events_from(dataset: xr.Dataset, index: int | None = None) -> list[tuple[int, Event]]:
    """Stored events with the index of the state that each leads to: of the state ``index``, or all."""
    if "event_state" not in dataset:
        return []
    states = dataset["event_state"].values
    here = slice(None) if index is None else states == range(dataset.sizes["state"])[index]
    columns = {name: dataset[f"event_{name}"].values[here].tolist() for name in EVENTS}
    columns["kind"] = [EVENT_KINDS[code] for code in columns["kind"]]
    columns["at_wall"] = list(map(bool, columns["at_wall"]))
    events = (Event(**dict(zip(columns, row, strict=True))) for row in zip(*columns.values(), strict=True))
    return list(zip(states[here].tolist(), events, strict=True))


def chosen_states(dataset: xr.Dataset, indices: Sequence[int]) -> xr.Dataset:
    """The states with these indices, in this order, and the events that lead to them."""
    count = dataset.sizes["state"]
    places = {index % count: place for place, index in enumerate(indices)}
    chosen = dataset.isel(state=list(indices))
    if "event_state" not in dataset:
        return chosen
    state = dataset["event_state"]
    chosen = chosen.isel(event=np.isin(state.values, list(places)))
    return chosen.assign(event_state=("event", [places[k] for k in chosen["event_state"].values], state.attrs))


#: What is stored of the record of each state, where it is known for one of them.
_REACHED = {
    "method": "method that found the state",
    "settled": "whether dynamics came to rest",
    "steps": "time steps of the dynamics since it began",
    "time_step": "time step of the dynamics in sqrt(radius/g)",
    "time": "time since the last ramp began in sqrt(radius/g)",
    "rebuilds": "times that candidate contacts were listed again",
    "kinetic_energy": "kinetic energy per disk before the static finish in mean weight times mean radius",
    "relaxation_steps": "time steps of the last relaxation",
    "network_fixed_steps": "time steps in which no contact opened or closed",
    "sliding_contacts": "sliding contacts when the kinetic energy had fallen below its limit",
    "mean_acceleration": "mean acceleration of disks with two contacts or more in g, at that moment",
    "loose_disks": "disks with fewer than two contacts, at that moment",
    "more_relaxations": "stretches of dynamics between tries of the static finish",
    "newton_iterations": "iterations of Newton's method",
    "finish_displacement": f"largest displacement of a disk in the static finish {LENGTH}",
    "escapes": "saddles of the energy that were left",
    "increments": "increments of the path so far, in the command that made the state",
    "factorisations": "factorisations of the path so far, in the command that made the state",
    "events_within": f"load within which the path took events together {FORCE}",
    "events_error": "what that leaves out of a force of the floor or a wall, per load, as measured",
}


def _reached(states: Sequence[State]) -> dict[str, xr.Variable]:
    """How the states were reached, along ``state``."""
    data = {}
    for name, text in _REACHED.items():
        known = [getattr(state.reached, name) for state in states]
        if name == "method":
            data["reached_method"] = variable("state", np.array([one or "" for one in known], str), text)
        elif any(one is not None for one in known):
            whole = all(one is None or isinstance(one, (bool, int, np.integer)) for one in known)
            missing = NOT_DETERMINED if whole else np.nan
            values = np.array([missing if one is None else one for one in known], np.int64 if whole else float)
            data[f"reached_{name}"] = variable("state", values, text + (" (-1: not known)" if whole else ""))
    return data


def _reached_from(one: xr.Dataset) -> dict[str, Any]:
    """The numbers of a stored record; what is not known is left out."""
    found: dict[str, Any] = {}
    for name in _REACHED:
        if f"reached_{name}" in one:
            value = one[f"reached_{name}"].values.item()
            if value not in ("", NOT_DETERMINED) and value == value:
                found[name] = bool(value) if name == "settled" else value
    return found


def load_coordinates(factors: Sequence[float]) -> dict[str, xr.Variable]:
    """Coordinates along ``load``: its index, ``load_factor``, ``step`` and ``branch``.

    Factors may repeat: ``sel(load=0.5)`` then gives every step at half the loads, which ``branch`` tells apart.
    """
    text = "multiplier of the scene's loads"
    values = np.asarray(factors, float)
    return {
        "load": variable("load", values, f"index: {text}"),
        "load_factor": variable("load", values, text),
        "step": variable("load", np.arange(1, len(values) + 1), "step of the load programme"),
        "branch": variable("load", np.array(branches(factors), str), "branch of the load programme"),
    }


def branches(factors: Sequence[float]) -> list[str]:
    """The branch of a load programme that each factor ends, from 0 on.

    "loading" beyond all loads of the same sign before, "reloading" up to the largest of them, "unloading" towards 0. A
    factor that repeats the one before is on its branch.
    """
    found: list[str] = []
    before, largest = 0.0, {True: 0.0, False: 0.0}
    for factor in factors:
        side = factor > 0.0
        if factor == before:
            found.append(found[-1] if found else "loading")
        elif abs(factor) > largest[side]:
            found.append("loading")
        else:
            grows = abs(factor) > abs(before) or (factor != 0.0 and side != (before > 0.0))
            found.append("reloading" if grows else "unloading")
        largest[side] = max(largest[side], abs(factor))
        before = factor
    return found


COORDINATES = frozenset({"axis", "branch", "component", "floor_disk", "load", "load_factor", "step", "x"})


def indexed(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with ``sel(load_factor=...)``, or ``sel(step=...)`` where load factors repeat."""
    unique = len(set(dataset["load_factor"].values.tolist())) == dataset.sizes["load"]
    return dataset.set_xindex("load_factor" if unique else "step")


def added_forces_dataset(
    rest: Sequence[State], loaded: Sequence[State], packing: Packing, dimension: str
) -> xr.Dataset:
    """What loads add at every contact, for pairs of states on one candidate list, along ``dimension``.

    Gravity is subtracted as a vector. With the geometry under load that pictures need, and the certificates.
    """
    pairs, walls = rest[0].pairs, rest[0].walls
    both = list(zip(rest, loaded, strict=True))
    text = f"contact force that the load adds, on the first disk {FORCE}"

    def status(when: str, states: Sequence[State]) -> xr.Variable:
        values = np.stack([state.pairs.status for state in states])
        return variable((dimension, "contact"), values, f"contact status {when}", **STATUSES)

    return xr.Dataset(
        {
            "position": variable(
                (dimension, "disk", "axis"),
                np.stack([state.position for state in loaded]),
                f"disk centre x, z under load {LENGTH}",
            ),
            "radius": variable("disk", packing.radius, f"disk radius {LENGTH}"),
            "contact_disk": variable("contact", pairs.first, "disk that the contact force acts on"),
            "contact_partner": variable("contact", pairs.second, "other disk"),
            "contact_added_force": variable(
                (dimension, "contact", "axis"), np.stack([pair_force_difference(a, b) for a, b in both]), text
            ),
            "contact_status_rest": status("at rest", rest),
            "contact_status": status("under load", loaded),
            "wall_disk": variable("wall_contact", walls.first, "disk that the wall's force acts on"),
            "wall_index": variable("wall_contact", walls.second, "wall", **_WALL_FLAGS),
            "wall_added_force": variable(
                (dimension, "wall_contact", "axis"), np.stack([wall_force_difference(a, b) for a, b in both]), text
            ),
            "width": variable((), packing.width, f"distance of the side walls {LENGTH}"),
        },
        coords={"axis": variable("axis", ["x", "z"], "axis labels")},
    ).merge(certificates_dataset(loaded, dimension))


def to_dataset(solution: Solution) -> xr.Dataset:
    """The labelled dataset of a solved scene.

    Dimension ``state``: at rest first, then one entry for each load factor, which ``state_load_factor`` gives.
    ``floor_force``, ``floor_force_change``, ``floor_response``, ``total_force`` and, where loads displace disks,
    ``reaction`` have the dimension ``load``, however many load factors there are; its coordinates are those of
    :func:`load_coordinates`.
    """
    problem = solution.problem
    packing = problem.packing
    own = [solution.rest, *solution.loaded]
    states = common_candidates(own, packing.radius)
    rest, loaded = states[0], states[1:]
    disks = floor_disks(states, np.flatnonzero(packing.row == 0))
    origin = float(rest.position[problem.load_disk[0], 0]) if len(problem.load_disk) == 1 else 0.5 * packing.width
    x = packing.box.separation(rest.position[disks], np.array([origin, 0.0]))[:, 0]
    by = np.argsort(x, kind="stable")
    disks, x = disks[by], x[by]
    at_rest = floor_force(rest, disks)
    forces = np.array([floor_force(s, disks) for s in loaded]).reshape(len(loaded), len(disks))
    applied = np.array([solution.applied_force(state) for state in solution.loaded], float)
    response = (forces - at_rest) / np.where(applied > 0, applied, np.nan)[:, None]
    of_states = _states(states, "state")
    data = {
        "state_load_factor": of_states.pop("load_factor"),
        **of_states,
        **described_forces(states),
        **load_coordinates(solution.load_factors),
        "floor_force_rest": variable("floor_disk", at_rest, f"vertical floor force at rest {FORCE}"),
        "floor_force": variable(("load", "floor_disk"), forces, f"vertical floor force under load {FORCE}"),
        **floor_force_change(forces, at_rest),
        "floor_response": variable(
            ("load", "floor_disk"),
            response,
            "vertical floor force that the load adds, per total magnitude of the applied forces (NaN without any)",
        ),
        "radius": variable("disk", packing.radius, f"disk radius {LENGTH}"),
        "mass": variable("disk", packing.mass, "disk mass in mean disk masses"),
        "row": variable("disk", packing.row, "row on the lattice from the bottom, -1 without lattice"),
        "loaded_disk": variable("load_point", problem.load_disk, "disks that carry the loads"),
        "applied_load": variable(
            ("load_point", "component"), problem.load, f"force x, z {FORCE} and torque at load factor 1"
        ),
        "total_force": variable("load", applied, f"total magnitude of the applied forces {FORCE}"),
        **(_reaction(solution) if loaded and len(problem.held) else {}),
        **_listed(own, states),
        **_certificates(states, "state"),
        **_reached(states),
        **described_events([(k, event) for k, state in enumerate(own) for event in state.reached.events]),
        "floor_disk": variable("floor_disk", disks, "index of the floor disk"),
        "x": variable("floor_disk", x, f"rest position from the loaded disk {LENGTH}"),
        "component": variable("component", ["force_x", "force_z", "torque"], "component labels"),
    }
    moved = any(state.reached.time_step is not None for state in states)
    methods = {"rest": solution.rest_choice.method, "load": getattr(solution.load_choice, "method", "none")}
    reasons = {
        "rest": solution.rest_choice.reason,
        "load": getattr(solution.load_choice, "reason", "no loads"),
    }
    attributes = {
        "title": "quasi-static response of a granular packing",
        "package": "granular_response",
        "package_version": __version__,
        "scene": solution.scene.to_yaml(),
        "scene_folder_note": "paths in the scene are relative to the folder of the scene file",
        "width": packing.width,
        "sides": "periodic" if packing.box.periodic else "walls",
        "method": json.dumps(methods),
        "method_reason": json.dumps(reasons),
        **({"time_step": time_step_reason(problem)} if moved else {}),
        "stable": _verdict([s.certificate.stable for s in states]),
        "settled": _verdict([s.reached.settled is not False for s in states]),
        "units": UNITS,
    }
    return indexed(labelled(_dataset(data, COORDINATES, attributes)))


def _own_places(own: Contacts, common: Contacts) -> np.ndarray:
    """(m,) place of each common candidate in a state's own list, -1 for those that it has not."""
    places = np.full(len(common.first), -1, np.int32)
    size = int(common.second.max(initial=0)) + 1
    key, whole = (c.first.astype(np.int64) * size + c.second for c in (own, common))
    order = np.argsort(whole)
    places[order[np.searchsorted(whole, key, sorter=order)]] = np.arange(len(key))
    return places


def _listed(own: Sequence[State], states: Sequence[State]) -> dict[str, xr.Variable]:
    """Which of the common candidates each state listed itself and in what order, where that is not the common one."""
    found = {}
    for kind, (dim, prefix) in _KINDS.items():
        common = getattr(states[0], kind)
        places = np.stack([_own_places(getattr(state, kind), common) for state in own])
        if (places != np.arange(places.shape[1])).any():
            text = "place among the candidates of the state when it was solved, -1 for none of them"
            found[f"{prefix}_own_place"] = variable(("state", dim), places, text)
    return found


def _as_solved(dataset: xr.Dataset, index: int) -> State:
    """A stored state with its own lists of candidates."""
    state = state_from(dataset, index)

    def own(contacts: Contacts, prefix: str) -> Contacts:
        if f"{prefix}_own_place" not in dataset:
            return contacts
        places = dataset[f"{prefix}_own_place"].values[index]
        kept = np.argsort(places, kind="stable")[np.count_nonzero(places < 0) :]
        return Contacts(*(getattr(contacts, field.name)[kept] for field in fields(Contacts)))

    return replace(state, pairs=own(state.pairs, "contact"), walls=own(state.walls, "wall"))


def _reaction(solution: Solution) -> dict[str, xr.Variable]:
    """What holds displaced disks, under each load."""
    values = np.stack([solution.reaction(state) for state in solution.loaded])
    text = f"force x, z with which each load holds its disk at its displacement {FORCE}; 0 along free directions"
    return {"reaction": variable(("load", "load_point", "axis"), values, text)}


def floor_force_change(under_load: np.ndarray, at_rest: np.ndarray) -> dict[str, xr.Variable]:
    """What loads add to the force on each floor disk, defined after unloading too."""
    text = f"vertical floor force that the load adds {FORCE}"
    return {"floor_force_change": variable(("load", "floor_disk"), under_load - at_rest, text)}


def described_forces(states: Sequence[State]) -> dict[str, xr.Variable]:
    """Contact forces as vectors, on the disk named first."""
    text = f"contact force x, z on the first disk {FORCE}"
    return {
        "contact_force": variable(("state", "contact", "axis"), np.stack([s.pair_force() for s in states]), text),
        "wall_force": variable(("state", "wall_contact", "axis"), np.stack([s.wall_force() for s in states]), text),
    }


def _verdict(all_states: Sequence[bool | None]) -> str:
    """``no`` if it fails for one state, ``not determined`` if for one nobody looked, else ``yes``."""
    if any(one is False for one in all_states):
        return "no"
    return "not determined" if None in all_states else "yes"


def state_from(dataset: xr.Dataset, index: int = -1) -> State:
    """A state back from a dataset, with its certificate, equal to the stored one to the last bit: a restart.

    Raises
    ------
    ResultError
        When the dataset holds no states.
    """
    if "contact_spring" not in dataset:
        raise ResultError("the dataset holds no states (variable contact_spring is missing)")
    one = dataset.isel(state=index)
    stored = {field.name: f"certificate_{field.name}" for field in fields(Certificate)}
    certificate = None
    if set(stored.values()) - ADDED_LATER <= set(one.variables):
        numbers: dict[str, Any] = {
            name: one[variable].values.item() for name, variable in stored.items() if variable in one.variables
        }
        if numbers["negative_modes"] == NOT_DETERMINED:
            numbers["negative_modes"] = None
        certificate = Certificate(**numbers)

    def contacts(prefix: str, partner: str) -> Contacts:
        values = [one[f"{prefix}_{name}"].values for name in _CONTACT_VARIABLES]
        rolling = {
            name: one[f"{prefix}_{name}"].values for name in ROLLING_VARIABLES if f"{prefix}_{name}" in one.variables
        }
        first, second = (one[name].values.astype(np.int32) for name in (f"{prefix}_disk", partner))
        return Contacts(first, second, *values, **rolling)

    return State(
        position=one["position"].values.astype(float),
        angle=one["angle"].values.astype(float),
        velocity=one["velocity"].values.astype(float),
        angular_velocity=one["angular_velocity"].values.astype(float),
        pairs=contacts("contact", "contact_partner"),
        walls=contacts("wall", "wall_index"),
        box=Box(float(dataset.attrs["width"]), dataset.attrs.get("sides") == "periodic"),
        load_factor=float(one["state_load_factor" if "state_load_factor" in one else "load_factor"]),
        reached=Reached(
            certificate=certificate,
            events=tuple(event for _, event in events_from(dataset, index)),
            **_reached_from(one),
        ),
    )


def solution_from(dataset: xr.Dataset, *, folder: str | os.PathLike[str] | None = None) -> Solution:
    """The solution that a dataset was made from, to be continued (``solvers.continue_solution``).

    ``folder`` is that of the scene file, for a packing from a table.

    Raises
    ------
    ResultError
        When the dataset holds no states, or another packing than its scene describes.
    granular_response.scene.SceneError
        When the scene cannot be read.
    """
    rest = state_from(dataset, 0)
    scene = scene_of(dataset, folder=folder)
    problem = Problem.from_scene(scene).with_loads(rest.position)
    packed = problem.packing
    same = all(np.array_equal(getattr(packed, name), dataset[name].values) for name in ("radius", "mass"))
    if not same or packed.box != rest.box:
        raise ResultError("the table of disks has changed since the result was made")
    rest, *loaded = (_as_solved(dataset, k) for k in range(dataset.sizes["state"]))
    if rest.reached.certificate is None:
        raise ResultError("holds no certificates, from which a run goes on")
    return Solution(
        scene=scene,
        problem=problem,
        rest=rest,
        loaded=tuple(loaded),
    )


def scene_of(dataset: xr.Dataset, *, folder=None) -> Scene:
    """The scene that a dataset was made from, also by a version that had other keys for how it was to be solved."""
    return Scene.from_dict(without_replaced(scene_text.read(dataset.attrs["scene"])), folder=folder)
