"""The drawn pictures as a page shows them, with their captions."""

from __future__ import annotations

import base64
import io
import os
import re
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from granular_response.inputs import read_json
from granular_response.machine import threads
from granular_response_paper import captions
from granular_response_paper.registry import collection_of, group_path

#: Pixels of the page per pixel of a drawn picture, which has 200 to an inch, and the most of a picture.
SHOWN, WIDEST = 0.62, 680

#: How hard smooth maps are compressed, from 0 to 100.
MAP_QUALITY = 85

#: Of 255: a picture that is brighter on average is a plot on white paper, which a dark page shows inverted.
PAPER = 160.0

#: The end of a first sentence, which the next one follows.
_SENTENCE = re.compile(r"(?<!Fig.)(?<!Figs.)(?<!Sec.)(?<!Secs.)(?<!Eq.)(?<!eq.)(?<=[.?!])\s+(?=[A-Z(])")


@dataclass(frozen=True)
class Picture:
    """A picture and the module that draws it."""

    stem: str
    group: str
    source: str  #: address of the picture, or a data URI with it
    width: int
    height: int
    shown: int  #: width on a wide screen in pixels of the page
    plot: bool  #: whether it is drawn on white paper
    name: str = ""  #: for people
    caption: str = ""  #: in plain text
    parameters: str = ""  #: of what it shows, in plain text
    alternative: str = ""  #: what stands for it where it cannot be seen

    @property
    def files(self) -> tuple[tuple[str, Path], ...]:
        """What belongs to it, in words, and where it is."""
        collection, folder = collection_of(self.group), group_path(self.group)
        base = Path(collection.folder)
        return (
            ("data", base / "data" / f"{self.group}.nc"),
            ("drawing", folder / "draw.py"),
            ("simulation", folder / "simulate" / "__init__.py"),
        )

    @property
    def number(self) -> int | None:
        """Number of the paper's figure that it belongs to."""
        return captions.number(self.stem)

    @property
    def title(self) -> str:
        """Its name, behind the number of the paper's figure that it belongs to."""
        name = self.name or re.sub(r"^fig\w*?_", "", self.stem).replace("_", " ").capitalize()
        return f"Fig. {self.number}. {name}" if self.number else name

    @property
    def message(self) -> str:
        """First sentence of the caption."""
        return _SENTENCE.split(self.caption, 1)[0]

    @property
    def details(self) -> str:
        """What follows it."""
        return "".join(_SENTENCE.split(self.caption, 1)[1:])

    @property
    def text(self) -> str:
        """What stands for it where it cannot be seen, with its title."""
        return f"{self.title}. {self.alternative}".strip()


def collect(folder: Path, page: Path, *, embedded: bool = False) -> list[Picture]:
    """All pictures ``folder/GROUP/STEM.png`` with their captions, by stem.

    The page in the folder ``page`` shows the files, or holds them if they are ``embedded``. Raises ValueError if a file
    of captions is none.
    """
    said = _said(folder)
    paths = sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name))
    with threads.using(threads.cores()), threads.mapping() as several:
        found = several(partial(shown, page=page, embedded=embedded), paths)
    return [replace(plain, **said.get((plain.group, plain.stem), {})) for plain in found]


def _said(folder: Path) -> dict[tuple[str, str], dict[str, str]]:
    """The texts of each picture, by group and stem."""
    found = {}
    for path in folder.glob(f"*/{captions.FILE}"):
        try:
            for stem, entry in read_json(path).items():
                given = captions.Caption("", "", entry.get("parameters", {})).whole.strip()
                texts = {"name": entry.get("title", ""), "alternative": entry["alternative"], "parameters": given}
                found[path.parent.name, stem] = texts | {"caption": entry["caption"].removesuffix(given).strip()}
        except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
            raise ValueError(f"{path}: holds no captions: {type(error).__name__} {error}") from None
    return found


def shown(path: Path, page: Path, *, embedded: bool = False) -> Picture:
    """A drawn picture as the page in a folder shows it.

    Embedded it has as many pixels as drawn in 256 colours, a third as large as the PNG; a smooth map is in all colours,
    with little loss, which is smaller.
    """
    with Image.open(path) as image:
        plain = image.convert("RGB")
    source = Path(os.path.relpath(path, page)).as_posix()
    if embedded:
        few = plain.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).convert("RGB")
        source = min(_webp(few, lossless=True, quality=76), _webp(plain, quality=MAP_QUALITY), key=len)
    return Picture(
        path.stem,
        path.parent.name,
        source,
        plain.width,
        plain.height,
        min(round(SHOWN * plain.width), WIDEST),
        bool(np.asarray(plain.reduce(8)).mean() > PAPER),
    )


def address(image: bytes, name: str, embedded: bool) -> tuple[str, int, int]:
    """Of a PNG that stands beside the page under a name, or in it if ``embedded``, with its width and height."""
    with Image.open(io.BytesIO(image)) as picture:
        return (_webp(picture, lossless=True, quality=76) if embedded else name), picture.width, picture.height


def _webp(image: Image.Image, **options: Any) -> str:
    buffer = io.BytesIO()
    image.save(buffer, format="WEBP", method=4, **options)
    return "data:image/webp;base64," + base64.b64encode(buffer.getvalue()).decode()
