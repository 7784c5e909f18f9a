"""What the slider of the page shows: floor response and contact network of a slab at many forces, three frictions."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.state import OPEN

FRICTIONS = (0.0, 0.2, 1.0)
LARGEST_FORCE = 50.0

#: Half of the part of the slab that is shown, in radii.
REACH = 30.0

#: A contact's byte: up to FULL is the square root of its added force per applied force, FULL at the largest of all;
#: OPENED is a contact that touched at rest and does not under load.
FULL, OPENED = 250, 255


def payload(datasets: Mapping[str, xr.Dataset]) -> dict[str, Any] | None:
    """Embedded data of the slider from the group with the friction studies; None without the states of any friction."""
    panels = [_panel(datasets, friction) for friction in FRICTIONS if f"states_mu_{friction:g}" in datasets]
    if not panels:
        return None
    forces = sorted(set.intersection(*(set(panel["forces"]) for panel in panels)))
    strongest = max(float(panel["strength"][force].max()) for panel in panels for force in forces)
    return {
        "forces": forces,
        "reach": REACH,
        "full": FULL,
        "opened": OPENED,
        "strongest": round(strongest, 6),
        "panels": [
            {
                "friction": panel["friction"],
                "height": panel["height"],
                "x": panel["x"],
                "lines": panel["lines"],
                "frames": [_bytes(panel["strength"][f] / strongest, panel["opened"][f]) for f in forces],
                "responses": [panel["responses"][f] for f in forces],
                "peaks": [panel["peaks"][f] for f in forces],
            }
            for panel in panels
        ],
    }


def _panel(datasets: Mapping[str, xr.Dataset], friction: float) -> dict[str, Any]:
    states = datasets[f"states_mu_{friction:g}"]
    response = datasets["response"]
    response = response.isel(friction=int(np.abs(response["friction"].values - friction).argmin()))
    rest = states.isel(state=0)
    origin = float(rest["position"].values[int(rest["loaded_disk"]), 0])
    first, second = states["contact_disk"].values, states["contact_partner"].values
    place = rest["position"].values - np.array([origin, 0.0])
    inside = (np.abs(place[first, 0]) <= REACH) & (np.abs(place[second, 0]) <= REACH)
    first, second = first[inside], second[inside]
    at_rest = _forces(rest, first, second, inside)
    touched = rest["contact_status"].values[inside] != OPEN
    stored = response["force"].values
    strength, opened, responses, peaks = {}, {}, {}, {}
    for k, force in enumerate(states["force"].values.tolist()):
        here = np.flatnonzero(np.isclose(stored, force))
        if not 0.0 < force <= LARGEST_FORCE or not here.size:
            continue
        loaded = states.isel(state=k)
        strength[force] = np.linalg.norm(_forces(loaded, first, second, inside) - at_rest, axis=1) / force
        opened[force] = touched & (loaded["contact_status"].values[inside] == OPEN)
        one = response.isel(force=int(here[0]))
        responses[force] = [round(float(v), 5) for v in one["floor_response"].values]
        peaks[force] = int(one["peak_count"])
    return {
        "friction": friction,
        "forces": list(strength),
        "height": round(float(place[:, 1].max()) + 1.0, 2),
        "x": [round(float(x), 2) for x in response["x"].values],
        # ends of the contacts in tenths of a radius
        "lines": np.rint(10.0 * np.concatenate([place[first], place[second]], axis=1)).astype(int).ravel().tolist(),
        "strength": strength,
        "opened": opened,
        "responses": responses,
        "peaks": peaks,
    }


def _forces(
    state: xr.Dataset, first: NDArray[np.intp], second: NDArray[np.intp], inside: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """(contact, 2) contact forces on the first disk, from its normal and tangential part."""
    position = state["position"].values
    normal = position[first] - position[second]
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    along = state["contact_normal_force"].values[inside, None]
    across = state["contact_tangential_force"].values[inside, None]
    return along * normal + across * tangent


def _bytes(strength: NDArray[np.float64], opened: NDArray[np.bool_]) -> str:
    levels = np.rint(FULL * np.sqrt(np.clip(strength, 0.0, 1.0))).astype(np.uint8)
    levels[opened] = OPENED
    return base64.b64encode(levels.tobytes()).decode()
