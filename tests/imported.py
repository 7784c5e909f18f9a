"""What the files of the packages import."""

import ast
import functools
from pathlib import Path

from places import SOURCE


@functools.cache
def imported(path: Path, *, for_types: bool) -> frozenset[str]:
    """Full names of modules in all import statements of a file below ``src``, and of what is taken from them.

    What stands there for the type checker alone is never run, and counts only ``for_types``.
    """
    package, found = path.relative_to(SOURCE).parts[:-1], set()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in () if for_types else ast.walk(tree):
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
