"""From datasets to figures and their captions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from granular_response.scene import SceneError, text
from granular_response.store import atomic
from granular_response.store import files as store
from granular_response_paper import TOO_LITTLE, captions
from granular_response_paper.pipeline import data_path
from granular_response_paper.registry import GroupError, group_member


def draw(group: str, data: Path | None = None, folder: Path | None = None, formats: Sequence[str] = ()) -> list[Path]:
    """Draw the figures of a group from its datasets and write their captions; returns the paths of the files.

    Figures are PNG files, and ``formats`` (pdf, svg) besides. Animations of a group (``animations`` of its ``draw.py``)
    are GIFs, each beside the picture of its name.

    Raises GroupError for another format, if there is no such group, the datasets are those of another one or of other
    parameters than it has now, or hold too little to be drawn; StoreError if its datasets cannot be read.
    """
    function = group_member(group, "draw", "draw")
    from granular_response.plot import style
    from granular_response.plot.animation import rendered

    wanted = tuple(dict.fromkeys(("png", *formats)))
    if unknown := set(wanted) - set(style.FORMATS):
        raise GroupError(f"formats: {', '.join(sorted(unknown))} is unknown, must be among {', '.join(style.FORMATS)}")
    path = data or data_path(group)
    datasets, described = _stored(group, path)
    target = folder or Path("figures") / group
    paths: list[Path] = []
    try:
        with style.context():
            figures = function(datasets)
        panels = {stem: style.drawn_letters(figure) for stem, figure in figures.items()}
        told = group_member(group, "draw", "captions")(datasets, described)
        said = captions.document(told, panels, captions.question(group))
        for stem, figure in figures.items():
            paths += style.save(figure, stem, target, wanted, inputs=[path])
        animations = group_member(group, "draw", "animations", optional=True)  # by the stem of the picture beside each
        for stem, moving in (animations(datasets) if animations else {}).items():
            paths.append(target / f"{stem}.gif")
            atomic.check_writable(paths[-1], [path])
            atomic.write_bytes(paths[-1], rendered(moving))
    except TOO_LITTLE as error:
        problem = " ".join(f"{type(error).__name__}: {error}".split())
        raise GroupError(f"{path}: {group} cannot be drawn with these parameters ({problem})") from error
    beside = target / captions.FILE
    atomic.make_folder(beside)
    atomic.check_writable(beside, [path])
    atomic.write_bytes(beside, (json.dumps(said, ensure_ascii=False, indent=1) + "\n").encode())
    return [*paths, beside]


def _stored(group: str, path: Path) -> tuple[dict[str, xr.Dataset], Any]:
    """The datasets of a group, and the validated parameters that they were made with."""
    found, attributes = store.read(path), store.read_attributes(path)
    stored = attributes.get("group")
    if stored != group:
        what = f"those of {stored}" if stored else "not those of a figure group"
        raise GroupError(f"{path}: holds datasets of another kind, {what}, must be those of {group}")
    kind = group_member(group, "parameters", "Parameters")
    try:
        return found, kind(**text.read(attributes.get("parameters", "{}")))
    except SceneError as error:
        raise GroupError(f"{path}: was made with parameters that {group} does not have now: {error}") from None
