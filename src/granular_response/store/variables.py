"""The variables of a stored result, each said once: dimensions, meaning, unit, and what its values may be.

Units are names that ``scene.LaboratoryUnits.define`` makes known to pint, as xarray's plots, cf-xarray and pint-xarray
read them; text and codes have none. Datasets of studies hold some of the variables too, with the unit "1" and the
meaning, which names the unit, as ``long_name``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..scene.laboratory import FORCE, LENGTH, MASS, TIME
from ..state import CONTACT_EVENTS, LOST_EVENTS, ROLLING_EVENTS
from ..state.box import WALL_MEANINGS
from ..state.status import MEANINGS
from .files import CHARACTERS, TEXT

RADII, WEIGHTS = "in mean disk radii", "in mean disk weights"
WORK, _WORK = f"{FORCE} * {LENGTH}", "in mean weight times mean radius"
#: Kinds of values, by the letters that numpy has for their types.
REAL, WHOLE = "fiu", "iu"
EVENT_KINDS = CONTACT_EVENTS + LOST_EVENTS + ROLLING_EVENTS
#: Number of unstable directions in files where it was not determined, and other whole numbers that are not known.
NOT_DETERMINED = -1
#: Contacts of disks and at walls: what the names of their variables begin with, and their dimension.
CONTACTS = {"contact": "contact", "wall": "wall_contact"}


class Stored(NamedTuple):
    """One variable of a result."""

    dimensions: str  #: with spaces between them
    text: str  #: what it is, with its unit in words
    unit: str = "1"
    kinds: str = REAL
    codes: tuple[str, ...] = ()  #: what its values 0, 1, ... mean
    finite: bool = True  #: whether no value may be missing
    optional: bool = False


#: Of every contact, and of those that resist rolling.
CONTACT = {
    "overlap": Stored("", f"overlap {RADII}; negative is a gap", LENGTH),
    "normal_force": Stored("", f"normal contact force {WEIGHTS}, positive in compression", FORCE),
    "tangential_force": Stored("", f"tangential contact force {WEIGHTS}, along z cross n", FORCE),
    "spring": Stored("", f"elongation of the tangential spring {RADII}", LENGTH),
    "status": Stored("", "contact status", "", WHOLE, MEANINGS),
}
ROLLING = {
    "rolling_force": Stored(
        "", f"rolling force {WEIGHTS}; times the reduced radius it is the couple on the first disk", FORCE
    ),
    "rolling_spring": Stored("", f"elongation of the rolling spring {RADII}", LENGTH),
    "rolling_status": Stored(
        "", "status along the rolling: sliding is at the limit of the rolling force", "", WHOLE, MEANINGS
    ),
}
#: Parts of a certificate.
CERTIFICATE: dict[str, tuple[Any, ...]] = {
    "force_residual": (f"largest unbalanced force on a disk {WEIGHTS}", FORCE),
    "torque_residual": (f"largest unbalanced torque on a disk {_WORK}", WORK),
    "coulomb_excess": (f"largest excess of a tangential force over the Coulomb limit {WEIGHTS}", FORCE),
    "smallest_normal_force": (f"smallest normal force of a closed contact {WEIGHTS}", FORCE),
    "kinetic_energy": (f"kinetic energy per disk {_WORK}", WORK),
    "negative_modes": (f"unstable directions of the tangent stiffness ({NOT_DETERMINED}: not determined)",),
    "loose_disks": ("rattlers: disks with fewer than two contacts",),
    "unbalanced_part": ("largest unbalanced force on a disk, as a part of what it bears",),
    "rolling_excess": (f"largest excess of a rolling force over its limit {WEIGHTS}", FORCE),
}
#: Of the record of each state, where it is known for one of them.
REACHED: dict[str, tuple[Any, ...]] = {
    "method": ("method that found the state", "", TEXT),
    "settled": ("whether dynamics came to rest",),
    "steps": ("time steps of the dynamics since it began",),
    "time_step": ("time step of the dynamics in sqrt(radius/g)", TIME),
    "time": ("time since the last ramp began in sqrt(radius/g)", TIME),
    "rebuilds": ("times that candidate contacts were listed again",),
    "kinetic_energy": (f"kinetic energy per disk before the static finish {_WORK}", WORK),
    "relaxation_steps": ("time steps of the last relaxation",),
    "network_fixed_steps": ("time steps in which no contact opened or closed",),
    "sliding_contacts": ("sliding contacts when the kinetic energy had fallen below its limit",),
    "mean_acceleration": (
        "mean acceleration of disks with two contacts or more in g, at that moment", f"{FORCE} / {MASS}",
    ),
    "loose_disks": ("rattlers: disks with fewer than two contacts, at that moment",),
    "stopped_rattlers": ("rattlers that still rolled when the others were at rest, and were stopped by hand",),
    "more_relaxations": ("stretches of dynamics between tries of the static finish",),
    "newton_iterations": ("iterations of Newton's method",),
    "finish_displacement": (f"largest displacement of a disk in the static finish {RADII}", LENGTH),
    "escapes": ("saddles of the energy that were left",),
    "increments": ("increments of the path so far, in the command that made the state",),
    "factorisations": ("factorisations of the path so far, in the command that made the state",),
    "events_within": (f"load within which the path took events together {WEIGHTS}", FORCE),
    "events_error": ("what that leaves out of a force of the floor or a wall, per load, as measured",),
}  # fmt: skip
#: Of each event of a path: its fields, in order.
EVENTS: dict[str, tuple[Any, ...]] = {
    "load_factor": ("load factor at which it happens",),
    "kind": ("what happens", "", WHOLE, EVENT_KINDS),
    "first": ("disk that it happens to; the one that moves farthest where an equilibrium is lost", "1", WHOLE),
    "second": ("the other disk, or the wall; -1 where an equilibrium is lost", "1", WHOLE),
    "at_wall": ("whether the contact is with a wall", "", WHOLE, ("no", "yes")),
    "x": (f"place of the contact, or of the disk {RADII}", LENGTH),
    "z": (f"height of the contact, or of the disk {RADII}", LENGTH),
    "until": ("load factor at which the path goes on",),
    "displacement": (f"largest displacement of a disk from a lost equilibrium to the next {RADII}", LENGTH),
    "reason": ("why an equilibrium is lost", "", TEXT),
}
_FACTOR, _FIRST = "multiplier of the scene's loads", "disk that the contact force acts on"
_RESPONSE = "vertical floor force that the load adds, per total magnitude of the applied forces (NaN without any)"
_HOLDS = "force x, z with which each load holds its disk at its displacement"

VARIABLES: dict[str, Stored] = {
    "position": Stored("state disk axis", f"disk centre x, z {RADII}", LENGTH),
    "distance_from_given": Stored(
        "state disk",
        f"distance of each disk from where the scene's table or arrays have it {RADII}",
        LENGTH,
        optional=True,
    ),
    "angle": Stored(
        "state disk", "rotation since the start of the preparation, counter-clockwise, in radians", "radian"
    ),
    "velocity": Stored("state disk axis", "disk velocity in sqrt(radius g)", f"{LENGTH} / {TIME}"),
    "angular_velocity": Stored("state disk", "angular velocity in sqrt(g/radius)", f"radian / {TIME}"),
    "state_load_factor": Stored("state", _FACTOR),
    "radius": Stored("disk", f"disk radius {RADII}", LENGTH),
    "mass": Stored("disk", "disk mass in mean disk masses", MASS),
    "row": Stored("disk", "row on the lattice from the bottom, -1 without lattice", kinds=WHOLE),
    "loaded_disk": Stored("load_point", "disks that carry the loads", kinds=WHOLE),
    "applied_load": Stored("load_point component", f"force x, z {WEIGHTS} and torque at load factor 1", ""),
    "floor_disk": Stored("floor_disk", "index of the floor disk", kinds=WHOLE),
    "x": Stored("floor_disk", f"rest position from the loaded disk, or the middle if several are {RADII}", LENGTH),
    "floor_force_rest": Stored("floor_disk", f"vertical floor force at rest {WEIGHTS}", FORCE),
    "contact_disk": Stored("contact", _FIRST, kinds=WHOLE),
    "contact_partner": Stored("contact", "other disk", kinds=WHOLE),
    "wall_disk": Stored("wall_contact", _FIRST, kinds=WHOLE),
    "wall_index": Stored("wall_contact", "wall", "", WHOLE, WALL_MEANINGS),
    **{
        f"{prefix}_{name}": one._replace(dimensions=f"state {along}", optional=name in ROLLING)
        for prefix, along in CONTACTS.items()
        for name, one in {**CONTACT, **ROLLING}.items()
    },
    **{
        f"{prefix}_force": Stored(f"state {along} axis", f"contact force x, z on the first disk {WEIGHTS}", FORCE)
        for prefix, along in CONTACTS.items()
    },
    **{
        f"{prefix}_own_place": Stored(
            f"state {along}",
            "place among the candidates of the state when it was solved, -1 for none of them",
            kinds=WHOLE,
            optional=True,
        )
        for prefix, along in CONTACTS.items()
    },
    **{
        f"certificate_{name}": Stored("state", *said)._replace(finite=False, optional=name == "rolling_excess")
        for name, said in CERTIFICATE.items()
    },
    **{
        f"reached_{name}": Stored("state", *said)._replace(finite=False, optional=True)
        for name, said in REACHED.items()
    },
    "load": Stored("load", f"index: {_FACTOR}"),
    "load_factor": Stored("load", _FACTOR),
    "step": Stored("load", "step of the load programme", kinds=WHOLE),
    "branch": Stored("load", "branch of the load programme", "", TEXT),
    "floor_force": Stored("load floor_disk", f"vertical floor force under load {WEIGHTS}", FORCE, finite=False),
    "floor_force_change": Stored(
        "load floor_disk", f"vertical floor force that the load adds {WEIGHTS}", FORCE, finite=False
    ),
    "floor_response": Stored("load floor_disk", _RESPONSE, finite=False),
    "total_force": Stored("load", f"total magnitude of the applied forces {WEIGHTS}", FORCE),
    "reaction": Stored("load load_point axis", f"{_HOLDS} {WEIGHTS}; 0 along free directions", FORCE, optional=True),
    **{
        f"event_{name}": Stored("event", *said)._replace(finite=name not in "xz", optional=True)
        for name, said in EVENTS.items()
    },
    "event_state": Stored("event", "state that the event leads to", kinds=WHOLE, optional=True),
    "axis": Stored("axis", "axis labels", "", TEXT),
    "component": Stored("component", "component labels", "", TEXT),
}
#: Where the name of the variable says too little.
_NAMES = {"x": "x from the loaded disk", "load": "load factor", "state_load_factor": "load factor"}


def flags(meanings: Sequence[str], kind: Any = np.int8) -> dict[str, Any]:
    """Attributes of a variable that holds codes, by the CF conventions."""
    return {"flag_values": np.arange(len(meanings), dtype=kind), "flag_meanings": " ".join(meanings)}


def variable(dims, values, long_name: str, **attributes) -> xr.Variable:
    """xr.Variable with the attributes that every stored variable has."""
    dimensions = (dims,) if isinstance(dims, str) else tuple(dims)
    # numpy's arrays are taken as they are: xarray need not find out whether they are Dask's
    return xr.Variable(
        dimensions, np.asarray(values), {"long_name": long_name, "units": "1", **attributes}, fastpath=True
    )


def described(name: str, values: Any, *, along: str = "state", text: str = "", **attributes: Any) -> xr.Variable:
    """Values of a variable of :data:`VARIABLES`, with another dimension in place of ``state``, or another text."""
    stored, array = VARIABLES[name], np.asarray(values)
    dimensions = [along if dimension == "state" else dimension for dimension in stored.dimensions.split()]
    coded = flags(stored.codes, array.dtype) if stored.codes else {}
    return variable(dimensions, array, text or stored.text, **{**coded, **attributes})


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A result with short names and units in place of those that :func:`variable` gave.

    ``long_name`` is short enough for an axis, ``description`` says the rest. Texts are marked for xarray's own writer.
    """
    for key, one in dataset.variables.items():
        name, attributes = str(key), dict(one.attrs)
        coded = one.dtype.kind not in "iuf" or "flag_values" in attributes
        unit = "" if coded else VARIABLES[name].unit if name in VARIABLES else "1"
        named = {"long_name": _NAMES.get(name, name.replace("_", " ")), **({"units": unit} if unit else {})}
        text = attributes.pop("description", attributes.get("long_name", ""))
        others = {key: value for key, value in attributes.items() if key not in ("long_name", "units")}
        one.attrs = {**named, "description": text, **others}
        if one.dtype.kind in TEXT:
            one.encoding = dict(CHARACTERS)
    return dataset
