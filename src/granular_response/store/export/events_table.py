"""A CSV table of the events of the load path; every digit is kept."""

from __future__ import annotations

import csv
import io
from dataclasses import astuple
from pathlib import Path

import xarray as xr

from ..result import events_from
from ..variables import EVENTS


def files(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """The file as bytes, of all events or those on the way to the state with the index ``only``."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["state", *EVENTS])
    table.writerows([state, *astuple(event)] for state, event in events_from(dataset, only))
    return {path: text.getvalue().encode("utf-8")}
