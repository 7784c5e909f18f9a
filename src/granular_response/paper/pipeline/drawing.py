"""From datasets to figures."""

from __future__ import annotations

from pathlib import Path

from granular_response.paper.pipeline import GroupError, data_path, figures_folder, group_member
from granular_response.store import files as store


def draw(group: str, data: Path | None = None, folder: Path | None = None) -> list[Path]:
    """Draw the figures of a group from its datasets; returns the paths of the files.

    Raises
    ------
    granular_response.pipeline.GroupError
        If there is no such group, or the datasets are those of another one.
    granular_response.store.StoreError
        If its datasets cannot be read.
    """
    function = group_member(group, "draw", "draw")
    path = data or data_path(group)
    datasets = store.read(path)
    stored = store.read_attributes(path).get("group")
    if stored != group:
        what = f"those of {stored}" if stored else "not those of a figure group"
        raise GroupError(f"{path}: holds datasets of another kind, {what}, must be those of {group}")
    from granular_response.plot import style

    paths: list[Path] = []
    for stem, figure in function(datasets).items():
        paths += style.save(figure, stem, folder or figures_folder(group), inputs=[path])
    return paths
