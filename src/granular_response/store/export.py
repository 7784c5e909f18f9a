"""Results as files for OVITO and ParaView.

``export`` picks the format by the suffix:

* ``.gsd`` and ``.xyz`` for OVITO: one frame for each stored state, with radius, angle, mass, load and coordination
  number of every disk, and the force that the state's load adds to it (the change of the contact forces, largest
  around the loaded disk). Disks lie in the plane of the screen: file coordinates are (x, z, 0).
* ``.vtu`` for ParaView: one state, the last one unless another is asked for. Disks are vertices with their radius
  (show them with a Glyph filter), contacts are lines with normal and tangential force and status.

Units are those of the result: mean disk radius, mean disk mass, g.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr

from ..state import Box, wall_normals
from . import atomic
from .checked import read_result

#: What a file name may end with.
SUFFIXES = (".gsd", ".vtu", ".xyz")


class ExportError(Exception):
    """A result that cannot be exported. The message is one line."""


def export(result: str | os.PathLike[str], output: str | os.PathLike[str], *, state: int = -1) -> Path:
    """Write a stored result as a file for another program; returns its path.

    Parameters
    ----------
    result : netCDF file that ``granular-response run`` made.
    output : file to make; its suffix (``.gsd``, ``.xyz`` or ``.vtu``) is the format.
    state : index of the state that a ``.vtu`` file holds, 0 at rest, -1 the last one.

    Raises
    ------
    ExportError
        For another suffix, a state that does not exist, or a missing library.
    granular_response.store.files.StoreError, granular_response.store.result.ResultError
        If the result cannot be read, or is none.
    """
    output = Path(output)
    if output.suffix not in SUFFIXES:
        raise ExportError(f"{output}: format {output.suffix!r} is unknown, must be {' or '.join(SUFFIXES)}")
    dataset = read_result(result, sealed=False)
    count = dataset.sizes["state"]
    if not -count <= state < count:
        raise ExportError(f"state = {state}: must be from {-count} to {count - 1}, {result} holds {count} states")
    writers: dict[str, Callable[[xr.Dataset, Path], None]] = {
        ".gsd": _write_gsd,
        ".xyz": _write_xyz,
        ".vtu": lambda data, path: _write_vtu(data.isel(state=state), path),
    }
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        atomic.check_writable(output, [result])
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder, "export" + output.suffix)
            writers[output.suffix](dataset, made)
            atomic.write_bytes(output, made.read_bytes())
    except ModuleNotFoundError as error:
        raise ExportError(f"{output}: needs the package {error.name}, install granular-response[export]") from error
    except OSError as error:
        raise ExportError(f"{output}: cannot be written: {error.strerror or error}") from error
    return output


def contact_force_sums(state: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """(n, 2) sum of the contact forces on each disk of one state, and (n,) number of its closed contacts."""
    force, count = np.zeros((state.sizes["disk"], 2)), np.zeros(state.sizes["disk"], int)
    for prefix in ("contact", "wall"):
        _, normal = _branches(state, prefix)
        tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        acting = state[f"{prefix}_normal_force"].values[:, None] * normal
        acting += state[f"{prefix}_tangential_force"].values[:, None] * tangent
        touching = (state[f"{prefix}_status"].values != 0).astype(int)
        first = state[f"{prefix}_disk"].values
        np.add.at(force, first, acting)
        np.add.at(count, first, touching)
        if prefix == "contact":
            np.add.at(force, state["contact_partner"].values, -acting)
            np.add.at(count, state["contact_partner"].values, touching)
    return force, count


def _branches(state: xr.Dataset, prefix: str) -> tuple[np.ndarray, np.ndarray]:
    """(c, 2) far ends of the contacts (centre of the other disk or foot on the wall), (c, 2) normals."""
    position = state["position"].values
    near = position[state[f"{prefix}_disk"].values]
    if prefix == "contact":
        far = position[state["contact_partner"].values]
        branch = near - far
        return far, branch / np.linalg.norm(branch, axis=1, keepdims=True)
    wall = state["wall_index"].values
    return Box(float(state.attrs["width"])).on_wall(near, wall), wall_normals(wall)


def _in_plane(values: np.ndarray) -> np.ndarray:
    """(n, 3) vectors (x, z, 0) of (n, 2) ones."""
    return np.column_stack([values, np.zeros(len(values))])


def _frames(dataset: xr.Dataset):
    """For each state: load factor, (n, 2) positions, angles, (n, 2) change of contact forces, coordination numbers."""
    rest, _ = contact_force_sums(dataset.isel(state=0))
    for index in range(dataset.sizes["state"]):
        state = dataset.isel(state=index)
        force, count = contact_force_sums(state)
        yield float(state["state_load_factor"]), state["position"].values, state["angle"].values, force - rest, count


def _box(dataset: xr.Dataset) -> tuple[float, float]:
    """Width and height of the box that holds all disks in all states."""
    top = dataset["position"].values[..., 1] + dataset["radius"].values
    return float(dataset.attrs["width"]), float(top.max())


def _write_gsd(dataset: xr.Dataset, path: Path) -> None:
    import gsd.hoomd

    width, height = _box(dataset)
    centre = np.array([0.5 * width, 0.5 * height])
    with gsd.hoomd.open(str(path), "w") as file:
        for index, (factor, position, angle, force, count) in enumerate(_frames(dataset)):
            frame = gsd.hoomd.Frame()
            frame.configuration.step = index
            frame.configuration.dimensions = 2
            frame.configuration.box = [width, height, 0, 0, 0, 0]
            frame.particles.N = len(position)
            frame.particles.types = ["disk"]
            frame.particles.position = _in_plane(position - centre)  # the format's origin is the middle of the box
            frame.particles.diameter = 2.0 * dataset["radius"].values
            frame.particles.mass = dataset["mass"].values
            half = 0.5 * angle
            frame.particles.orientation = np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])
            touching = dataset["contact_status"].values[index] != 0
            pairs = np.column_stack([dataset["contact_disk"].values, dataset["contact_partner"].values])[touching]
            frame.bonds.N = len(pairs)
            frame.bonds.types = ["contact"]
            frame.bonds.group = pairs
            normal = dataset["contact_normal_force"].values[index][touching]
            tangential = dataset["contact_tangential_force"].values[index][touching]
            frame.log = {
                "load_factor": np.array([factor]),
                "particles/force_change": _in_plane(force),
                "particles/coordination": count.astype(np.int32),
                "bonds/normal_force": normal,
                "bonds/tangential_force": tangential,
            }
            file.append(frame)


def _write_xyz(dataset: xr.Dataset, path: Path) -> None:
    width, height = _box(dataset)
    columns = "species:S:1:pos:R:3:radius:R:1:mass:R:1:angle:R:1:force_change:R:3:coordination:I:1"
    radius, mass = dataset["radius"].values, dataset["mass"].values
    depth = 2.0 * float(radius.max())
    lines = []
    for factor, position, angle, force, count in _frames(dataset):
        lines.append(str(len(position)))
        lines.append(
            f'Lattice="{width!r} 0.0 0.0 0.0 {height!r} 0.0 0.0 0.0 {depth!r}" Properties={columns} '
            f'load_factor={factor!r} pbc="F F F"'
        )
        table = np.column_stack([_in_plane(position), radius, mass, angle, _in_plane(force)])
        for values, contacts in zip(table.tolist(), count.tolist(), strict=True):
            lines.append(" ".join(["X", *map(repr, values), str(contacts)]))
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def _write_vtu(state: xr.Dataset, path: Path) -> None:
    from pyevtk.hl import unstructuredGridToVTK
    from pyevtk.vtk import VtkLine, VtkVertex

    n = state.sizes["disk"]
    force, count = contact_force_sums(state)
    points: list[np.ndarray] = [state["position"].values]
    ends: list[np.ndarray] = []
    forces: list[np.ndarray] = []
    for prefix in ("contact", "wall"):
        touching = np.flatnonzero(state[f"{prefix}_status"].values != 0)
        near = state[f"{prefix}_disk"].values[touching]
        if prefix == "contact":
            far = state["contact_partner"].values[touching]
        else:  # the foot of a wall contact is a point of its own
            far = n + np.arange(len(touching))
            points.append(_branches(state, prefix)[0][touching])
        ends.append(np.column_stack([near, far]))
        names = ("normal_force", "tangential_force", "overlap", "status")
        values = [state[f"{prefix}_{name}"].values[touching] for name in names]
        forces.append(np.column_stack([*values, np.full(len(touching), prefix == "wall")]))
    lines, table = np.concatenate(ends), np.concatenate(forces)
    centres = _in_plane(np.concatenate(points))
    feet = len(centres) - n

    def on_disks(array: np.ndarray) -> np.ndarray:
        return np.concatenate([array, np.zeros((feet, *array.shape[1:]), array.dtype)])

    def on_lines(column: int, kind: type = float) -> np.ndarray:
        return np.concatenate([np.zeros(n, kind), table[:, column].astype(kind)])

    loaded = np.zeros(n, np.int32)
    loaded[state["loaded_disk"].values] = 1
    acting = on_disks(_in_plane(force))
    unstructuredGridToVTK(
        str(path.with_suffix("")),
        *(np.ascontiguousarray(centres[:, k]) for k in range(3)),
        connectivity=np.concatenate([np.arange(n), lines.ravel()]).astype(np.int64),
        offsets=np.concatenate([np.arange(1, n + 1), n + 2 * np.arange(1, len(lines) + 1)]).astype(np.int64),
        cell_types=np.repeat([VtkVertex.tid, VtkLine.tid], [n, len(lines)]).astype(np.uint8),
        cellData={
            "normal_force": on_lines(0),
            "tangential_force": on_lines(1),
            "overlap": on_lines(2),
            "status": on_lines(3, np.int32),
            "wall": on_lines(4, np.int32),
        },
        pointData={
            "radius": on_disks(state["radius"].values),
            "angle": on_disks(state["angle"].values),
            "coordination": on_disks(count.astype(np.int32)),
            "loaded": on_disks(loaded),
            "contact_force": tuple(np.ascontiguousarray(acting[:, k]) for k in range(3)),
        },
    )
