"""The drawn figures, in the order of the paper, as pictures inside a page."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from PIL import Image

from granular_response.paper.groups import NAMES
from granular_response.paper.pipeline import group_member

#: Pixels of the page per pixel of a drawn picture, which has 200 to an inch: letters as large as the text.
SHOWN = 0.62

#: Two figures that are not wider than this, in pixels of the page, stand beside each other.
NARROW = 480

NUMBER_OF_FIGURES = 24


@cache
def captions() -> dict[int | str, str]:
    """What the figures show, by number of the paper's figure or by file; of several groups one after the other."""
    found: dict[int | str, str] = {}
    for group in NAMES:
        for key, text in group_member(group, "captions", "CAPTIONS").items():
            found[key] = f"{found[key]} {text}" if key in found else text
    return found


_NUMBER = re.compile(r"fig(\d+)")


@dataclass(frozen=True)
class Picture:
    """A picture and the module that draws it."""

    stem: str
    group: str
    source: str  #: data URI
    width: int
    height: int
    shown: int  #: width on a wide screen in pixels of the page

    @property
    def module(self) -> str:
        return f"src/granular_response/paper/groups/{self.group}/draw.py"

    @property
    def number(self) -> int | None:
        """Number of the paper's figure that it belongs to."""
        match = _NUMBER.match(self.stem)
        return int(match[1]) if match and int(match[1]) in captions() else None

    @property
    def title(self) -> str:
        return self.stem.replace("_", " ").capitalize()

    @property
    def caption(self) -> str:
        """Of a further figure."""
        return captions().get(self.stem, "")


@dataclass(frozen=True)
class Figure:
    """A figure of the paper with its pictures, none if it is not drawn yet."""

    number: int
    caption: str
    pictures: tuple[Picture, ...]

    @property
    def narrow(self) -> bool:
        """Whether another figure has room beside it."""
        return bool(self.pictures) and all(picture.shown <= NARROW for picture in self.pictures)

    def alternative(self, picture: Picture) -> str:
        """Text that stands for one of the pictures, of its own for each."""
        count = len(self.pictures)
        which = f", picture {self.pictures.index(picture) + 1} of {count}" if count > 1 else ""
        subject = picture.stem.partition("_")[2].replace("_", " ")
        return f"Figure {self.number}{which}, {subject}: {self.caption}"


@dataclass(frozen=True)
class Pictures:
    """The figures of the paper, and what else is drawn."""

    numbered: tuple[Figure, ...]
    further: tuple[Picture, ...]

    def all(self) -> Iterator[Picture]:
        for figure in self.numbered:
            yield from figure.pictures
        yield from self.further


def collect(folder: Path) -> Pictures:
    """All pictures ``folder/GROUP/STEM.png``; a stem that begins with ``figNN`` belongs to that figure."""
    numbered: dict[int, list[Picture]] = {number: [] for number in range(1, NUMBER_OF_FIGURES + 1)}
    further = []
    for path in sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name)):
        picture = embed(path)
        if picture.number is None:
            further.append(picture)
        else:
            numbered[picture.number].append(picture)
    figures = tuple(Figure(n, captions()[n], tuple(found)) for n, found in numbered.items())
    return Pictures(figures, tuple(further))


def embed(path: Path) -> Picture:
    """A drawn picture as a data URI: every pixel as drawn, in lossless WebP, less than half as large as the PNG."""
    with Image.open(path) as image:
        plain = image.convert("RGB")
    buffer = io.BytesIO()
    plain.save(buffer, format="WEBP", lossless=True, quality=60, method=4)
    source = "data:image/webp;base64," + base64.b64encode(buffer.getvalue()).decode()
    return Picture(path.stem, path.parent.name, source, plain.width, plain.height, round(SHOWN * plain.width))
