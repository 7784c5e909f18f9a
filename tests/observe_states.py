"""Small hand-made states for the tests of the observables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from granular_response.state import FLOOR, LEFT_WALL, OPEN, RIGHT_WALL, STICKING, Box, Contacts, State

ROW = np.sqrt(3.0)


def contacts(
    links: Iterable[tuple[int, int]],
    normal_force: float | np.ndarray = 1.0,
    tangential_force: float | np.ndarray = 0.0,
    status: int | np.ndarray = STICKING,
) -> Contacts:
    """Contacts with the given partners; scalars are spread over all of them."""
    array = np.array(list(links), dtype=np.int32).reshape(-1, 2)
    m = array.shape[0]
    return Contacts(
        first=array[:, 0],
        second=array[:, 1],
        overlap=np.zeros(m),
        normal_force=np.broadcast_to(np.asarray(normal_force, dtype=float), m).copy(),
        tangential_force=np.broadcast_to(np.asarray(tangential_force, dtype=float), m).copy(),
        spring=np.zeros(m),
        status=np.broadcast_to(np.asarray(status, dtype=np.int8), m).copy(),
    )


def state(position: np.ndarray, pairs: Contacts, walls: Contacts | None = None, width: float = 4.0) -> State:
    n = len(position)
    return State(
        position=np.asarray(position, dtype=float),
        angle=np.zeros(n),
        velocity=np.zeros((n, 2)),
        angular_velocity=np.zeros(n),
        pairs=pairs,
        walls=contacts([]) if walls is None else walls,
        box=Box(width),
    )


def slab(layers: int, long_row: int) -> State:
    """Triangular lattice of unit disks, rows alternately ``long_row`` and one fewer, long at the bottom;
    neighbours and walls touch with unit normal force. Disks are numbered row by row from the bottom."""
    position = []
    for layer in range(layers):
        short = layer % 2
        position += [(1.0 + short + 2.0 * k, 1.0 + layer * ROW) for k in range(long_row - short)]
    centre = np.array(position)
    n = len(centre)
    links = [(i, j) for i in range(n) for j in range(i + 1, n) if np.linalg.norm(centre[i] - centre[j]) < 2.0 + 1e-9]
    walls = [(i, FLOOR) for i in range(n) if centre[i, 1] < 1.1]
    walls += [(i, LEFT_WALL) for i in range(n) if centre[i, 0] < 1.1]
    walls += [(i, RIGHT_WALL) for i in range(n) if centre[i, 0] > 2.0 * long_row - 1.1]
    return state(centre, contacts(links), contacts(walls), 2.0 * long_row)


def with_pairs(source: State, chosen: np.ndarray, **values: float) -> State:
    """Copy of a state in which the fields of the ``chosen`` pairs have other values."""
    fields = {name: getattr(source.pairs, name).copy() for name in values}
    for name, value in values.items():
        fields[name][chosen] = value
    return replace(source, pairs=replace(source.pairs, **fields))


def opened(source: State, chosen: np.ndarray) -> State:
    return with_pairs(source, chosen, normal_force=0.0, tangential_force=0.0, status=OPEN)


def pair_index(source: State, i: int, j: int) -> int:
    """Position of the pair of disks ``i`` and ``j`` in the list of candidates."""
    a, b = source.pairs.first, source.pairs.second
    return int(np.flatnonzero(((a == i) & (b == j)) | ((a == j) & (b == i)))[0])
