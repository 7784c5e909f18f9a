"""The command lines as a test runs them: in a new process, or in one forked from a process that imported everything.

Both have their own folder, streams and exit code, and a forked one begins in a hundredth of the time that imports take.
What a process does before it has imported anything, and what it must not import, is tested by new ones.
"""

from __future__ import annotations

import atexit
import importlib
import os
import pickle
import pkgutil
import socket
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Sequence
from functools import cache
from pathlib import Path

LIBRARY, PAPER = "granular_response", "granular_response_paper"
#: Commands of the reproduction; all others are the library's.
OF_THE_PAPER = ("simulate", "draw", "measure", "claims", "report", "notebooks", "archive", "restore")
#: Of a command, in seconds.
LONGEST = 120.0


def package_of(*arguments: object) -> str:
    """The package whose command line has a command."""
    return PAPER if arguments and arguments[0] in OF_THE_PAPER else LIBRARY


def process(
    *arguments: object, folder: str | Path | None = None, package: str | None = None, **options
) -> subprocess.CompletedProcess[str]:
    """``granular-response ARGUMENTS``, or that of ``package``, in a new process; ``options`` of ``subprocess.run``."""
    command = [sys.executable, "-m", package or package_of(*arguments), *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, **options)


def call(
    *arguments: object, folder: str | Path | None = None, package: str | None = None
) -> subprocess.CompletedProcess[str]:
    """The same in a forked process."""
    argv = [package or package_of(*arguments), *map(str, arguments)]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        server = _server()
        request = pickle.dumps((argv, str(folder or Path.cwd()), dict(os.environ)))
        socket.send_fds(server, [request], [out.fileno(), err.fileno()])
        code = int(server.recv(64))
        for stream in (out, err):
            stream.seek(0)
        return subprocess.CompletedProcess(argv, code, out.read().decode(), err.read().decode())


@cache
def _server() -> socket.socket:
    """The connection to the process that forks; it ends when this one does."""
    ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with its:
        process = subprocess.Popen([sys.executable, __file__, str(its.fileno())], pass_fds=[its.fileno()])
    ours.settimeout(LONGEST)
    atexit.register(process.wait)
    atexit.register(ours.close)
    return ours


def _serve(connection: socket.socket) -> None:
    for name in (LIBRARY, PAPER):
        package = importlib.import_module(name)
        for module in pkgutil.walk_packages(package.__path__, f"{name}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    while True:
        request, descriptors, _, _ = socket.recv_fds(connection, 1 << 20, 2)
        if not request:
            return
        child = os.fork()
        if child == 0:
            connection.close()
            os._exit(_run(*pickle.loads(request), descriptors))
        for descriptor in descriptors:
            os.close(descriptor)
        connection.send(str(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])).encode())


def _run(argv: Sequence[str], folder: str, environment: dict[str, str], descriptors: Sequence[int]) -> int:
    """The exit code of the command, as an interpreter would end with."""
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    with open(os.devnull) as nothing:
        os.dup2(nothing.fileno(), 0)
    for ours, theirs in zip((1, 2), descriptors, strict=True):
        os.dup2(theirs, ours)
        os.close(theirs)
    sys.argv = list(argv)
    try:
        sys.modules[{LIBRARY: f"{LIBRARY}.cli.main", PAPER: f"{PAPER}.cli"}[argv[0]]].main()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    return code


if __name__ == "__main__":
    os.environ.setdefault("MPLBACKEND", "Agg")
    _serve(socket.socket(fileno=int(sys.argv[1])))
