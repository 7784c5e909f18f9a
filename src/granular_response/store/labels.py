"""Names and units of the variables of a result, as xarray's plots, cf-xarray and pint-xarray read them.

``long_name`` is short enough for an axis, ``description`` says the rest. Units are names that
``scene.LaboratoryUnits.define`` makes known to pint; text and codes have none.
"""

from __future__ import annotations

import xarray as xr

from ..scene.laboratory import FORCE, LENGTH, MASS, TIME

#: Variables by their unit; all others are plain numbers.
_VARIABLES = {
    LENGTH: """position x radius contact_overlap wall_overlap contact_spring wall_spring contact_rolling_spring
        wall_rolling_spring event_x event_z event_displacement reached_finish_displacement""",
    MASS: "mass",
    FORCE: """contact_normal_force contact_tangential_force contact_rolling_force contact_force wall_normal_force
        wall_tangential_force wall_rolling_force wall_force floor_force floor_force_rest floor_force_change total_force
        reaction certificate_force_residual certificate_coulomb_excess certificate_rolling_excess
        certificate_smallest_normal_force reached_events_within""",
    f"{FORCE} * {LENGTH}": "certificate_torque_residual certificate_kinetic_energy reached_kinetic_energy",
    f"{FORCE} / {MASS}": "reached_mean_acceleration",
    "radian": "angle",
    f"{LENGTH} / {TIME}": "velocity",
    f"radian / {TIME}": "angular_velocity",
    TIME: "reached_time_step reached_time",
    "": "applied_load",  # a force, and a torque
}
UNITS = {name: unit for unit, names in _VARIABLES.items() for name in names.split()}
#: Where the name of the variable says too little.
_NAMES = {"x": "x from the loaded disk", "load": "load factor", "state_load_factor": "load factor"}


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A result with these names and units in place of those that :func:`variable` gave."""
    for key, variable in dataset.variables.items():
        name, attributes = str(key), dict(variable.attrs)
        coded = variable.dtype.kind not in "iuf" or "flag_values" in attributes
        unit = "" if coded else UNITS.get(name, "1")
        named = {"long_name": _NAMES.get(name, name.replace("_", " ")), **({"units": unit} if unit else {})}
        text = attributes.pop("description", attributes.get("long_name", ""))
        others = {key: value for key, value in attributes.items() if key not in ("long_name", "units")}
        variable.attrs = {**named, "description": text, **others}
    return dataset
