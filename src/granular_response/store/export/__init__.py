"""Results as files for other programs: ``text``, ``lammps``, ``gsd_file`` and ``vtk``, by the suffix.

Files of frames (``.gsd``, ``.xyz``, ``.dump``) have all states or the one asked for, ``.pvd`` all, each in a ``.vtu``
beside it, the others one. ``.events.csv`` has the events on the way to them, ``.vtu`` as field data; the other formats
leave them out. ``.lammps`` is an input script, with a ``.data`` beside it. Suffixes of ``scene.formats`` hold disks
alone, which ``packing: {kind: file}`` reads again.

Disks lie in the plane of the screen: file coordinates are (x, z, 0).
Units are those of the result: mean disk radius, mean disk mass, g.
"""

from __future__ import annotations

import contextlib
import os
import re
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...errors import GranularError, require
from ...scene import Scene, formats
from .. import atomic
from ..checked import read_result
from ..result import CONTACTS, chosen_states, scene_of
from . import gsd_file, lammps, text, vtk
from .frames import contact_force_sums

#: Of one dataset, the files to write: content by path. Writers of frames take the index of the only state too.
Writer = Callable[..., dict[Path, bytes]]

#: For each suffix what writes it, and the states of its file: the one asked for, every one, or either as frames.
_WRITERS: dict[str, tuple[Writer, str]] = {
    ".contacts.csv": (text.contacts, "one"),
    ".events.csv": (text.events, "frames"),
    ".gsd": (gsd_file.files, "frames"),
    ".lammps": (lammps.script, "one"),
    ".pvd": (vtk.files, "every"),
    ".vtu": (vtk.files, "one"),
    ".xyz": (text.xyz, "frames"),
    **dict.fromkeys(formats.SUFFIXES["csv"], (text.csv_table, "one")),
    **dict.fromkeys(formats.SUFFIXES["lammps-data"], (text.lammps_data, "one")),
    **dict.fromkeys(formats.SUFFIXES["lammps-dump"], (text.lammps_dump, "frames")),
}
#: Those that a scene reads again.
_READ = {suffix for suffixes in formats.SUFFIXES.values() for suffix in suffixes}
#: Those that take what ``gr.motion`` returns, which has no contacts.
_OF_MOTION = (lammps.script, text.csv_table, text.lammps_data)
#: What the name of a file may be that stands in its own text: as a word of LAMMPS, where quotes do not help against
#: ``*``, ``%`` and ``&``, and as an attribute of XML.
_NAMES = {
    ".lammps": (re.compile(r"[A-Za-z0-9._+=@,~-]+"), "letters a to z, digits and . _ + = @ , ~ -"),
    ".pvd": (re.compile(r"[^\x00-\x1f\x7f\ufffe\uffff]+"), "letters without line ends and other control characters"),
}
#: What a file name may end with.
SUFFIXES = tuple(sorted(_WRITERS))


