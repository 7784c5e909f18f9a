"""The drawn figures, in the order of the paper, as pictures inside a page."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from PIL import Image

from granular_response.inputs import read_json
from granular_response.machine import threads
from granular_response_paper import captions

#: Pixels of the page per pixel of a drawn picture, which has 200 to an inch: letters as large as the text.
SHOWN = 0.62

#: Largest size of a small picture, in its own pixels, and how hard it is compressed, from 0 to 100.
SMALL, SMALL_QUALITY = (192, 128), 55

#: Two figures that are not wider than this, in pixels of the page, stand beside each other.
NARROW = 480


@dataclass(frozen=True)
class Picture:
    """A picture and the module that draws it."""

    stem: str
    group: str
    source: str  #: data URI
    small: str  #: data URI of the picture in small, not as drawn
    width: int
    height: int
    shown: int  #: width on a wide screen in pixels of the page
    caption: str = ""  #: with all its parameters, in plain text
    alternative: str = ""  #: what stands for it where it cannot be seen

    @property
    def files(self) -> tuple[tuple[str, str], ...]:
        """What belongs to it, in words, and the path from the root of the project."""
        folder = f"src/granular_response_paper/groups/{self.group}"
        return (
            ("PDF", f"figures/{self.group}/{self.stem}.pdf"),
            ("GIF", f"figures/{self.group}/{self.stem}.gif"),
            ("data", f"data/{self.group}.nc"),
            ("drawing", f"{folder}/draw.py"),
            ("folder of the group", folder),
        )

    @property
    def number(self) -> int | None:
        """Number of the paper's figure that it belongs to."""
        return captions.number(self.stem)

    @property
    def title(self) -> str:
        return self.stem.replace("_", " ").capitalize()


@dataclass(frozen=True)
class Figure:
    """A figure of the paper with its pictures, none if it is not drawn yet."""

    number: int
    pictures: tuple[Picture, ...]

    @property
    def caption(self) -> str:
        """Those of its pictures, one after the other."""
        return " ".join(picture.caption for picture in self.pictures if picture.caption)

    @property
    def narrow(self) -> bool:
        """Whether another figure has room beside it."""
        return bool(self.pictures) and all(picture.shown <= NARROW for picture in self.pictures)

    def alternative(self, picture: Picture) -> str:
        """Text that stands for one of the pictures, of its own for each."""
        count = len(self.pictures)
        which = f", picture {self.pictures.index(picture) + 1} of {count}" if count > 1 else ""
        subject = picture.stem.partition("_")[2].replace("_", " ")
        return f"Figure {self.number}{which}, {subject}: {picture.alternative}"


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
    """All pictures ``folder/GROUP/STEM.png`` with their captions; one that begins with ``figNN`` is of that figure.

    Raises ValueError if a file of captions is none.
    """
    numbered: dict[int, list[Picture]] = {number: [] for number in range(1, captions.NUMBER_OF_FIGURES + 1)}
    further = []
    said = _said(folder)
    paths = sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name))
    with threads.using(threads.cores()), threads.mapping() as several:  # encoding is most of the time of a page
        embedded = several(embed, paths)
    for plain in embedded:
        caption, alternative = said.get((plain.group, plain.stem), ("", ""))
        picture = replace(plain, caption=caption, alternative=alternative)
        if picture.number is None:
            further.append(picture)
        else:
            numbered[picture.number].append(picture)
    return Pictures(tuple(Figure(n, tuple(found)) for n, found in numbered.items()), tuple(further))


def _said(folder: Path) -> dict[tuple[str, str], tuple[str, str]]:
    """Caption and alternative text of each picture, by group and stem."""
    found = {}
    for path in folder.glob(f"*/{captions.FILE}"):
        try:
            for stem, entry in read_json(path).items():
                found[path.parent.name, stem] = str(entry["caption"]), str(entry["alternative"])
        except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
            raise ValueError(f"{path}: holds no captions: {type(error).__name__} {error}") from None
    return found


def embed(path: Path) -> Picture:
    """A drawn picture as a data URI: every pixel as drawn, in lossless WebP, less than half as large as the PNG.

    Where an animation of its name is beside it, that stands in its place.
    """
    moving = path.with_suffix(".gif")
    with Image.open(path) as image:
        plain = image.convert("RGB")
    small = plain.copy()
    small.thumbnail(SMALL)
    return Picture(
        path.stem,
        path.parent.name,
        _uri("gif", moving.read_bytes()) if moving.exists() else _webp(plain, lossless=True, quality=76),
        _webp(small, quality=SMALL_QUALITY),
        plain.width,
        plain.height,
        round(SHOWN * plain.width),
    )


def _webp(image: Image.Image, **options: bool | int) -> str:
    buffer = io.BytesIO()
    image.save(buffer, format="WEBP", method=4, **options)
    return _uri("webp", buffer.getvalue())


def _uri(kind: str, data: bytes) -> str:
    return f"data:image/{kind};base64," + base64.b64encode(data).decode()
