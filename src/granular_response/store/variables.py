"""The variables of a stored result, each said once: dimensions, meaning, unit, and what its values may be.

They stand in ``variables.csv``. A ``*`` is ``contact`` and ``wall``; values are numbers, texts or the codes of
:data:`_CODES`; ``gaps`` may be missing in some places, what is ``optional`` everywhere. Units are products of the names
in ``scene.laboratory``; text and codes have none. Datasets of studies hold some of the variables too, with the unit "1"
and the meaning, which names the unit, as ``long_name``.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..inputs import read_text
from ..state import CONTACT_EVENTS, LOST_EVENTS, ROW_EVENTS, ROWS
from ..state.box import WALL_MEANINGS
from ..state.state import MEANINGS
from .files import CHARACTERS, TEXT

RADII, WEIGHTS = "in mean disk radii", "in mean disk weights"
#: Kinds of values, by the letters that numpy has for their types.
REAL, WHOLE = "fiu", "iu"
EVENT_KINDS = CONTACT_EVENTS + LOST_EVENTS + ROW_EVENTS[1]
#: Number of unstable directions in files where it was not determined, and other whole numbers that are not known.
NOT_DETERMINED = -1
_KINDS = {"real": REAL, "whole": WHOLE, "text": TEXT}
_CODES = {"status": MEANINGS, "wall": WALL_MEANINGS, "event": EVENT_KINDS, "no or yes": ("no", "yes")}


class StoredVariable(NamedTuple):
    """One variable of a result."""

    dimensions: str  #: with spaces between them
    text: str  #: what it is, with its unit in words
    unit: str
    kinds: str
    codes: tuple[str, ...]  #: what its values 0, 1, ... mean
    finite: bool  #: whether no value may be missing
    optional: bool


def _declared() -> Iterator[tuple[str, StoredVariable]]:
    lines = read_text(Path(__file__).with_name("variables.csv")).splitlines()
    for name, dimensions, values, unit, flags, text in list(csv.reader(lines, delimiter="|"))[1:]:
        kinds, codes = _KINDS.get(values, WHOLE), _CODES.get(values, ())
        stored = StoredVariable(dimensions, text, unit, kinds, codes, "gaps" not in flags, "optional" in flags)
        if "*" not in name:
            yield name, stored
            continue
        for prefix, along in (("contact", "contact"), ("wall", "wall_contact")):
            yield name.replace("*", prefix), stored._replace(dimensions=dimensions.replace("*", along))


VARIABLES: dict[str, StoredVariable] = dict(_declared())


def _after(prefix: str) -> tuple[str, ...]:
    return tuple(name.removeprefix(prefix) for name in VARIABLES if name.startswith(prefix))


#: Parts of a certificate; of the record of each state, where it is known for one of them; fields of an event, in order.
CERTIFICATE, REACHED = _after("certificate_"), _after("reached_")
EVENTS = tuple(name for name in _after("event_") if name != "state")
#: Where the name of the variable says too little.
_NAMES = {"x": "x from the loaded disk", "load": "load factor", "state_load_factor": "load factor"}


def contact_names(rows: int = len(ROWS)) -> tuple[str, ...]:
    """What follows ``contact_`` and ``wall_`` in names of variables, where so many ``ROWS`` of contacts are in use."""
    return ("overlap", "normal_force", *(name for row in ROWS[:rows] for name in row))


def flags(meanings: Sequence[str], kind: Any = np.int8) -> dict[str, Any]:
    """Attributes of a variable that holds codes, by the CF conventions."""
    return {"flag_values": np.arange(len(meanings), dtype=kind), "flag_meanings": " ".join(meanings)}


def variable(dims, values, long_name: str, **attributes) -> xr.Variable:
    """xr.Variable with the attributes that every stored variable has."""
    dimensions = (dims,) if isinstance(dims, str) else tuple(dims)
    # numpy's arrays are taken as they are: xarray need not find out whether they are Dask's
    labels = {"long_name": long_name, "units": "1", **attributes}
    return xr.Variable(dimensions, np.asarray(values), labels, fastpath=True)


def described(name: str, values: Any, *, along: str = "state", text: str = "", **attributes: Any) -> xr.Variable:
    """Values of a variable of :data:`VARIABLES`, with another dimension in place of ``state``, or another text."""
    stored, array = VARIABLES[name], np.asarray(values)
    dimensions = [along if dimension == "state" else dimension for dimension in stored.dimensions.split()]
    coded = flags(stored.codes, array.dtype) if stored.codes else {}
    return variable(dimensions, array, text or stored.text, **{**coded, **attributes})


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A result with short names and units in place of those that :func:`variable` gave.

    ``long_name`` is short enough for an axis, ``description`` says the rest. Texts are marked for xarray's own writer.
    """
    for key, one in dataset.variables.items():
        name, attributes = str(key), dict(one.attrs)
        coded = one.dtype.kind not in "iuf" or "flag_values" in attributes
        unit = "" if coded else VARIABLES[name].unit if name in VARIABLES else "1"
        named = {"long_name": _NAMES.get(name, name.replace("_", " ")), **({"units": unit} if unit else {})}
        text = attributes.pop("description", attributes.get("long_name", ""))
        others = {key: value for key, value in attributes.items() if key not in ("long_name", "units")}
        one.attrs = {**named, "description": text, **others}
        if one.dtype.kind in TEXT:
            one.encoding = dict(CHARACTERS)
    return dataset
