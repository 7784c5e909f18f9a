"""VTK for ParaView: one state as ``.vtu``, or all of them as a series, ``.pvd``, with a ``.vtu`` beside it for each.

Disks are vertices, contacts are lines. A wall contact ends at its foot, one across a periodic side where the other
disk's image lies; these ends are points without a disk, and move as it does. The events on the way to a state are its
field data. The times of a series are the load factors where these grow, and the numbers of the states where they do
not: two states of one time would be one.
"""

from __future__ import annotations

import base64
from itertools import pairwise
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import xarray as xr

from ...observe.stress import coarse_grained_stress, load_forces
from ...state import OPEN, Box
from ..result import events_from, state_from
from ..variables import EVENTS
from .frames import PREFIXES, contact_force_sums, in_plane


def files(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The files as bytes, the series last."""
    if path.suffix == ".vtu":
        return {path: _mesh(dataset, -1)}
    made, entries = {}, []
    factors = dataset["state_load_factor"].values.tolist()
    grows = all(later > before for before, later in pairwise(factors))
    for index, time in enumerate(factors if grows else range(len(factors))):
        name = f"{path.stem}-{index}.vtu"
        made[path.with_name(name)] = _mesh(dataset, index)
        entries.append(f'<DataSet timestep="{time}" part="0" file={quoteattr(name)}/>')
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">']
    lines += ["<Collection>", *entries, "</Collection>", "</VTKFile>", ""]
    return {**made, path: "\n".join(lines).encode()}


def _mesh(dataset: xr.Dataset, index: int) -> bytes:
    """One state, with what its load adds: displacements, and the stress at the centres of the disks (Sec. V.C)."""
    state = dataset.isel(state=index)
    n = state.sizes["disk"]
    position, bounds = state["position"].values, Box.of(dataset.attrs)
    at_rest = dataset["position"].values[0]
    moved = position - at_rest
    force, count = contact_force_sums(state)
    points: list[np.ndarray] = [position]
    moves: list[np.ndarray] = [moved]
    ends: list[np.ndarray] = []
    forces: list[np.ndarray] = []
    for prefix in PREFIXES:
        touching = np.flatnonzero(state[f"{prefix}_status"].values != OPEN)
        near = state[f"{prefix}_disk"].values[touching]
        if prefix == "contact":
            far = state["contact_partner"].values[touching].astype(np.int64)
            end = position[near] - bounds.separation(position[near], position[far])
            own = np.any(np.abs(end - position[far]) > 1e-9, axis=1)  # across a periodic side
            moves.append(moved[far][own])
        else:
            far = np.zeros(len(near), np.int64)
            wall = state["wall_index"].values[touching]
            end = bounds.on_wall(position[near], wall)
            own = np.ones(len(near), bool)
            moves.append(end - bounds.on_wall(at_rest[near], wall))
        far[own] = sum(map(len, points)) + np.arange(np.count_nonzero(own))
        points.append(end[own])
        ends.append(np.column_stack([near, far]))
        names = ("normal_force", "tangential_force", "overlap", "status")
        values = [state[f"{prefix}_{name}"].values[touching] for name in names]
        rolling = f"{prefix}_rolling_force"
        rolls = state[rolling].values[touching] if rolling in state else np.zeros(len(touching))
        forces.append(np.column_stack([*values, np.full(len(touching), prefix == "wall"), rolls]))
    lines, table = np.concatenate(ends), np.concatenate(forces)
    centres = in_plane(np.concatenate(points))
    feet = len(centres) - n

    def on_disks(array: np.ndarray) -> np.ndarray:
        return np.concatenate([array, np.zeros((feet, *array.shape[1:]), array.dtype)])

    def on_lines(column: int, kind: type = float) -> np.ndarray:
        return np.concatenate([np.zeros(n, kind), table[:, column].astype(kind)])

    factor = np.atleast_1d(state["state_load_factor"].values)
    loaded = np.zeros(n, np.int32)
    loaded[state["loaded_disk"].values] = 1
    stress = coarse_grained_stress(load_forces(state_from(dataset, 0), state_from(dataset, index)), position)
    cells: dict[str, np.ndarray] = {
        "connectivity": np.concatenate([np.arange(n), lines.ravel()]).astype(np.int64),
        "offsets": np.concatenate([np.arange(1, n + 1), n + 2 * np.arange(1, len(lines) + 1)]).astype(np.int64),
        "types": np.repeat(np.array([_VERTEX, _LINE], np.uint8), [n, len(lines)]),
    }
    on_cells: dict[str, np.ndarray] = {
        "normal_force": on_lines(0),
        "tangential_force": on_lines(1),
        "overlap": on_lines(2),
        "status": on_lines(3, np.int32),
        "wall": on_lines(4, np.int32),
    }
    if any(f"{prefix}_rolling_force" in state for prefix in PREFIXES):
        on_cells["rolling_force"] = on_lines(5)
    on_points: dict[str, np.ndarray] = {
        "radius": on_disks(state["radius"].values),
        "angle": on_disks(state["angle"].values),
        "coordination": on_disks(count.astype(np.int32)),
        "loaded": on_disks(loaded),
        "displacement": in_plane(np.concatenate(moves)),
        "contact_force": on_disks(in_plane(force)),
        **{f"added_stress_{'xz'[a]}{'xz'[b]}": on_disks(stress[:, a, b]) for a in range(2) for b in range(2)},
    }
    piece = f'<Piece NumberOfPoints="{len(centres)}" NumberOfCells="{n + len(lines)}">'
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            "<UnstructuredGrid>",
            *_section("FieldData", {"load_factor": factor, **_events(dataset, index)}),
            piece,
            *_section("Points", {"points": centres}),
            *_section("Cells", cells),
            *_section("PointData", on_points),
            *_section("CellData", on_cells),
            "</Piece>",
            "</UnstructuredGrid>",
            "</VTKFile>",
            "",
        ]
    ).encode()


def _events(dataset: xr.Dataset, index: int) -> dict[str, np.ndarray]:
    """The events on the way to a state, without the reasons, which are words."""
    if not events_from(dataset, index):
        return {}
    here = dataset["event_state"].values == range(dataset.sizes["state"])[index]
    arrays = {f"event_{name}": dataset[f"event_{name}"].values[here] for name in EVENTS if name != "reason"}
    return {name: array.astype(np.int32) if array.dtype.kind == "i" else array for name, array in arrays.items()}


#: VTK's numbers of the two kinds of cells.
_VERTEX, _LINE = 1, 3
_TYPES = {"f8": "Float64", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


def _section(name: str, arrays: dict[str, np.ndarray]) -> list[str]:
    """One part of the file: each array after its length in bytes, as base64."""
    lines = [f"<{name}>"]
    for title, array in arrays.items():
        kind = _TYPES[array.dtype.str[1:]]
        raw = array.astype(array.dtype.newbyteorder("<")).tobytes()
        text = base64.b64encode(len(raw).to_bytes(8, "little") + raw).decode()
        parts = f' NumberOfComponents="{array.shape[1]}"' if array.ndim > 1 else ""
        parts += f' NumberOfTuples="{len(array)}"' if name == "FieldData" else ""
        lines.append(f'<DataArray type="{kind}" Name="{title}"{parts} format="binary">{text}</DataArray>')
    return [*lines, f"</{name}>"]
