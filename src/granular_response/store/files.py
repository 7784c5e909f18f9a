"""Labelled datasets on disk: one netCDF-4 file, whole or not there, the same bytes for the same data.

``write`` and ``read`` are the only way in and out. A file holds one dataset, or one group for each dataset
of a study. Plain ``xarray.open_dataset(path, group=...)`` reads it without this package.

Texts are stored as characters of one length. The netCDF library keeps strings of any length in memory that it has
freed, so that opening a file with some repeatedly, or in chunks, ends Python. Labels of a dimension say their encoding,
and every reader sees words. Other texts do not: words would be Python objects, for which Dask chooses no chunks, so
that plain xarray sees bytes (``b"path"``). ``read`` makes words of both.

A file ends with a digest of what stands before it, by which damage is known: netCDF has checksums for chunks of values
alone, and a changed byte of a scalar, or of the index of the chunks, would be another value without a word.

The HDF5 library does not recover from running out of space: it gives no reason, and keeps the file open and locked for
the life of the process. So it makes the file in a folder for temporary files, and the bytes reach their place through
``atomic``, with plain writes and plain errors. They depend on the data alone.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import secrets
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
import xarray as xr
from xarray.backends import NetCDF4DataStore

from .. import __version__
from ..errors import GranularError
from ..inputs import read_bytes, unreadable
from ..scene.formats.content import foreign
from . import atomic

#: What the name of every file of datasets ends with.
SUFFIX = ".nc"
#: Root attribute by which a file of ours is known; its number grows when the layout changes.
FORMAT = "granular_response 3"

#: Kinds of arrays of texts, by the letters that numpy has for their types.
TEXT = "OUT"
#: The encoding with which xarray stores texts as characters of one length.
CHARACTERS = {"dtype": "S1"}

#: For files in memory, whatever the name of the file on disk.
_NO_NAME = "memory"
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_SEAL = b"granular_response sha256 "
_PACKED = {"zlib": True, "complevel": 4, "shuffle": True, "fletcher32": True}
#: Letters of a name that the name of a kept file begins with: at most 240 bytes, of the 255 that a name may have.
_STEM = 50
_GROUP = re.compile(r"[A-Za-z_][\w.+-]*(/[A-Za-z_][\w.+-]*)*")


class StoreError(GranularError, OSError):
    """A file that cannot be written or read as a dataset. The message is one line, first the path."""


def _error(path: str | os.PathLike[str], problem: str) -> StoreError:
    return StoreError(" ".join(f"{os.fspath(path)}: {problem}".split()))


def write(
    path: str | os.PathLike[str],
    datasets: xr.Dataset | Mapping[str, xr.Dataset],
    attributes: Mapping[str, Any] | None = None,
    *,
    keep: bool = False,
) -> None:
    """Write datasets to one netCDF-4 file, compressed and with checksums.

    Parameters
    ----------
    path : the file to make or to replace, ``.nc``. Missing folders are made.
    datasets : one dataset, or a mapping from group names (``"mu_0.2"``, ``"slab/rest"``; ``""`` is the root) to
        datasets. Every variable and coordinate has the attributes ``long_name`` and ``units``.
    attributes : of the file as a whole. ``format`` and ``package_version`` are added.
    keep : what cost a computation is not given up where ``path`` cannot be written: it is kept under a new name beside
        it, or in the current folder or that of temporary files, and the error says where.

    Raises StoreError if a variable lacks its labels, a value cannot be stored, or the file cannot be written. A file
    that was there before is then as it was.
    """
    path = _named(path)
    groups = {"": datasets} if isinstance(datasets, xr.Dataset) else dict(datasets)
    for name, dataset in groups.items():
        _check(path, name, dataset)
    marks = {**(attributes or {}), "format": FORMAT, "package_version": __version__}
    groups = {"": groups.pop("", xr.Dataset()).assign_attrs(marks), **groups}
    data = _made(path, groups)
    data += _SEAL + hashlib.sha256(data).digest()
    try:
        atomic.make_folder(path)
        atomic.write_bytes(path, data)
    except OSError as error:
        kept = _keep(path, data) if keep else None
        where = "" if kept is None else f"; what was computed is kept as {kept}"
        raise _error(path, f"cannot be written: {error.strerror or error}{where}") from error


def _keep(path: Path, data: bytes) -> Path | None:
    """The new name under which ``data`` was written, as near to ``path`` as one can be; None if nowhere."""
    for folder in (path.parent, Path(), Path(tempfile.gettempdir())):
        place = folder / f"{path.stem[:_STEM]}.kept-{secrets.token_hex(4)}{SUFFIX}"
        with contextlib.suppress(OSError):
            atomic.write_bytes(place, data)
            return place
    return None


def check_writable(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]] = ()) -> None:
    """Find out before a long computation whether ``path`` can be written and is none of the files in ``inputs``.

    Raises StoreError if not.
    """
    path = _named(path)
    try:
        atomic.make_folder(path)
        atomic.check_writable(path, inputs)
    except OSError as error:
        raise _error(path, f"cannot be written: {error.strerror or error}") from error


def _named(path: str | os.PathLike[str]) -> Path:
    """The path of a file to write. Raises StoreError if its name does not end as it must."""
    if Path(path).suffix != SUFFIX:
        raise _error(path, f"datasets are netCDF, the name must end in {SUFFIX}")
    return Path(path)


class Content(NamedTuple):
    """What a file holds, in memory."""

    datasets: dict[str, xr.Dataset]  #: by the name of their group, as ``read`` gives them
    attributes: dict[str, Any]  #: of the file as a whole
    sealed: bool  #: whether it ends with the digest of what it holds


def open_file(path: str | os.PathLike[str], *, sealed: bool = True) -> Content:
    """All that a file holds, read once. Raises StoreError as ``read`` does."""
    data, has_seal = _bytes(path)
    with _open(path, data, has_seal, sealed) as file:
        try:
            groups = {name: _load(group) for name, group in _walk(file)}
            attributes = _attributes(file)
        except Exception as error:  # a damaged file can make its decoders raise anything
            raise _error(path, f"is damaged: {error}") from error
    datasets = {name: dataset for name, dataset in groups.items() if dataset.variables or len(groups) == 1}
    return Content(datasets, attributes, has_seal)


def read(path: str | os.PathLike[str], *, sealed: bool = True) -> dict[str, xr.Dataset]:
    """All datasets of a file, in memory, by the name of their group.

    The root is there under ``""`` if it holds variables or if the file has no groups. ``sealed=False`` takes
    datasets of ours that xarray has written too, which have no digest. Raises StoreError if the file is missing,
    truncated, damaged or not one of ours.
    """
    return open_file(path, sealed=sealed).datasets


def read_attributes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Attributes of the file as a whole, without its datasets. Raises StoreError as ``read`` does."""
    with _open(path, *_bytes(path), True) as file:
        return _attributes(file)


