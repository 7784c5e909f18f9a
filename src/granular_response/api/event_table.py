"""The events of a load path as one sequence: counted, chosen by kind, shown as a table."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import fields
from typing import Any, overload

import xarray as xr

from ..errors import require
from ..scene.errors import suggestion
from ..state import Event
from ..store.variables import EVENT_KINDS as KINDS

#: Rows of a table in a notebook.
_SHOWN = 20


class Events(Sequence[Event]):
    """Events in the order of the load path, and for each the index of the state that it leads to.

    A sequence of :class:`granular_response.Event`: ``events[0]``, ``len(events)``, ``for event in events``. It is
    empty where no path was followed.

    Examples
    --------
    >>> result.events.of("opens")[0].load_factor < 1.0
    True
    >>> counts = result.events.to_dataframe().groupby(["state", "kind"]).size()
    """

    def __init__(self, pairs: Iterable[tuple[int, Event]] = ()) -> None:
        self._pairs = tuple(pairs)

    @property
    def states(self) -> tuple[int, ...]:
        """For each event the index of the state that it leads to; 0 is the initial equilibrium."""
        return tuple(state for state, _ in self._pairs)

    @overload
    def __getitem__(self, place: int) -> Event: ...
    @overload
    def __getitem__(self, place: slice) -> Events: ...
    def __getitem__(self, place: int | slice) -> Event | Events:
        return Events(self._pairs[place]) if isinstance(place, slice) else self._pairs[place][1]

    def __len__(self) -> int:
        return len(self._pairs)

    def of(self, *kinds: str) -> Events:
        """The events of these kinds. Raises ValueError for a kind that there is not.

        Examples
        --------
        >>> len(result.events.of("opens", "closes")) <= len(result.events)
        True
        """
        for kind in kinds:
            check_kind(kind)
        return Events(pair for pair in self._pairs if pair[1].kind in kinds)

    @property
    def lost(self) -> Events:
        """Where equilibria were lost."""
        return Events(pair for pair in self._pairs if pair[1].lost)

    def counts(self) -> dict[str, int]:
        """How many there are of each kind that there is.

        Examples
        --------
        >>> sum(result.events.counts().values()) == len(result.events)
        True
        """
        kinds = [event.kind for event in self]
        return {kind: kinds.count(kind) for kind in KINDS if kind in kinds}

    def to_dataframe(self) -> Any:
        """A ``pandas.DataFrame``, a row for each event: its fields, after the index of the ``state`` it leads to.

        Examples
        --------
        >>> result.events.to_dataframe().columns[:3].tolist()
        ['state', 'load_factor', 'kind']
        """
        columns = {"state": self.states}
        columns |= {field.name: tuple(getattr(event, field.name) for event in self) for field in fields(Event)}
        return xr.Dataset({name: ("event", list(values)) for name, values in columns.items()}).to_dataframe()

    def __eq__(self, other: object) -> bool:
        return self._pairs == other._pairs if isinstance(other, Events) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def _counted(self) -> str:
        counts = ", ".join(f"{count} {kind}" for kind, count in self.counts().items())
        return f"Events: {counts or 'none'}"

    def __repr__(self) -> str:
        lines = [f"  {event.load_factor:.9g}: {event.kind}, {event.where}" for event in self[:_SHOWN]]
        more = len(self) - len(lines)
        return "\n".join([self._counted(), *lines, *([f"  and {more} more"] if more else [])])

    def _repr_html_(self) -> str:
        rows = [("state", "load factor", "kind", "where", "until", "displacement", "reason")]
        for k, event in self._pairs[:_SHOWN]:
            lost = (f"{event.until:.9g}", f"{event.displacement:.3g}", event.reason) if event.lost else ("", "", "")
            rows.append((str(k), f"{event.load_factor:.9g}", event.kind, event.where, *lost))
        lines = [f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in rows]
        more = len(self) - len(rows) + 1
        return f"<b>{self._counted()}</b><table>{''.join(lines)}</table>{f'and {more} more' if more else ''}"


def check_kind(kind: object) -> None:
    """Raise ValueError, in one line, for what is no kind of event."""
    require(kind in KINDS, f"kind = {kind!r}: must be {' or '.join(KINDS)}{suggestion(kind, KINDS)}")
