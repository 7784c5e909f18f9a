"""Contacts with what their springs bear: carried to another list, and as forces without velocities."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..kernels import statics
from ..state import Contacts, FloatArray


class Kind(NamedTuple):
    """Contacts of one kind, and their laws."""

    contacts: Contacts
    laws: tuple[Any, ...]  #: the law, and what there is of further rows
    shape: FloatArray | None  #: (m,) what the law needs of the radii


def carry_springs(n: int, contacts: Contacts, first, second) -> FloatArray:
    """(2, m) springs of ``contacts`` in the order of another list ``(first, second)`` of the same kind.

    Raises
    ------
    ValueError
        When a contact that carries a spring is not in the other list.
    """
    if np.array_equal(contacts.first, first) and np.array_equal(contacts.second, second):
        return contacts.springs
    held = np.flatnonzero((contacts.springs != 0.0).any(axis=0))
    if not len(held):
        return np.zeros((len(contacts.springs), len(first)))
    key = np.asarray(first, np.int64) + n * np.asarray(second, np.int64)
    by = np.argsort(key)
    wanted = contacts.first[held].astype(np.int64) + n * contacts.second[held].astype(np.int64)
    place = np.searchsorted(key[by], wanted)
    lost = np.append(key[by], -1)[place] != wanted
    if lost.any():
        k = held[np.flatnonzero(lost)[0]]
        raise ValueError(f"contact {contacts.first[k]}-{contacts.second[k]} carries a spring but is not listed")
    springs = np.zeros((len(contacts.springs), len(key)))
    springs[:, by[place]] = contacts.springs[:, held]
    return springs


def static_contacts(first, second, overlap, springs: FloatArray, shape, laws: Sequence[Any]) -> Contacts:
    """Contacts with the spring parts of their forces (Sec. III.A without velocities).

    ``laws`` : those of each row, of which ``springs`` (r, m) has as many or more.
    """
    size = len(overlap)
    out = statics.Response(*np.zeros((4, size)), *np.zeros((3, size * len(laws))))
    statics.normal_forces(overlap, shape, laws[0], out)
    for row, law in enumerate(laws):
        if law.friction > 0.0:
            statics.spring_forces(row, springs[row], law, out)
    rows = (part.reshape(len(laws), size) for part in (out.tangential, out.spring, out.status))
    return Contacts.of(first, second, overlap, out.normal, *rows)


def spring_contacts(first, second, springs: Iterable[FloatArray] = ()) -> Contacts:
    """Contacts of which no more is known than the springs of their first rows; zero stands for the rest."""
    zero = np.zeros(len(first))
    springs = [*springs] or [zero]
    nothing = [zero] * len(springs)
    return Contacts.of(first, second, zero, zero, nothing, springs, nothing)
