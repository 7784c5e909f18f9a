"""DVC with a lock that is replaced in one step, children that end with it, and notes and a cache that decide nothing.

Around every stage DVC reads ``dvc.lock``, empties it and takes a third of a second to write it. A run that is killed
meanwhile would lose the record of all stages. DVC also reads it in a way that keeps comments, of which a lock has none;
without that each stage costs half a second less, and the text is the same.

It refuses to go on where its note of files in use was left cut or its database of digests is damaged. What its cache
holds it takes for whole where nobody may write to it.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from granular_response.store import atomic


@contextmanager
def modified(path: str | os.PathLike[str], fs: Any = None) -> Iterator[dict[str, Any]]:
    """What DVC calls to change a lock: its content, which is written at the end; the file is whole at any moment."""
    from dvc.utils.serialize import dumps_yaml, parse_yaml

    file = Path(path)
    content = parse_yaml(file.read_text(encoding="utf-8"), path) if file.exists() else {}
    yield content
    atomic.write_bytes(file, dumps_yaml(content).encode())


def in_use(file: Any) -> Any:
    """What DVC calls to read which files its processes use; nothing where a killed one has left that cut."""
    with suppress(ValueError):
        return json.load(file)
    return {}


def opened(open_it: Callable[..., None], cache: Any, directory: str, **settings: Any) -> None:
    """Open a database of digests, which is begun anew where it is damaged."""
    try:
        open_it(cache, directory, **settings)
        if cache._sql("PRAGMA integrity_check(1)").fetchall() != [("ok",)]:
            raise sqlite3.DatabaseError
    except sqlite3.OperationalError:  # it is in use
        raise
    except sqlite3.DatabaseError:
        shutil.rmtree(directory)
        open_it(cache, directory, **settings)


#: Seconds that a stage has to end after an interruption, which a shell misses while it starts a command.
PATIENCE = 10.0

#: Ends its process group when the process that holds its input is gone, however that ended.
_GUARD = ["sh", "-c", "read -r nothing; kill -TERM 0"]


@contextmanager
def running(arguments: Sequence[str], folder: Path) -> Iterator[subprocess.Popen[str]]:
    """DVC in a folder, with its output. It and all that it starts end with this process."""
    command = [sys.executable, "-P", "-m", __spec__.name, *arguments]
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    nothing, pipe = subprocess.DEVNULL, subprocess.PIPE
    with (
        subprocess.Popen(_GUARD, stdin=pipe, process_group=0) as guard,
        subprocess.Popen(
            command, cwd=folder, env=environment, stdin=nothing, stdout=pipe, text=True, process_group=guard.pid
        ) as run,
    ):
        try:
            yield run
            run.wait()
        except KeyboardInterrupt:  # by the terminal, which reaches this process alone
            os.killpg(guard.pid, signal.SIGINT)
            with suppress(subprocess.TimeoutExpired):
                run.wait(PATIENCE)
            raise
        finally:
            os.killpg(guard.pid, signal.SIGTERM)  # a stage may outlive DVC that was interrupted while it started it
            run.wait()


if __name__ == "__main__":
    from dvc import dvcfile, rwlock
    from dvc.cli import main
    from dvc_data.hashfile.cache import Cache
    from dvc_data.hashfile.db import HashFileDB
    from dvc_data.hashfile.db.local import LocalHashFileDB

    assert callable(dvcfile.modify_yaml), "DVC changes its lock in another way"
    dvcfile.modify_yaml = modified
    rwlock.json = SimpleNamespace(**vars(json) | {"load": in_use})
    LocalHashFileDB.check = HashFileDB.check  # type: ignore[method-assign]
    open_it = Cache.__init__
    Cache.__init__ = lambda *given, **settings: opened(open_it, *given, **settings)  # type: ignore[method-assign]
    sys.exit(main())
