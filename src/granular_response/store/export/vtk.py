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
from ...state import ROWS, State
from ..result import CONTACTS, events_from, state_from
from ..variables import EVENTS
from .frames import contact_force_sums, in_plane


def files(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The files as bytes, the series last."""
    if path.suffix == ".vtu":
        return {path: _mesh(dataset, state_from(dataset, 0), -1)}
    made, entries, rest = {}, [], state_from(dataset, 0)
    factors = dataset["state_load_factor"].values.tolist()
    grows = all(later > before for before, later in pairwise(factors))
    for index, time in enumerate(factors if grows else range(len(factors))):
        name = f"{path.stem}-{index}.vtu"
        made[path.with_name(name)] = _mesh(dataset, rest, index)
        entries.append(f'<DataSet timestep="{time}" part="0" file={quoteattr(name)}/>')
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">']
    lines += ["<Collection>", *entries, "</Collection>", "</VTKFile>", ""]
    return {**made, path: "\n".join(lines).encode()}


def _mesh(dataset: xr.Dataset, rest: State, index: int) -> bytes:
    """One state, with what its load adds: displacements, and the stress at the centres of the disks (Sec. V.C)."""
    state = state_from(dataset, index)
    position, box, n = state.position, state.box, len(state.position)
    moved = position - rest.position
    points, moves, ends, values = [position], [moved], [], []
    further = [force for force, *_ in ROWS[1:] if any(f"{prefix}_{force}" in dataset for prefix in CONTACTS)]
    names = (*_OF_CONTACTS, *further)
    for contacts, at_wall in ((state.pairs, False), (state.walls, True)):
        near, far = contacts.first[contacts.touching], contacts.second[contacts.touching].astype(np.int64)
        if at_wall:
            end = box.on_wall(position[near], far)
            way = end - box.on_wall(rest.position[near], far)
            own = np.ones(len(near), bool)
        else:
            end, way = position[near] - box.separation(position[near], position[far]), moved[far]
            own = np.any(np.abs(end - position[far]) > 1e-9, axis=1)  # across a periodic side
        far[own] = sum(map(len, points)) + np.arange(np.count_nonzero(own))
        points.append(end[own])
        moves.append(way[own])
        ends.append(np.column_stack([near, far]))
        of_contacts = {name: getattr(contacts, name)[contacts.touching] for name in names}
        values.append({**of_contacts, "wall": np.full(len(near), at_wall)})
    lines, centres = np.concatenate(ends), in_plane(np.concatenate(points))
    feet = len(centres) - n

    def on_disks(array: np.ndarray) -> np.ndarray:
        return np.concatenate([array, np.zeros((feet, *array.shape[1:]), array.dtype)])

    def on_lines(name: str) -> np.ndarray:
        both = np.concatenate([one[name] for one in values])
        kind = float if both.dtype.kind == "f" else np.int32
        return np.concatenate([np.zeros(n, kind), both.astype(kind)])

    loaded = np.zeros(n, np.int32)
    loaded[dataset["loaded_disk"].values] = 1
    stress = coarse_grained_stress(load_forces(rest, state), position)
    cells: dict[str, np.ndarray] = {
        "connectivity": np.concatenate([np.arange(n), lines.ravel()]).astype(np.int64),
        "offsets": np.concatenate([np.arange(1, n + 1), n + 2 * np.arange(1, len(lines) + 1)]).astype(np.int64),
        "types": np.repeat(np.array([_VERTEX, _LINE], np.uint8), [n, len(lines)]),
    }
    on_points: dict[str, np.ndarray] = {
        "radius": on_disks(dataset["radius"].values),
        "angle": on_disks(state.angle),
        "coordination": on_disks(state.contact_count().astype(np.int32)),
        "loaded": on_disks(loaded),
        "displacement": in_plane(np.concatenate(moves)),
        "contact_force": on_disks(in_plane(contact_force_sums(state))),
        **{f"added_stress_{'xz'[a]}{'xz'[b]}": on_disks(stress[:, a, b]) for a in range(2) for b in range(2)},
    }
    piece = f'<Piece NumberOfPoints="{len(centres)}" NumberOfCells="{n + len(lines)}">'
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            "<UnstructuredGrid>",
            *_section("FieldData", {"load_factor": np.array([state.load_factor]), **_events(dataset, index)}),
            piece,
            *_section("Points", {"points": centres}),
            *_section("Cells", cells),
            *_section("PointData", on_points),
            *_section("CellData", {name: on_lines(name) for name in (*_OF_CONTACTS, "wall", *further)}),
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


#: What lines have of their contacts, beside the forces of further rows.
_OF_CONTACTS = ("normal_force", "tangential_force", "overlap", "status")
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
