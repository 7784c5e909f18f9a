"""How kernels are compiled, and where their machine code is kept.

Numba keeps machine code by the file of a kernel, but a kernel also holds code inlined from other files. So the folder
is named after all sources that kernels are made of: what was compiled from others is never found again. Nothing is
ever deleted here.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba as nb

from .turns import Turns

_PACKAGE = Path(__file__).parents[1]
#: Folders of the package whose files make kernels or are inlined into them.
SOURCES = ("contact", "kernels", "machine", "solve/linear", "state")


def kernel(function: Callable | None = None, **options: Any) -> Any:
    """Decorator: compile with Numba on first use and keep the machine code.

    Kernels have no Python errors of division, make no arrays and so count no references to them: counting costs a
    small scene half of its time. ``options`` are those of ``numba.njit`` beside that.

    Raises
    ------
    ValueError
        For ``fastmath``: the compiler then sums in the order of a processor's registers, and others give other digits.
    """
    if options.get("fastmath"):
        raise ValueError("fastmath is not allowed: results would depend on the processor; write out the order of sums")
    if function is None:
        return partial(kernel, **options)
    folder = cache_folder()
    before = nb.config.CACHE_DIR
    if folder is not None:
        nb.config.CACHE_DIR = str(folder)  # asked for when a function is decorated, so others keep their own
    try:
        compiled = nb.njit(cache=folder is not None, error_model="numpy", _nrt=False, **options)(function)
    finally:
        nb.config.CACHE_DIR = before
    if folder is not None and hasattr(compiled, "_cache"):  # not with compilation off
        _keep_own_types_alone(compiled)
        _compile_in_turn(compiled, _turns(folder))
    return compiled


def _keep_own_types_alone(compiled: Any) -> None:
    """Code for a law or an integrator from elsewhere is not kept: a process that lacks it could not read the index."""
    save = compiled._cache.save_overload

    def save_own(arguments: Any, data: Any) -> None:
        if all(map(_is_own, arguments)):
            save(arguments, data)

    compiled._cache.save_overload = save_own


@cache
def _turns(folder: Path) -> Turns:
    return Turns(folder / "turns")


def _compile_in_turn(compiled: Any, turns: Turns) -> None:
    """What is kept nowhere yet is compiled by one process; others wait for its turn to end and look again.

    Processes that keep code of one kernel for different arguments do so one after another: each writes the index whole.
    """
    kept, name = compiled._cache, f"{compiled.py_func.__module__}.{compiled.py_func.__qualname__}"
    load, save, compile_one = kept.load_overload, kept.save_overload, compiled.compile
    mine: set[str] = set()

    def load_or_take(arguments: Any, context: Any) -> Any:
        found = load(arguments, context)
        turn = f"{name}{arguments}"
        if found is None and all(map(_is_own, arguments)) and turns.take(turn):
            mine.add(turn)
            found = load(arguments, context)
        return found

    def save_alone(arguments: Any, data: Any) -> None:
        with turns.taken(name):
            save(arguments, data)

    def compile_and_end(arguments: Any) -> Any:
        try:
            return compile_one(arguments)
        finally:
            turn = f"{name}{arguments}"
            if turn in mine:
                mine.remove(turn)
                turns.give_back(turn)

    kept.load_overload, kept.save_overload, compiled.compile = load_or_take, save_alone, compile_and_end


def _is_own(kind: Any) -> bool:
    """Whether a type, with its parts, is Numba's or of a class of this package."""
    made_by = getattr(kind, "instance_class", None)
    if made_by is not None and made_by.__module__.partition(".")[0] != __name__.partition(".")[0]:
        return False
    return all(map(_is_own, getattr(kind, "types", ())))


@cache
def cache_folder() -> Path | None:
    """The folder for machine code of these sources; None where nothing may be written.

    In ``NUMBA_CACHE_DIR`` if that is set, else in the package's ``__pycache__``, else in the user's cache.
    """
    name = source_digest()
    for base in _bases():
        folder = base / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK | os.X_OK):
            return folder
    return None


def _bases() -> Iterator[Path]:
    if nb.config.CACHE_DIR:
        yield Path(nb.config.CACHE_DIR)
    yield _PACKAGE / "__pycache__" / "machine_code"
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(home):
        yield Path(home) / "granular_response"


def source_digest() -> str:
    """Name of the present state of the sources."""
    digest = hashlib.sha256()
    for part in SOURCES:
        for path in sorted((_PACKAGE / part).rglob("*.py")):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
