"""What ran is what is recorded: a pipeline records the sources of its checkout, so these must be the ones that run."""

from __future__ import annotations

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
    names = ("granular_response", "granular_response_paper", collection.package.partition(".")[0])
    for package in dict.fromkeys(names):
        own = next((one for top in checkouts if (one := top / "src" / package).is_dir()), None)
        spec = find_spec(package)
        if own is None or spec is None or spec.origin is None:
            continue
        imported = Path(spec.origin).resolve().parent
        if imported != own.resolve() and (name := _difference(own, imported)):
            raise CheckoutError(
                f"{package} runs from {imported}, whose {name} is not that of this checkout ({own}): "
                "use the checkout's own environment, made by make setup"
            )


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