class ExportError(GranularError):
    """A result that cannot be exported. The message is one line."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


def export(result: Any, output: str | os.PathLike[str], *, state: int | None = None) -> Path:
    """Write a result, its file or dataset, or a motion, as a file for another program; returns its path.

    What the name of ``output`` ends with (one of ``SUFFIXES``) is the format. ``state`` is the index of the only state
    to write, or of the time of a motion; if None all, or the last one in a file of one state. Of a motion there are
    disks for LAMMPS with their velocities (``.data``, and ``in.lammps`` with a script), and ``.csv``.

    Raises ExportError for what is none of these, another ending, a name that cannot stand in a script, a file that the
    result or its packing is read from, a state that does not exist or of a series of all, or a missing library,
    StoreError if the result cannot be read, ResultError if it is none.

    Warns (UserWarning) of what a format that can be read again as a packing does not carry: the tangential springs of
    contacts, from which friction goes on.

    Examples
    --------
    >>> ball = gr.Scene.from_arrays(x=[5.0], z=[3.0], radius=1.0, width=10.0, vx=0.5, scene={"loads": []})
    >>> gr.export(gr.motion(ball, [0.0, 1.0]), "ball.data", state=0).read_text().splitlines()[-1]
    '1 0.5 0.0 0.0 0.0 0.0 0.0'
    """
    output = Path(output)
    double = "".join(output.suffixes[-2:])
    ending = double if double in _WRITERS else output.suffix
    require(ending in _WRITERS, f"{output}: format {ending!r} is unknown, must be {' or '.join(SUFFIXES)}", ExportError)
    writer, states = _WRITERS[ending]
    pattern, letters = _NAMES.get(ending, (None, ""))
    rule = f"{output}: must have a name of {letters}, for it stands in the file"
    require(not pattern or pattern.fullmatch(output.name), rule, ExportError)
    rule = "is a series of all states, must be left out (.vtu holds one state)"
    require(states != "every" or state is None, f"state = {state}: {output} {rule}", ExportError)
    scene = getattr(result, "scene", None)
    if not isinstance(result, (str, os.PathLike, xr.Dataset)):
        result = result.to_dataset() if hasattr(result, "to_dataset") else xr.Dataset()
    read = [] if isinstance(result, xr.Dataset) else [result]
    dataset = result if isinstance(result, xr.Dataset) else read_result(result, sealed=False)
    rule = f"{output}: must be written of a result, its file or dataset, or of what gr.motion returns"
    require({"disk", "axis"} <= set(dataset.dims) and {"state", "time"} & set(dataset.dims), rule, ExportError)
    if "state" not in dataset.dims:
        if writer not in _OF_MOTION:
            known = " or ".join(suffix for suffix, (one, _) in sorted(_WRITERS.items()) if one in _OF_MOTION)
            raise ExportError(f"{output}: a motion has no contacts, must be {known}")
        dataset = dataset.rename(time="state", load_factor="state_load_factor")
    count = dataset.sizes["state"]
    rule = f"state = {state}: must be from {-count} to {count - 1}, there are {count} states"
    require(state is None or -count <= state < count, rule, ExportError)
    # the first state stays: what a load adds is the difference from it
    chosen = chosen_states(dataset, [0, -1 if state is None else state]) if states == "one" else dataset
    only = {} if states != "frames" or state is None else {"only": state % count}
    if "scene" in dataset.attrs:  # disks that its packing is read from may have the name of a file beside a script
        with contextlib.suppress(GranularError):
            read += (scene if isinstance(scene, Scene) else scene_of(dataset)).files
    try:
        atomic.make_folder(output)
        atomic.check_writable(output, read)
        made = writer(chosen, output, **only)
        for path in made:
            atomic.check_writable(path, read)
        for path, content in made.items():
            atomic.write_bytes(path, content)
    except lammps.NoCounterpart as error:
        raise ExportError(f"{output}: {error}") from None
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        raise ExportError(f"{output}: needs the package {error.name}, pip install {package}") from error
    except OSError as error:
        raise ExportError(f"{output}: cannot be written: {error.strerror or error}") from error
    if ending in _READ or ending == ".lammps":
        for remark in _lost(dataset.isel(state=-1 if state is None else state), writer):
            warnings.warn(f"{output}: {remark}", stacklevel=2)
    return output


def _lost(state: xr.Dataset, writer: Writer) -> Iterator[str]:
    """What is another one where a file of one state is read as a packing."""
    if writer is lammps.script and lammps.wound_springs(state):
        return
    if "contact_spring" not in state:
        bears = bool(state["contacts"] > 0) and bool(state["state"] > 0.0)
        if bears:
            yield "a motion has no springs of contacts: those that are closed begin anew"
    elif any(np.any(state[f"{prefix}_spring"].values) for prefix in CONTACTS):
        kept = "a .contacts.csv beside it has them, for packing.springs"
        yield f"the format has no springs of friction: read again, contacts begin anew ({kept})"


__all__ = ["SUFFIXES", "ExportError", "contact_force_sums", "export"]
