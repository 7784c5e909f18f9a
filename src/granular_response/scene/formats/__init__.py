"""Tables of disks from elsewhere: one module for each format, each with ``read(path) -> Table``.

What is read is what the file says, in its own units; ``scene.table`` makes a packing of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

from ...inputs import read_bytes
from .content import recognised
from .table import NO_BOX, FileBox, FormatError, Mark, Table

#: Formats of files that hold disks, and the endings of names by which each is known.
SUFFIXES = {
    "csv": (".csv",),
    "lammps-data": (".data", ".lmp"),
    "lammps-dump": (".dump", ".lammpstrj"),
    "gsd": (".gsd",),
}
_MODULES = {name: name.replace("-", "_") for name in SUFFIXES} | {"csv": "csv_table", "gsd": "gsd_file"}


def by_suffix(path: str | Path) -> str:
    """The format that a name ends with; csv for any other ending."""
    suffix = Path(path).suffix.lower()
    return next((name for name, suffixes in SUFFIXES.items() if suffix in suffixes), "csv")


def read(path: Path, file_format: str, columns: Mapping[str, str] | None = None) -> Table:
    """The disks in a file. Raises FormatError for what cannot be read, OSError, and UnicodeError for other text.

    ``columns`` says which columns of a CSV table are meant.
    """
    reader = import_module(f".{_MODULES[file_format]}", __name__).read
    try:
        table: Table = reader(path, columns) if columns else reader(path)
    except (FormatError, UnicodeError):
        if (other := recognised(read_bytes(path))) in ("", file_format):
            raise
        raise FormatError(f"is of format {other} by its content, not {file_format}: packing.format says so") from None
    return table


__all__ = ["NO_BOX", "SUFFIXES", "FileBox", "FormatError", "Mark", "Table", "by_suffix", "read"]