def _attributes(file: netCDF4.Dataset) -> dict[str, Any]:
    found = {name: file.getncattr(name) for name in file.ncattrs()}
    return {name: v.item() if isinstance(v, np.generic) else v for name, v in found.items()}


def _check(path: Path, group: str, dataset: xr.Dataset) -> None:
    """Names and labels of one group."""
    if group and not _GROUP.fullmatch(group):
        raise _error(path, f"group name {group!r}: must be letters, digits, '_', '.', '+' or '-'")
    for name, variable in dataset.variables.items():
        where = f"variable {group + '/' if group else ''}{name}"
        for label in ("long_name", "units"):
            if label == "units" and "description" in variable.attrs:
                continue  # text, codes, and what has components in several units
            value = variable.attrs.get(label)
            if not isinstance(value, str) or not value.strip():
                raise _error(path, f"{where} needs the attribute {label} (units: '1' in reduced units)")


def _made(path: Path, groups: Mapping[str, xr.Dataset]) -> bytes:
    """The file as bytes, made in the folder for temporary files, or beside ``path`` where that has no place for it."""
    failed: Exception | None = None
    for beside in (None, path.parent):
        try:
            with atomic.scratch(beside) as folder:
                made = folder / "made.nc"
                try:
                    with netCDF4.Dataset(made, mode="w", format="NETCDF4") as file:
                        _fill(file, path, groups)
                    return made.read_bytes()
                except RuntimeError:
                    os.truncate(made, 0)  # HDF5 keeps it open, so its space would not be given back
                    raise
        except StoreError:
            raise
        except (OSError, RuntimeError) as error:
            failed = failed or error
    raise _error(path, f"cannot be written: {failed}; is there space in {tempfile.gettempdir()}?") from failed


