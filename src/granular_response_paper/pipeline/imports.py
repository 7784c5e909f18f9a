"""What a module imports in the end, read from its source without running it."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from granular_response_paper.registry import collections


@cache
def packages() -> dict[str, Path]:
    """The packages of this project that are installed, and the folder each stands in."""
    found = {}
    for name in dict.fromkeys(("granular_response", *(one.package.partition(".")[0] for one in collections()))):
        spec = find_spec(name)
        if spec is not None and spec.origin is not None:
            found[name] = Path(spec.origin).parents[1]
    return found


@cache
def file_of(module: str) -> Path | None:
    """The file of a module of this project; None if there is none of this name."""
    source = packages().get(module.partition(".")[0])
    if source is None:
        return None
    base = source.joinpath(*module.split("."))
    return next((path for path in (base / "__init__.py", base.with_suffix(".py")) if path.is_file()), None)


@cache
def imported(path: Path, package: tuple[str, ...]) -> frozenset[str]:
    """Full names of modules in the import statements of a file of a ``package``, and of what is taken from them.

    What stands there for the type checker alone is never run, and does not count.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING"):
            node.body = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parents = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join([*parents, *([node.module] if node.module else [])])
            found.update((base, *(f"{base}.{alias.name}" for alias in node.names)))
    return frozenset(found)


def closure(starts: Iterable[str]) -> set[str]:
    """Every module of this project that is imported in the end, with the packages on the way."""
    todo, seen = list(starts), set()
    while todo:
        module = todo.pop()
        path = file_of(module)
        if module in seen or path is None:
            continue
        seen.add(module)
        package = tuple(module.split(".")) if path.name == "__init__.py" else tuple(module.split(".")[:-1])
        todo += imported(path, package)
        if "." in module:
            todo.append(module.rpartition(".")[0])
    return seen
