"""The command lines as a test runs them: in a new process, or in one forked from a process that imported everything.

Both have their own folder, streams and exit code, and a forked one begins in a hundredth of the time that imports take.
What a process does before it has imported anything, and what it must not import, is tested by new ones.
"""

from __future__ import annotations

import importlib
import multiprocessing
import os
import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from multiprocessing import forkserver
from pathlib import Path

LIBRARY, PAPER = "granular_response", "granular_response_paper"
#: Commands of the reproduction; all others are the library's.
OF_THE_PAPER = {"simulate", "draw", "claims", "reproduce", "report"}
#: A scene that is solved at once.
SCENE = """\
packing: {kind: slab, layers: 3, disks_per_row: 5}
contact: {friction: 0.0}
loads: [{disk: top-centre, force: [0.0, -1.0]}]
"""
#: Of a command, in seconds.
LONGEST = 600.0
#: What a command says each minute that it takes, as it may on a busy machine that compiles.
_EACH_MINUTE = re.compile(r"^[^:\n]+: \S+ of \S+, \d+ s\n", re.M)
#: What worker processes and commands of tests import, with what the test modules do whose functions they run.
IMPORTED = [
    "granular_response.api.sweep",
    "granular_response.cli.main",
    "granular_response.plot.pictures",
    "granular_response.store.export",
    "granular_response.store.result",
    "granular_response.store.summary",
    "granular_response_paper.claims.table",
    "granular_response_paper.cli",
    "granular_response_paper.pipeline.drawing",
    "granular_response_paper.pipeline.simulation",
    "granular_response_paper.report",
    "hypothesis",
    "pytest",
    "xarray",
]


def preload() -> None:
    """From here on processes are forked from one that has imported this much, which each would else import itself."""
    multiprocessing.get_context("forkserver").set_forkserver_preload(IMPORTED)
    forkserver.ensure_running()


def package_of(*arguments: object) -> str:
    """The package whose command line has a command."""
    return PAPER if arguments and arguments[0] in OF_THE_PAPER else LIBRARY


def process(
    *arguments: object, folder: str | Path | None = None, package: str | None = None, **options
) -> subprocess.CompletedProcess[str]:
    """``granular-response ARGUMENTS``, or that of ``package``, in a new process; ``options`` of ``subprocess.run``."""
    command = [sys.executable, "-m", package or package_of(*arguments), *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, **options)
    done.stderr = _EACH_MINUTE.sub("", done.stderr)
    return done


def python(*arguments: object, folder: str | Path | None = None, **environment: str) -> str:
    """What ``python ARGUMENTS`` prints in a new process with these variables too. It must end well, and in time."""
    command, variables = [sys.executable, *map(str, arguments)], {**os.environ, **environment}
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=variables, timeout=3.0 * LONGEST)
    assert run.returncode == 0, run.stderr
    return run.stdout


def call(
    *arguments: object,
    folder: str | Path | None = None,
    package: str | None = None,
    start: str = "forkserver",
    memory: int | None = None,
) -> subprocess.CompletedProcess[str]:
    """The same in a process forked from one that has imported everything, or (``start="fork"``) from this one.

    It gets ``memory`` bytes more than it has at most.
    """
    argv = [package or package_of(*arguments), *map(str, arguments)]
    with tempfile.TemporaryDirectory() as place:
        streams = [Path(place, name) for name in ("out", "err")]
        asked = (argv, str(folder or Path.cwd()), dict(os.environ), *map(str, streams), memory)
        child = multiprocessing.get_context(start).Process(target=_run, args=asked)
        child.start()
        child.join(LONGEST)
        if child.is_alive():
            child.kill()
        out, err = (one.read_text(encoding="utf-8", errors="replace") for one in streams)
        return subprocess.CompletedProcess(argv, child.exitcode, out, _EACH_MINUTE.sub("", err))


def succeeded(*arguments: object, folder: str | Path | None = None) -> str:
    """What a command prints that must end well."""
    done = call(*arguments, folder=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def refused(*arguments: object, folder: str | Path | None = None) -> str:
    """The one line in which a command says why it does nothing."""
    done = call(*arguments, folder=folder)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert done.stderr.startswith("granular-response")
    return done.stderr


def _run(argv: Sequence[str], folder: str, environment: dict[str, str], out: str, err: str, memory: int | None) -> None:
    """The command, in this process; its end is that of the process."""
    for descriptor, name in enumerate((os.devnull, out, err)):
        mode = os.O_RDONLY if descriptor == 0 else os.O_WRONLY | os.O_CREAT
        os.dup2(os.open(name, mode), descriptor)
    sys.stdout, sys.stderr = (open(descriptor, "w", encoding="utf-8", closefd=False) for descriptor in (1, 2))  # noqa: SIM115
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    if memory is not None:
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + memory,) * 2)
    sys.argv = list(argv)
    importlib.import_module({LIBRARY: f"{LIBRARY}.cli.main", PAPER: f"{PAPER}.cli"}[argv[0]]).main()