def _fill(file: netCDF4.Dataset, path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write each dataset as xarray does: the same bytes for the same data."""
    for name, dataset in groups.items():
        numbers = {key: int(value) for key, value in dataset.attrs.items() if isinstance(value, (bool, np.bool_))}
        try:
            plain = _with_bytes(dataset.assign_attrs(numbers))
            encoding = {
                key: {**(_PACKED if one.ndim and one.size else {}), **(CHARACTERS if one.dtype.kind in TEXT else {})}
                for key, one in plain.variables.items()
            }
            plain.dump_to_store(NetCDF4DataStore(file.createGroup(name) if name else file), encoding=encoding)
        except (AttributeError, RuntimeError, TypeError, ValueError, NotImplementedError) as error:
            raise _error(path, f"group {name or '/'} cannot be stored: {error}") from error


def _with_bytes(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with bytes in UTF-8 in place of texts, but for the labels of dimensions."""
    coded = {}
    for key, one in dataset.variables.items():
        if one.dtype.kind in TEXT and key not in dataset.dims:
            if not all(isinstance(text, str) for text in one.values.flat):
                raise TypeError(f"variable {key} holds values that are neither numbers nor texts")
            coded[key] = one.copy(data=np.char.encode(one.values.astype(str), "utf-8"))
    return dataset.drop_indexes([name for name in dataset.xindexes if name in coded]).assign(coded)


def _bytes(path: str | os.PathLike[str]) -> tuple[bytes, bool]:
    """What a netCDF-4 file holds, and whether it ends with a digest. Raises StoreError, also if that is wrong."""
    try:
        data = read_bytes(path)
    except OSError as error:
        raise _error(path, unreadable(error)) from None
    if not data:
        raise _error(path, "is empty")
    if not _SIGNATURE.startswith(data[: len(_SIGNATURE)]):
        said = foreign(data)
        raise _error(path, f"is not a netCDF-4 file{', it ' * bool(said)}{said}")
    start = len(data) - len(_SEAL) - hashlib.sha256().digest_size
    has_seal = start > 0 and data[start : start + len(_SEAL)] == _SEAL
    # before the HDF5 library sees damaged bytes, which can end the process
    if has_seal and hashlib.sha256(memoryview(data)[:start]).digest() != data[start + len(_SEAL) :]:
        raise _error(path, "is damaged: its digest differs from the one made when it was written")
    return data, has_seal


def _open(path: str | os.PathLike[str], data: bytes, has_seal: bool, sealed: bool) -> netCDF4.Dataset:
    try:
        dataset = netCDF4.Dataset(_NO_NAME, mode="r", memory=data)
        attributes = {name: dataset.getncattr(name) for name in dataset.ncattrs()}
    except Exception as error:  # damage can surface as nearly any kind of error
        raise _error(path, "is truncated or damaged") from error
    layout = attributes.get("format")
    by_xarray = not sealed and attributes.get("package") == "granular_response" and layout is None
    if (layout == FORMAT and (has_seal or not sealed)) or by_xarray:
        return dataset
    dataset.close()
    if layout == FORMAT:
        raise _error(path, "is truncated or damaged, or another program has written it anew")
    if re.fullmatch(r"granular_response \d+", str(layout)):
        raise _error(path, f"was written by another version: format = {layout!r}, must be {FORMAT!r}")
    raise _error(path, f"was not written by granular_response (no attribute format = {FORMAT!r})")


def _walk(file: netCDF4.Dataset, prefix: str = "") -> list[tuple[str, netCDF4.Dataset]]:
    """All groups with their full names, the root first."""
    found = [(prefix, file)]
    for name, group in file.groups.items():
        found += _walk(group, f"{prefix}/{name}".lstrip("/"))
    return found


def _load(group: netCDF4.Dataset) -> xr.Dataset:
    store = NetCDF4DataStore(group)
    # seconds stay numbers: decoding them to time spans would lose digits
    dataset = xr.open_dataset(store, decode_times=False, decode_timedelta=False).load()
    texts = {
        key: one.copy(data=np.char.decode(one.values, "utf-8") if one.dtype.kind == "S" else one.values.astype(str))
        for key, one in dataset.variables.items()
        if one.dtype.kind in "SO"
    }
    return dataset.assign(texts).drop_encoding()
