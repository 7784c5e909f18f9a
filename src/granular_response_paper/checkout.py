"""What ran is what is recorded: a pipeline records the sources of its checkout, so these must be the ones that run."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from granular_response.errors import GranularError

from .registry import PAPER, Collection


class CheckoutError(GranularError):
    """Other sources run than those that the pipeline records. The message is one line."""


def check(collection: Collection = PAPER, start: Path = Path(".")) -> None:
    """Raise CheckoutError unless library, paper and collection run from the sources of the checkout around ``start``.

    A checkout is a folder with ``dvc.yaml`` and the sources of the package, ``start`` itself or the nearest above it.
    A package that was imported from elsewhere must be the same there, file by file: a copy, a second clone, a worktree
    or an installed package runs as long as nothing in it differs. Outside a checkout nothing is refused.
    """
    here = start.resolve()
    folders = [one for above in (here, *here.parents) for one in (above, above / collection.folder)]
    checkouts = [one for one in folders if (one / "dvc.yaml").is_file()]
    for package, imported in _imported(collection).items():
        own = next((one for top in checkouts if (one := top / "src" / package).is_dir()), None)
        if own and imported != own.resolve() and (name := _difference(own, imported)):
            raise CheckoutError(
                f"{package} runs from {imported}, whose {name} is not that of this checkout ({own}): "
                "use the checkout's own environment, made by make setup"
            )


@contextmanager
def unchanged(collection: Collection = PAPER, start: Path = Path(".")) -> Iterator[None]:
    """Call ``check``, and at the end raise CheckoutError if a module that ran was edited meanwhile.

    DVC records files as they are when a stage has ended.
    """
    check(collection, start)
    folders = _imported(collection).values()
    before = {folder / name: content for folder in folders for name, content in _files(folder).items()}
    yield
    ran = {Path(file).resolve() for one in list(sys.modules.values()) if (file := getattr(one, "__file__", None))}
    for path in sorted(ran & before.keys()):
        if not path.is_file() or path.read_bytes() != before[path]:
            raise CheckoutError(f"{path} changed while it ran; run the stage again")


def _imported(collection: Collection) -> dict[str, Path]:
    """The folders that library, paper and collection are imported from."""
    names = dict.fromkeys(("granular_response", "granular_response_paper", collection.package.partition(".")[0]))
    specs = {name: find_spec(name) for name in names}
    return {name: Path(one.origin).resolve().parent for name, one in specs.items() if one and one.origin}


def _difference(own: Path, imported: Path) -> str:
    """The first file that differs, empty if there is none; a module that only one of them has is a difference."""
    here, there = _files(own), _files(imported)
    names = sorted({*here, *(name for name in there if name.endswith(".py"))})
    return next((name for name in names if here.get(name) != there.get(name)), "")


def _files(folder: Path) -> dict[str, bytes]:
    """Contents of the sources in a folder, by path: neither what is compiled nor what only builds a package."""
    no_source = (".pyc", ".nbi", ".nbc", ".toml")
    found = {path.relative_to(folder): path for path in folder.rglob("*") if path.suffix not in no_source}
    return {
        name.as_posix(): path.read_bytes()
        for name, path in found.items()
        if path.is_file() and not any(part.startswith((".", "__pycache__")) for part in name.parts)
    }
