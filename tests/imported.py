"""What the files of the packages import."""

from pathlib import Path

from places import SOURCE

from granular_response_paper.pipeline import imports


def imported(path: Path, *, for_types: bool) -> frozenset[str]:
    """Full names of modules that a file below ``src`` imports, those for the type checker alone only ``for_types``."""
    return imports.imported(path, path.relative_to(SOURCE).parts[:-1], for_types=for_types)
