"""From datasets to figures."""

from __future__ import annotations

import os
from pathlib import Path

from granular_response import store
from granular_response.pipeline import data_path, figures_folder, group_function


def draw(group: str, data: Path | None = None, folder: Path | None = None) -> list[Path]:
    """Draw the figures of a group from its datasets; returns the paths of the files.

    Raises
    ------
    granular_response.pipeline.GroupError
        If there is no such group.
    granular_response.store.StoreError
        If its datasets cannot be read.
    """
    os.environ.setdefault("MPLBACKEND", "Agg")
    function = group_function("draw", group)
    datasets = store.read(data or data_path(group))
    from granular_response.figures import style

    paths: list[Path] = []
    for stem, figure in function(datasets).items():
        paths += style.save(figure, stem, folder or figures_folder(group))
    return paths
