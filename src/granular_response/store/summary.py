"""What a stored file holds, for a reader at a terminal."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from itertools import chain
from os import PathLike

import numpy as np
import xarray as xr
from rich.console import OverflowMethod, RenderableType
from rich.table import Table
from rich.text import Text

from ..observe.broke_in import broke_in
from ..scene import text as scene_text
from ..scene.arrays import shortened
from . import files as store
from .checked import result_of
from .result import events_from, state_from, stored_values
from .variables import EVENT_KINDS, NOT_DETERMINED

#: Attributes that a summary shows elsewhere or not at all.
_HIDDEN = {"format", "scene", "scene_folder_note", "parameters", "method", "method_reason", "stable", "settled"}

#: Titles of what is shown of the floor response.
_RESPONSE = ("load factor", "total force", "sum", "at x = 0", "largest", "at x", "largest change")
#: Titles of what a certificate has, where they are not its names.
_CERTIFICATE = {
    "force_residual": "max. unbalanced force",
    "torque_residual": "max. unbalanced torque",
    "unbalanced_part": "max. relative residual",
    "coulomb_excess": "max. Coulomb violation",
    "negative_modes": "unstable modes",
    "loose_disks": "rattlers",
}
#: What is shown of the work that each state took.
_WORK = ("steps", "increments", "factorisations", "newton_iterations")


def summarise(path: str | PathLike[str]) -> Iterator[RenderableType]:
    """Parts of the summary of a file, in order.

    Raises StoreError if the file cannot be read, ResultError if it is a result that is not whole.
    """
    datasets, attributes, sealed = store.open_file(path, sealed=False)
    result = result_of(path, datasets) if "floor_response" in datasets.get("", ()) else None
    yield _text(path, style="bold")
    if not sealed:
        yield Text("not sealed: rewritten by another program, so its numbers are not guaranteed", style="bold")
    yield _pairs((name, value) for name, value in attributes.items() if name not in _HIDDEN)
    keys = {name: str(attributes[name]) for name in ("scene", "parameters") if name in attributes}
    texts = ((name, _text(_readable(text).rstrip())) for name, text in keys.items())
    for title, part in chain(_study(datasets) if result is None else _result(result), texts):
        if title:
            yield Text(f"\n{title}", style="bold")
        yield part


def _readable(scene: str) -> str:
    """Stored keys without the numbers of a packing from arrays."""
    return scene_text.write(shortened(scene_text.read(scene))) if "kind: arrays" in scene else scene


def _result(result: xr.Dataset) -> Iterator[tuple[str, RenderableType]]:
    """Titles and what stands under them."""
    methods, reasons = (json.loads(result.attrs.get(name, "{}")) for name in ("method", "method_reason"))
    rows = [(stage, f"{method} ({reasons.get(stage, '')})") for stage, method in methods.items()]
    verdicts = [(name, result.attrs[name]) for name in ("stable", "settled") if name in result.attrs]
    yield "methods", _pairs([*rows, *verdicts])
    if work := stored_values(result, "reached_", _WORK):
        shown = ((name, ("-" if n == NOT_DETERMINED else n for n in work[name])) for name in work)
        yield "work", _by_factor(result, shown)
    if "event_state" in result:
        yield from _events(result)
    yield "certificate", _by_factor(result, _certificate(result))
    states = [state_from(result, k) for k in range(result.sizes["state"])]
    if said := broke_in(states, result["loaded_disk"].values):
        yield said[0], _text(said[1])
    if "distance_from_given" in result:
        yield "distance of disks from where they were given", _by_factor(result, _from_given(result))
    if "reaction" in result:
        titles = ("at load factor", "disk", "x", "z")
        yield "force that holds displaced disks", _table(titles, _reaction(result))
    yield "floor response", _table(_RESPONSE, _response(result))


def _events(result: xr.Dataset) -> Iterator[tuple[str, RenderableType]]:
    """How many of each kind, the first opening, and each equilibrium that was lost."""
    found = events_from(result)
    counts = [Counter(event.kind for k, event in found if k == state) for state in range(result.sizes["state"])]
    kinds = [kind for kind in EVENT_KINDS if any(kind in one for one in counts)]
    numbers = ((kind, (one[kind] for one in counts)) for kind in kinds)
    yield "events before each state", _by_factor(result, numbers)
    opening = next((event for _, event in found if event.kind == "opens"), None)
    if opening is not None:
        yield "", _text(f"first opening at load factor {opening.load_factor:.9g}, {opening.where}")
    if "reached_events_within" in result:
        within, error = (float(np.nanmax(result[f"reached_events_{name}"].values)) for name in ("within", "error"))
        yield "", _text(f"events processed in batches within {within:.3g} mg, estimated error {error:.1e} of the load")
    if lost := [event for _, event in found if event.lost]:
        titles = ("at load factor", "until", "what", "largest displacement", "of", "why")
        rows = (
            (f"{e.load_factor:.6g}", f"{e.until:.6g}", e.kind, f"{e.displacement:.3g}", e.where, e.reason) for e in lost
        )
        yield "losses of equilibrium", _table(titles, rows, left=("what", "of", "why"))


def _certificate(result: xr.Dataset) -> Iterator[tuple[str, list[str]]]:
    for name in map(str, result):
        if name.startswith("certificate_"):
            key = name.removeprefix("certificate_")
            values = [f"{value:.3g}" for value in result[name].values]
            if key == "negative_modes":
                values = ["not determined" if value == str(NOT_DETERMINED) else value for value in values]
            yield _CERTIFICATE.get(key, key.replace("_", " ")), values
    if "undetermined" in result:
        yield "disks not determined", [f"{number}" for number in result["undetermined"].values.sum(axis=1)]
    if "reached_stopped_rattlers" in result:
        stopped = result["reached_stopped_rattlers"].values
        yield "rattlers stopped by hand", ["0" if number == NOT_DETERMINED else f"{number:g}" for number in stopped]


def _from_given(result: xr.Dataset) -> Iterator[tuple[str, Iterable[str]]]:
    moved = result["distance_from_given"].values
    yield "median", (f"{value:.3g}" for value in np.median(moved, axis=1))
    yield "largest", (f"{value:.3g}" for value in moved.max(axis=1))
    yield "of disk", map(str, moved.argmax(axis=1))


def _reaction(result: xr.Dataset) -> Iterator[tuple[str, ...]]:
    factors = result["state_load_factor"].values[1:]
    for factor, forces in zip(factors, result["reaction"].values, strict=True):
        for disk, force in zip(result["loaded_disk"].values, forces, strict=True):
            yield f"{factor:g}", str(disk), *(f"{part:.6g}" for part in force)


def _response(result: xr.Dataset) -> Iterator[tuple[str, ...]]:
    x = result["x"].values
    for load in range(result.sizes["load"]):
        here = result.isel(load=load)
        response = here["floor_response"].values
        change = here["floor_force_change"].values
        row = [f"{float(here['load_factor']):g}", f"{float(here['total_force']):g}"]
        if np.isnan(response).all():
            row += ["-"] * 4
        else:
            peak = np.nanmax(response)
            places = x[np.isclose(response, peak, rtol=1e-6, atol=0)]
            row += [f"{response.sum():.9f}", f"{response[np.argmin(np.abs(x))]:.5f}", f"{peak:.5f}"]
            row.append(", ".join(f"{round(place, 9) + 0.0:.3g}" for place in places))
        yield *row, f"{change[np.abs(change).argmax()]:.5g}" if change.size else "-"


def _study(datasets: dict[str, xr.Dataset]) -> Iterator[tuple[str, RenderableType]]:
    titles = ("group", "dimensions", "variables")
    rows = []
    for name, dataset in datasets.items():
        sizes = ", ".join(f"{dimension} {size}" for dimension, size in dataset.sizes.items())
        rows.append((name or "/", sizes, ", ".join(map(str, dataset.data_vars))))
    yield "datasets", _table(titles, rows, left=titles, overflow="fold")


def _table(
    titles: Iterable[str],
    rows: Iterable[Iterable[object]],
    *,
    left: Collection[str] = (),
    overflow: OverflowMethod = "ellipsis",
) -> Table:
    """A table of numbers, with text in the columns on the ``left`` side."""
    table = Table(box=None, pad_edge=False)
    for title in titles:
        table.add_column(title, justify="left" if title in left else "right", overflow=overflow)
    for row in rows:
        table.add_row(*map(_text, row))
    return table


def _by_factor(result: xr.Dataset, rows: Iterable[tuple[str, Iterable[object]]]) -> Table:
    """Named rows with a column for each state."""
    titles = ["at load factor", *(f"{factor:g}" for factor in result["state_load_factor"].values)]
    table = _table(titles, ((name.replace("_", " "), *values) for name, values in rows), left=titles[:1])
    table.columns[0].style = "dim"
    return table


def _pairs(rows: Iterable[tuple[str, object]]) -> Table:
    """Names and what they stand for, without titles."""
    titles = ("name", "value")
    shown = ((name, f"{value:.6g}" if isinstance(value, float) else value) for name, value in rows)
    table = _table(titles, ((name.replace("_", " "), value) for name, value in shown), left=titles, overflow="fold")
    table.show_header, table.columns[0].style = False, "dim"
    return table


def _text(value: object, style: str = "") -> Text:
    """What a file holds as it is: no markup, and no characters that a terminal obeys."""
    return Text("".join(c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in str(value)), style)
