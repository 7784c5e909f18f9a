"""The reference of the scene keys, made from their descriptions; ``expand.py`` puts it into its page."""

from __future__ import annotations

from collections.abc import Sequence

from granular_response.cli.scene_reference import sections
from granular_response.scene import Scene


def lines() -> str:
    """All keys as Markdown: the parts of a scene, then a table for each."""
    parts = [(f"`{name}`", info.description or "") for name, info in Scene.model_fields.items()]
    found = [_table(("part", "meaning"), parts)]
    for section in sections():
        rows = [
            (
                f"`{key.path}`",
                f"`{key.default}`" if key.default else "must be given",
                f"{key.allowed} [{key.unit}]" if key.unit else key.allowed,
                key.meaning,
            )
            for key in section.listed()
        ]
        found += [f"## {section.title}", _table(("key", "default", "allowed [unit]", "meaning"), rows)]
    return "\n\n".join(found) + "\n"


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """A Markdown table; a bar within a cell would end it."""
    texts = [head, ("---",) * len(head), *(tuple(cell.replace("|", "\\|") for cell in row) for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in texts)
