"""Solutions as labelled datasets, states back from them, and their contacts as a table.

A dataset is in reduced units: lengths in mean disk radii, masses in mean disk masses, forces in mean disk
weights. What its variables are is said in ``variables.py``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from .. import __version__
from ..errors import GranularError, require
from ..observe.difference import match_candidates, pair_force_difference, wall_force_difference
from ..observe.floor import floor_disks, floor_force
from ..scene import Packing, Scene
from ..scene import text as scene_text
from ..scene.laboratory import FORCE, LENGTH
from ..scene.material import KNOWN_LAWS
from ..solvers.problem import Problem
from ..solvers.solution import Solution
from ..solvers.timestep import time_steps_taken
from ..state import CONTACT_EVENTS, LOST_EVENTS, ROW_EVENTS, ROWS, Box, Certificate, Contacts, Event, Reached, State
from ..state.box import WALL_MEANINGS, FloatArray
from ..state.state import MEANINGS
from .variables import (
    CERTIFICATE,
    EVENT_KINDS,
    EVENTS,
    NOT_DETERMINED,
    RADII,
    REACHED,
    VARIABLES,
    WEIGHTS,
    contact_names,
    described,
    flags,
    labelled,
    variable,
)

#: The system of units of everything stored.
UNITS = "reduced: mean disk radius, mean disk mass, g"

STATUSES = flags(MEANINGS)
_MOTION = ("position", "angle", "velocity", "angular_velocity")
#: By what the names of variables of contacts begin with: their list in a state, and the variables with the disk and
#: with the other disk, or the wall.
CONTACTS = {"contact": ("pairs", "contact_disk", "contact_partner"), "wall": ("walls", "wall_disk", "wall_index")}


class ResultError(GranularError, ValueError):
    """A dataset that is not a result, or not one that can be continued. The message is one line."""


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
    stacked = partial(described, along=dimension)
    data = {name: stacked(name, [getattr(state, name) for state in states]) for name in _MOTION}
    for prefix, (kind, first, second) in CONTACTS.items():
        contacts: list[Contacts] = [getattr(state, kind) for state in states]
        data |= {first: described(first, contacts[0].first), second: described(second, contacts[0].second)}
        for name in contact_names(max(one.rows for one in contacts)):
            values = [getattr(one, name) for one in contacts]
            data[f"{prefix}_{name}"] = stacked(f"{prefix}_{name}", values)
    data["load_factor"] = stacked("state_load_factor", [state.load_factor for state in states])
    return xr.Dataset({**data, "axis": described("axis", ["x", "z"])})


def certificates_dataset(states: Sequence[State], dimension: str = "state") -> xr.Dataset:
    """The certificates of states along ``dimension``."""
    rolls = any(contacts.rows > 1 for state in states for contacts in (state.pairs, state.walls))
    found = {}
    for name in CERTIFICATE:
        if name != "rolling_excess" or rolls:
            values = [getattr(state.certificate, name) for state in states]
            numbers = [NOT_DETERMINED if value is None else value for value in values]
            found[f"certificate_{name}"] = described(f"certificate_{name}", numbers, along=dimension)
    if any(state.certificate.undetermined for state in states):
        mask = np.zeros((len(states), len(states[0].position)), np.int8)
        for row, state in zip(mask, states, strict=True):
            row[list(state.certificate.undetermined)] = 1
        found["undetermined"] = described("undetermined", mask, along=dimension)
    return xr.Dataset(found)


def described_events(found: Sequence[tuple[int, Event]]) -> dict[str, xr.Variable]:
    """Events with the index of the state that each leads to, along ``event``; no variables where there are none."""
    if not found:
        return {}
    data = {}
    for name in EVENTS:
        values: Any = [getattr(event, name) for _, event in found]
        attributes: dict[str, Any] = {}
        if name == "kind":
            known = EVENT_KINDS if set(ROW_EVENTS[1]) & set(values) else CONTACT_EVENTS + LOST_EVENTS
            values = np.array([known.index(kind) for kind in values], np.int8)
            attributes = flags([kind.replace(" ", "_") for kind in known])
        elif name == "at_wall":
            values = np.array(values, np.int8)
        data[f"event_{name}"] = described(f"event_{name}", values, **attributes)
    return {**data, "event_state": described("event_state", [k for k, _ in found])}


def stored_values(dataset: xr.Dataset, prefix: str, names: Iterable[str]) -> dict[str, Any]:
    """The values of variables ``prefix + name``, by ``name``, as far as a dataset has them."""
    return {name: dataset[prefix + name].values for name in names if prefix + name in dataset}


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


def _reached(states: Sequence[State]) -> dict[str, xr.Variable]:
    """How the states were reached, along ``state``; a record that none of them has is left out."""
    data = {}
    for name in REACHED:
        known = [getattr(state.reached, name) for state in states]
        if name == "method":
            data["reached_method"] = described("reached_method", [one or "" for one in known])
        elif any(one is not None for one in known):
            whole = all(one is None or isinstance(one, (bool, int, np.integer)) for one in known)
            missing, kind, said = (NOT_DETERMINED, np.int64, " (-1: not known)") if whole else (np.nan, float, "")
            own = f"reached_{name}"
            values = np.array([missing if one is None else one for one in known], kind)
            data[own] = described(own, values, text=VARIABLES[own].text + said)
    return data


def _reached_from(one: xr.Dataset) -> dict[str, Any]:
    """The numbers of a stored record; what is not known is left out."""
    known = {name: value.item() for name, value in stored_values(one, "reached_", REACHED).items()}
    known = {name: value for name, value in known.items() if value not in ("", NOT_DETERMINED) and value == value}
    return {name: bool(value) if name == "settled" else value for name, value in known.items()}


def load_coordinates(factors: Sequence[float]) -> dict[str, xr.Variable]:
    """Coordinates along ``load``: its index, ``load_factor``, ``step`` and ``branch``.

    Factors may repeat: ``sel(load=0.5)`` then gives every step at half the loads, which ``branch`` tells apart.
    """
    values = np.asarray(factors, float)
    found = {
        "load": values,
        "load_factor": values,
        "step": np.arange(1, len(values) + 1),
        "branch": np.array(load_branches(factors), str),
    }
    return {name: described(name, one) for name, one in found.items()}


def load_branches(factors: Sequence[float]) -> list[str]:
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
    statuses, statuses_rest = ([one.pairs.status for one in states] for states in (loaded, rest))
    text = f"contact force that the load adds, on the first disk {WEIGHTS}"
    under_load = f"disk centre x, z under load {RADII}"
    stacked = partial(described, along=dimension)
    return xr.Dataset(
        {
            "position": stacked("position", [one.position for one in loaded], text=under_load),
            "radius": described("radius", packing.radius),
            "contact_disk": described("contact_disk", pairs.first),
            "contact_partner": described("contact_partner", pairs.second),
            "contact_added_force": stacked("contact_force", list(map(pair_force_difference, rest, loaded)), text=text),
            "contact_status_rest": stacked("contact_status", statuses_rest, text="contact status at rest"),
            "contact_status": stacked("contact_status", statuses, text="contact status under load"),
            "wall_disk": described("wall_disk", walls.first, text="disk that the wall's force acts on"),
            "wall_index": described("wall_index", walls.second),
            "wall_added_force": stacked("wall_force", list(map(wall_force_difference, rest, loaded)), text=text),
            "width": variable((), packing.width, f"distance of the side walls {RADII}"),
        },
        coords={"axis": described("axis", ["x", "z"])},
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
    alone = len(set(problem.load_disk.tolist())) == 1
    origin = float(rest.position[problem.load_disk[0], 0]) if alone else 0.5 * packing.width
    x = packing.box.separation(rest.position[disks], np.array([origin, 0.0]))[:, 0]
    by = np.argsort(x, kind="stable")
    disks, x = disks[by], x[by]
    at_rest = floor_force(rest, disks)
    forces = np.array([floor_force(s, disks) for s in loaded]).reshape(len(loaded), len(disks))
    change = forces - at_rest
    applied = np.array([solution.applied_force(state) for state in solution.loaded], float)
    of_states = dict(states_dataset(states).variables)
    data: dict[Any, xr.Variable] = {"state_load_factor": of_states.pop("load_factor"), **of_states}
    values: dict[str, Any] = {
        "contact_force": [state.pair_force() for state in states],
        "wall_force": [state.wall_force() for state in states],
        "floor_force_rest": at_rest,
        "floor_force": forces,
        "floor_force_change": change,
        "floor_response": change / np.where(applied > 0, applied, np.nan)[:, None],
        "radius": packing.radius,
        "mass": packing.mass,
        "row": packing.row,
        "loaded_disk": problem.load_disk,
        "applied_load": problem.load,
        "total_force": applied,
        "floor_disk": disks,
        "x": x,
        "component": ["force_x", "force_z", "torque"],
    }
    if packing.given is not None:
        values["distance_from_given"] = np.stack([np.asarray(packing.moved(state.position)) for state in own])
    if loaded and len(problem.held):
        values["reaction"] = np.stack([solution.reaction(state) for state in solution.loaded])
    data |= load_coordinates(solution.load_factors) | {name: described(name, one) for name, one in values.items()}
    data |= _listed(own, states) | dict(certificates_dataset(states).variables) | _reached(states)
    data |= described_events([(k, event) for k, state in enumerate(own) for event in state.reached.events])
    moved = any(state.reached.time_step is not None for state in states)
    choices = {"rest": solution.rest_choice, "load": solution.load_choice}
    law = KNOWN_LAWS[solution.scene.contact.law].law  # from outside the package: its module registers it
    attributes = {
        "title": "quasi-static response of a granular packing",
        "package": "granular_response",
        "package_version": __version__,
        "scene": solution.scene.to_yaml(),
        "scene_folder_note": "paths in the scene are relative to the folder of the scene file",
        **({} if law is None else {"law_module": law.__module__}),
        **({"packing_frame": packing.frame} if packing.frame else {}),
        "width": packing.width,
        "sides": "periodic" if packing.box.periodic else "walls",
        "method": json.dumps({stage: getattr(one, "method", "none") for stage, one in choices.items()}),
        "method_reason": json.dumps({stage: getattr(one, "reason", "no loads") for stage, one in choices.items()}),
        **({"time_step": time_steps_taken(problem, solution.rest)} if moved else {}),
        "stable": _verdict([s.certificate.stable for s in states]),
        "settled": _verdict([s.reached.settled is not False for s in states]),
        "units": UNITS,
    }
    coordinates = {name: data.pop(name) for name in [*data] if name in COORDINATES}
    return indexed(labelled(xr.Dataset(data, coordinates, attributes)))


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
    for prefix, (kind, *_) in CONTACTS.items():
        common = getattr(states[0], kind)
        places = np.stack([_own_places(getattr(state, kind), common) for state in own])
        if (places != np.arange(places.shape[1])).any():
            found[f"{prefix}_own_place"] = described(f"{prefix}_own_place", places)
    return found


def _as_solved(dataset: xr.Dataset, index: int) -> State:
    """A stored state with its own lists of candidates."""
    state = state_from(dataset, index)

    def own(contacts: Contacts, prefix: str) -> Contacts:
        if f"{prefix}_own_place" not in dataset:
            return contacts
        places = dataset[f"{prefix}_own_place"].values[index]
        kept = np.argsort(places, kind="stable")[np.count_nonzero(places < 0) :]
        return Contacts(**{name: values[kept] for name, values in vars(contacts).items()})

    return replace(state, pairs=own(state.pairs, "contact"), walls=own(state.walls, "wall"))


def _verdict(all_states: Sequence[bool | None]) -> str:
    """``no`` if it fails for one state, ``not determined`` if for one nobody looked, else ``yes``."""
    if any(one is False for one in all_states):
        return "no"
    return "not determined" if None in all_states else "yes"


def state_from(dataset: xr.Dataset, index: int = -1) -> State:
    """A state back from a dataset, with its certificate, equal to the stored one to the last bit: a restart.

    Raises ResultError when the dataset holds no states.
    """
    rule = "the dataset holds no states (variable contact_spring is missing)"
    require("contact_spring" in dataset, rule, ResultError)
    one = dataset.isel(state=index)
    certificate = None
    if "certificate_force_residual" in one:
        numbers = {name: value.item() for name, value in stored_values(one, "certificate_", CERTIFICATE).items()}
        if numbers["negative_modes"] == NOT_DETERMINED:
            numbers["negative_modes"] = None
        free = np.flatnonzero(one["undetermined"].values).tolist() if "undetermined" in one else []
        certificate = Certificate(**numbers, undetermined=tuple(free))

    def contacts(prefix: str) -> Contacts:
        found = stored_values(one, f"{prefix}_", contact_names())
        first, second = (one[name].values.astype(np.int32) for name in CONTACTS[prefix][1:])
        return Contacts(first, second, **found)

    return State(
        **{name: one[name].values.astype(float) for name in _MOTION},
        pairs=contacts("contact"),
        walls=contacts("wall"),
        box=Box.of(dataset.attrs),
        load_factor=float(one["state_load_factor" if "state_load_factor" in one else "load_factor"]),
        reached=Reached(
            certificate=certificate,
            events=tuple(event for _, event in events_from(dataset, index)),
            **_reached_from(one),
        ),
    )


def solution_from(dataset: xr.Dataset, *, folder: str | os.PathLike[str] | None = None) -> Solution:
    """The solution that a dataset was made from, to be continued (``solvers.continue_solution``).

    ``folder`` is that of the scene file, for a packing from a table. Raises ResultError when the dataset holds no
    states, or another packing than its scene describes, SceneError when the scene cannot be read.
    """
    rest = state_from(dataset, 0)
    scene = scene_of(dataset, folder=folder)
    problem = Problem.from_scene(scene).with_loads(rest.position)
    packed = problem.packing
    same = all(np.array_equal(getattr(packed, name), dataset[name].values) for name in ("radius", "mass"))
    require(same and packed.box == rest.box, "the table of disks has changed since the result was made", ResultError)
    rest, *loaded = (_as_solved(dataset, k) for k in range(dataset.sizes["state"]))
    return Solution(scene=scene, problem=problem, rest=rest, loaded=tuple(loaded))


def scene_of(dataset: xr.Dataset, *, folder: str | os.PathLike[str] | None = None) -> Scene:
    """The scene that a dataset was made from. Raises ResultError for a law whose module has not been imported."""
    data = scene_text.read(dataset.attrs["scene"])
    contact = data.get("contact") if isinstance(data, Mapping) else None
    law = contact.get("law") if isinstance(contact, Mapping) else None
    module = dataset.attrs.get("law_module")
    if isinstance(law, str) and law not in KNOWN_LAWS and isinstance(module, str):
        cure = f"the module {module}, which must be imported (on the command line --import {module})"
        if module == "__main__":
            cure = "the script that made the result, which must register it"
        raise ResultError(f"contact.law = {law!r}: is a law of {cure}")
    return Scene.from_dict(data, folder=folder)


def contact_table(state: State, radius: FloatArray) -> Any:
    """A ``pandas.DataFrame`` of the closed contacts of disks with ``radius`` (n,), those between disks first."""
    pairs, walls = state.pairs, state.walls
    between, at_wall = pairs.touching, walls.touching
    middle = (radius[pairs.first] - 0.5 * pairs.overlap)[:, None] * state.pair_normal()
    on_disks = (state.position[pairs.first] - middle)[between]
    on_walls = state.box.on_wall(state.position[walls.first], walls.second)[at_wall]
    point = np.concatenate([on_disks, on_walls])

    def joined(name: str) -> np.ndarray:
        return np.concatenate([getattr(pairs, name)[between], getattr(walls, name)[at_wall]])

    columns = {
        "first": joined("first"),
        "second": np.concatenate([pairs.second[between], np.full(at_wall.sum(), -1, np.int32)]),
        "wall": np.array([""] * between.sum() + [WALL_MEANINGS[k] for k in walls.second[at_wall]], object),
        "x": point[:, 0],
        "z": point[:, 1],
        "status": np.array([MEANINGS[code] for code in joined("status")], object),
        "normal_force": joined("normal_force"),
        "tangential_force": joined("tangential_force"),
    }
    units = {"x": LENGTH, "z": LENGTH, "normal_force": FORCE, "tangential_force": FORCE}
    for force, _, status in ROWS[1 : max(pairs.rows, walls.rows)]:
        columns[force], units[force] = joined(force), FORCE
        columns[status] = np.array([MEANINGS[code] for code in joined(status)], object)
    found = xr.Dataset({name: ("contact", values) for name, values in columns.items()}).to_dataframe()
    found.attrs["units"] = units
    return found
