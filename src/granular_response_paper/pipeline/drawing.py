"""From datasets to figures and their captions."""

from __future__ import annotations

import gzip
import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_response.scene import SceneError, text
from granular_response.store import atomic
from granular_response.store import files as store
from granular_response_paper import TOO_LITTLE, captions
from granular_response_paper.pipeline import figures_folder, stored
from granular_response_paper.registry import GroupError, group_member

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Largest SVG in bytes: with more elements than that a browser is slow, and fields of colour show seams.
LARGEST = 300_000

#: Coordinates of an SVG file, and their digits behind the second: a hundredth of a point is not seen.
_COORDINATES, _DIGITS = re.compile(r' (?:d|x|y|points)="[^"]*"'), re.compile(r"(\.\d\d)\d+")


def draw(group: str, data: Path | None = None, folder: Path | None = None) -> list[Path]:
    """Draw the figures of a group from its datasets and write their captions; returns the paths of the files.

    Animations of a group (``animations`` of its ``draw.py``) are GIFs, each beside the picture of its name.
    A figure that is smaller as SVG than as PNG, and below :data:`LARGEST`, is stored as a compressed SVG too.

    Raises GroupError if there is no such group, the datasets are those of another one or of other parameters than it
    has now, or hold too little to be drawn; StoreError if its datasets cannot be read.
    """
    function = group_member(group, "draw", "draw")
    path, datasets = stored.datasets(group, data)
    described = _parameters(group, path)
    from granular_response.plot import style
    from granular_response.plot.animation import rendered

    target = folder or figures_folder(group)
    paths: list[Path] = []
    try:
        figures = function(datasets)
        panels = {stem: style.drawn_letters(figure) for stem, figure in figures.items()}
        said = captions.document(
            group_member(group, "draw", "captions")(datasets, described), panels, captions.question(group)
        )
        for stem, figure in figures.items():
            saved = style.save(figure, stem, target, inputs=[path])
            paths += [*saved, *_vector(figure, saved[0], [path])]
        animations = group_member(group, "draw", "animations", optional=True)  # by the stem of the picture beside each
        for stem, moving in (animations(datasets) if animations else {}).items():
            paths.append(target / f"{stem}.gif")
            atomic.check_writable(paths[-1], [path])
            atomic.write_bytes(paths[-1], rendered(moving))
    except TOO_LITTLE as error:
        problem = " ".join(f"{type(error).__name__}: {error}".split())
        raise GroupError(f"{path}: {group} cannot be drawn with these parameters ({problem})") from error
    beside = target / captions.FILE
    atomic.check_writable(beside, [path])
    atomic.write_bytes(beside, (json.dumps(said, ensure_ascii=False, indent=1) + "\n").encode())
    return [*paths, beside]


def _vector(figure: Figure, png: Path, inputs: list[Path]) -> list[Path]:
    """Write the vector picture beside a raster one, or remove it if it is not the smaller one."""
    from granular_response.plot import style

    drawn = style.render(figure, "svg").decode()
    drawn = _COORDINATES.sub(lambda match: _DIGITS.sub(r"\1", match[0]).replace("\n", " "), drawn)
    drawn = re.sub(r"<metadata>.*</metadata>", "", re.sub(r">\s+<", "><", drawn), flags=re.DOTALL)
    target = png.with_suffix(captions.VECTOR)
    atomic.check_writable(target, inputs)
    if len(drawn) > min(png.stat().st_size, LARGEST):
        target.unlink(missing_ok=True)
        return []
    atomic.write_bytes(target, gzip.compress(drawn.encode(), 9, mtime=0))
    return [target]


def _parameters(group: str, path: Path) -> Any:
    """The validated parameters that the datasets were made with."""
    kind = group_member(group, "parameters", "Parameters")
    try:
        return kind(**text.read(store.read_attributes(path).get("parameters", "{}")))
    except SceneError as error:
        raise GroupError(f"{path}: was made with parameters that {group} does not have now: {error}") from None
