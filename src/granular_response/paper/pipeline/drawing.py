"""From datasets to figures."""

from __future__ import annotations

from pathlib import Path

from granular_response.paper.pipeline import figures_folder, group_member, stored


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
    path, datasets = stored.datasets(group, data)
    from granular_response.plot import style

    paths: list[Path] = []
    for stem, figure in function(datasets).items():
        paths += style.save(figure, stem, folder or figures_folder(group), inputs=[path])
    return paths
