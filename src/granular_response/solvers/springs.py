"""Contacts with what their springs bear: carried to another list, and as forces without velocities."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..contact import Law
from ..contact.rolling import Rolling
from ..kernels import statics
from ..state import Contacts, FloatArray


class Kind(NamedTuple):
    """Contacts of one kind, and their laws."""

    contacts: Contacts
    law: Law
    shape: FloatArray | None  #: (m,) what the law needs of the radii
    rolling: Rolling | None


def carry_springs(n: int, contacts: Contacts, first, second) -> tuple[FloatArray, FloatArray]:
    """Tangential and rolling springs of ``contacts`` in the order of another list ``(first, second)`` of the same kind.

    Raises
    ------
    ValueError
        When a contact that carries a spring is not in the other list.
    """
    if np.array_equal(contacts.first, first) and np.array_equal(contacts.second, second):
        return contacts.spring.copy(), contacts.rolling_spring.copy()
    held = np.flatnonzero((contacts.spring != 0.0) | (contacts.rolling_spring != 0.0))
    key = np.asarray(first, np.int64) + n * np.asarray(second, np.int64)
    by = np.argsort(key)
    wanted = contacts.first[held].astype(np.int64) + n * contacts.second[held].astype(np.int64)
    place = np.searchsorted(key[by], wanted)
    lost = np.append(key[by], -1)[place] != wanted
    if lost.any():
        k = held[np.flatnonzero(lost)[0]]
        raise ValueError(f"contact {contacts.first[k]}-{contacts.second[k]} carries a spring but is not listed")
    springs, rolling = np.zeros((2, len(key)))
    springs[by[place]] = contacts.spring[held]
    rolling[by[place]] = contacts.rolling_spring[held]
    return springs, rolling


def static_contacts(
    first, second, overlap, spring, shape, law: Law, rolling: Rolling | None = None, rolling_spring=None
) -> Contacts:
    """Contacts with the spring parts of their forces (Sec. III.A without velocities)."""
    size = len(overlap)
    out = statics.Response.empty(size, rolls=rolling is not None)
    statics.spring_forces(overlap, spring, shape, law, out)
    if rolling is not None:
        statics.rolling_spring_forces(rolling_spring, rolling, out)
    status = out.status.astype(np.int8)
    rows = (slice(at, at + size) for at in (0, size)[: 1 + (rolling is not None)])
    parts: list[Any] = [part for row in rows for part in (out.tangential[row], out.spring[row], status[row])]
    return Contacts(np.asarray(first, np.int32), np.asarray(second, np.int32), overlap, out.normal, *parts)


def spring_contacts(
    first, second, spring: FloatArray | None = None, rolling_spring: FloatArray | None = None
) -> Contacts:
    """Contacts of which no more is known than their springs, or not even these; zero stands for it."""
    zero = np.zeros(len(first))
    return Contacts(
        np.asarray(first, np.int32), np.asarray(second, np.int32),
        zero, zero, zero, zero if spring is None else spring, zero.astype(np.int8),
        rolling_spring=zero if rolling_spring is None else rolling_spring,
    )  # fmt: skip
