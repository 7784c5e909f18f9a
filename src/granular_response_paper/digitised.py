"""What others published, read off their pictures by hand: drawn in grey below what is simulated.

The folder :data:`FOLDER` of a collection is the place for it, one curve a file; its README has the format. Every file
there is drawn into its picture or refused, before any picture is written.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from granular_response.inputs import read_text, unreadable
from granular_response.plot import style
from granular_response.scene.errors import describe, suggestion
from granular_response.scene.formats.table import FormatError, number, numbers
from granular_response.state import FloatArray

from . import captions
from .registry import GroupError, collection_of

FOLDER, README = Path("figures/digitised"), "README.md"

#: What a file says of its curve, how many of that it must say, and the header of its numbers.
KEYS, REQUIRED = ("source", "error_x", "error_y", "panel", "label"), 3
COLUMNS = ["x", "y"]

#: What the caption of a picture says before the sources.
CAPTION = "Grey points are read off by hand, bars are the errors of that"


@dataclass(frozen=True)
class Curve:
    """A file of the folder: points (n, 2), and the errors of reading them, in the units of the axes."""

    path: Path
    points: FloatArray
    source: str
    errors: tuple[float, float]
    panel: str | None  #: None is the first one
    label: str

    def refused(self, key: str, value: object, rule: str) -> GroupError:
        """What is wrong with the file, in one line."""
        return GroupError(f"{self.path}: {describe((key,), value, rule)}")


def read(path: Path) -> Curve:
    """The curve of a file.

    Raises GroupError, with the key or the line, for what is not of the format; OSError if it cannot be read.

    Examples
    --------
    >>> _ = Path("fig06.csv").write_text("# source: Someone, Fig. 6\\n# error_x: 0.1\\n# error_y: 0\\nx,y\\n1,2\\n")
    >>> read(Path("fig06.csv")).errors
    (0.1, 0.0)
    """
    said: dict[str, str] = {}
    try:
        lines = [(f"line {at}", line.strip()) for at, line in enumerate(read_text(path).splitlines(), start=1)]
        for place, line in ((place, line) for place, line in lines if line.startswith("#")):
            key, _, value = (part.strip() for part in line[1:].partition(":"))
            twice = "is given twice, a second curve needs a file of its own" if key in said else ""
            if rule := twice if key in KEYS and value else f"must be one of {', '.join(KEYS)}, with a value":
                raise FormatError(describe((key,), value, rule), place)
            said[key] = value
        if missing := [key for key in KEYS[:REQUIRED] if key not in said]:
            raise FormatError(f"{missing[0]}: missing, must be given as a line '# {missing[0]}: ...'")
        table = [(place, line) for place, line in lines if line and line[0] != "#"]
        header = table[0][1] if table else ""
        if [cell.strip() for cell in header.split(",")] != COLUMNS or len(table) < 2:
            raise FormatError(describe(("header",), header, "must be x,y, with a line for each point below it"))
        points = np.array([numbers(line.split(","), COLUMNS, place) for place, line in table[1:]])
        errors = number(said["error_x"], "error_x", ""), number(said["error_y"], "error_y", "")
        for key, error in zip(("error_x", "error_y"), errors, strict=True):
            if error < 0.0:
                raise FormatError(describe((key,), error, "must be 0 or greater"))
    except FormatError as wrong:
        raise GroupError(": ".join(filter(None, (str(path), wrong.place, str(wrong))))) from None
    except UnicodeDecodeError as error:
        raise GroupError(f"{path}: {unreadable(error)}") from None
    source = said["source"]
    return Curve(path, points, source, errors, said.get("panel"), said.get("label", source))


def add(figures: Mapping[str, Figure], group: str, folder: Path = FOLDER) -> dict[str, str]:
    """Draw the curves of a folder into those ``figures`` of a group, by stem, that they are of.

    Returns a sentence for the caption of each picture that has got some. Raises GroupError for a file that is not of
    the format, or of no picture of the group's collection, no panel of its picture, or with all points out of view;
    OSError for one that cannot be read.
    """
    found: dict[str, list[str]] = {}
    for stem, path in _named(figures, group, sorted(folder.iterdir()) if folder.is_dir() else ()):
        curve = read(path)
        found.setdefault(stem, []).append(_drawn(curve, figures[stem]) + curve.source)
    return {stem: f"{CAPTION}: {'; '.join(sources)}." for stem, sources in found.items()}


def _named(figures: Mapping[str, Figure], group: str, paths: Iterable[Path]) -> list[tuple[str, Path]]:
    """The files of some figures of a group, with the stem of each."""
    mine = []
    for path in paths:
        stem = path.name.partition(".")[0]
        if path.name == README or not stem:
            continue
        if path.suffix == ".csv" and stem in figures:
            mine.append((stem, path))
            continue
        others = {one for other in collection_of(group).groups if other != group for one in captions.stems(other)}
        if path.suffix != ".csv" or stem not in others:
            rule = "must be PICTURE.csv or PICTURE.ANYTHING.csv, PICTURE as in figures/*/PICTURE.png"
            near = suggestion(path.name, (f"{one}.csv" for one in {*figures, *others}))
            raise GroupError(f"{path}: {describe(('name',), path.name, rule)}{near}")
    return mine


def panels_of(figure: Figure) -> dict[str, Axes]:
    """The panels of a picture by their letters; by numbers where they have none, colour bars and keys left out."""
    lettered = {letter: axes for axes in figure.axes for letter in style.letters_of(axes)}
    plain = [axes for axes in figure.axes if axes.axison and axes.get_label() != "<colorbar>"]
    return dict(sorted(lettered.items())) or {str(k): axes for k, axes in enumerate(plain, start=1)}


def _drawn(curve: Curve, figure: Figure) -> str:
    """Draw a curve; returns the letter of its panel as a caption has it, if panels have letters."""
    panels = panels_of(figure)
    name = curve.panel or next(iter(panels), "1")
    if name not in panels:
        raise curve.refused("panel", name, f"must be one of {', '.join(panels) or 'none, the picture has no axes'}")
    axes = panels[name]
    mapped = any(isinstance(one, QuadMesh) for one in axes.collections)  # which would cover it
    (x, y), (error_x, error_y) = curve.points.T, curve.errors
    look: dict[str, Any] = {
        "color": style.DIGITISED,
        "markersize": 2.0,
        "markeredgewidth": 0.0,
        "zorder": 1.5 if mapped else 0.9,
    }
    bars = axes.errorbar(x, y, error_y, error_x, fmt="o", elinewidth=0.6, **look)
    if not any(axes.viewLim.contains(*point) for point in curve.points):
        view = "one must be in view, x from {:g} to {:g} and y from {:g} to {:g}"
        raise curve.refused("points", curve.points.tolist(), view.format(*axes.get_xlim(), *axes.get_ylim()))
    _name(curve.label, bars, axes, figure)
    return f"({name}) " if name.isalpha() else ""


def _name(label: str, bars: Any, axes: Axes, figure: Figure) -> None:
    """Put a name last into the legend of the panel, else of the picture, else into a new one."""
    there: Any = axes.get_legend() or next(iter(figure.legends), None)
    one: Any
    if there is None:  # on white, the panel may be a map
        one = axes.legend([bars], ["digitised"], frameon=True, facecolor="white", edgecolor="none", framealpha=1.0)
    else:
        one = Legend(axes, [bars], ["digitised"], prop=there.prop, handlelength=there.handlelength)
    one.get_texts()[0].set(text=label, parse_math=False)
    if there is not None:
        # a legend cannot be asked for all that it was made with, so the new row moves into it
        column, row = there._legend_handle_box.get_children()[-1], one._legend_handle_box.get_children()[0]
        column.get_children().extend(row.get_children())
        there.texts.extend(one.texts)
        there.legend_handles.extend(one.legend_handles)
