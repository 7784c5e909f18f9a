"""The drawn figures as a page shows them: those of the paper by number, the others by the question that they answer."""

from __future__ import annotations

import base64
import io
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageSequence

from granular_response.inputs import read_json
from granular_response.machine import threads
from granular_response_paper import captions
from granular_response_paper.registry import collection_of, group_path

#: Pixels of the page per pixel of a drawn picture, which has 200 to an inch: letters as large as the text.
SHOWN = 0.62

#: Largest size of a small picture, in its own pixels, and how hard it is compressed, from 0 to 100.
SMALL, SMALL_QUALITY = (256, 144), 45

#: How hard smooth maps are compressed, from 0 to 100.
MAP_QUALITY = 85

#: Of 255: a picture that is brighter on average is a plot on white paper, which a dark page shows inverted.
PAPER = 160.0

#: The pictures of this group stand in the summary, the one of its name first.
OVERVIEW = "overview"

#: The end of a first sentence, which the next one follows.
_SENTENCE = re.compile(r"(?<!Fig.)(?<!Figs.)(?<!Sec.)(?<!Secs.)(?<!Eq.)(?<!eq.)(?<=[.?!])\s+(?=[A-Z(])")


@dataclass(frozen=True)
class Picture:
    """A picture and the module that draws it."""

    stem: str
    group: str
    source: str  #: address of the picture, or a data URI with it
    small: str  #: data URI of the picture in small
    width: int
    height: int
    shown: int  #: width on a wide screen in pixels of the page
    plot: bool  #: whether it is drawn on white paper
    caption: str = ""  #: with all its parameters, in plain text
    alternative: str = ""  #: what stands for it where it cannot be seen
    question: str = ""  #: that it answers

    @property
    def files(self) -> tuple[tuple[str, Path], ...]:
        """What belongs to it, in words, and where it is."""
        collection, folder = collection_of(self.group), group_path(self.group)
        base = Path(collection.folder)
        return (
            ("picture", base / "figures" / self.group / f"{self.stem}.png"),
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
        """Of a figure of the paper its number, with what follows it in the name of the file where that is a letter."""
        match = re.match(r"fig0*(\d+)([a-z]?)_", self.stem)
        return f"Fig. {match[1]}{match[2]}" if match else self.stem.replace("_", " ").capitalize()

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
        """What stands for it where it cannot be seen, with its name."""
        name = f"{self.title}, {self.stem.partition('_')[2].replace('_', ' ')}" if self.number else self.title
        return f"{name}: {self.alternative}" if self.alternative else name


@dataclass(frozen=True)
class Pictures:
    """All drawn pictures of a collection."""

    overview: tuple[Picture, ...]
    figures: tuple[Picture, ...]  #: of the paper's figures, by number
    questions: Mapping[str, tuple[Picture, ...]]  #: the others, by question

    def all(self) -> Iterator[Picture]:
        yield from (*self.overview, *self.figures)
        for found in self.questions.values():
            yield from found

    @property
    def first(self) -> dict[int, str]:
        """The stem of the first picture of each figure of the paper that is drawn."""
        found: dict[int, str] = {}
        for picture in self.figures:
            found.setdefault(picture.number or 0, picture.stem)
        return found


def collect(folder: Path, page: Path, *, embedded: bool = False) -> Pictures:
    """All pictures ``folder/GROUP/STEM.png`` with their captions; one that begins with ``figNN`` is of that figure.

    The page in the folder ``page`` shows the files, or holds them if they are ``embedded``. Raises ValueError if a file
    of captions is none.
    """
    said = _said(folder)
    paths = sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name))
    with (
        threads.using(threads.cores()),
        threads.mapping() as several,
    ):  # making them small is most of the time of a page
        found = several(partial(shown, page=page, embedded=embedded), paths)
    every = [replace(plain, **said.get((plain.group, plain.stem), {})) for plain in found]
    overview = sorted((p for p in every if p.group == OVERVIEW), key=lambda picture: picture.stem != OVERVIEW)
    figures = sorted((p for p in every if p.number), key=lambda picture: (picture.number or 0, picture.stem))
    others = [p for p in every if p.group != OVERVIEW and not p.number]
    asked = dict.fromkeys(picture.question for picture in others)
    by_question = {question: tuple(p for p in others if p.question == question) for question in asked}
    return Pictures(tuple(overview), tuple(figures), by_question)


def _said(folder: Path) -> dict[tuple[str, str], dict[str, Any]]:
    """Caption, alternative text and question of each picture, by group and stem."""
    found = {}
    for path in folder.glob(f"*/{captions.FILE}"):
        try:
            for stem, entry in read_json(path).items():
                texts = {name: str(entry[name]) for name in ("caption", "alternative", "question")}
                found[path.parent.name, stem] = texts
        except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
            raise ValueError(f"{path}: holds no captions: {type(error).__name__} {error}") from None
    return found


def shown(path: Path, page: Path, *, embedded: bool = False) -> Picture:
    """A drawn picture as the page in a folder shows it; an animation beside it stands in its place.

    Embedded it has as many pixels as drawn in 256 colours, a third as large as the PNG; a smooth map is in all colours,
    with little loss, which is smaller.
    """
    with Image.open(path) as image:
        plain = image.convert("RGB")
    small = plain.copy()
    small.thumbnail(SMALL)
    moving = path.with_suffix(".gif")
    source = Path(os.path.relpath(moving if moving.exists() else path, page)).as_posix()
    if embedded:
        few = plain.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).convert("RGB")
        still = (_webp(few, lossless=True, quality=76), _webp(plain, quality=MAP_QUALITY))
        source = _moving(moving) if moving.exists() else min(still, key=len)
    return Picture(
        path.stem,
        path.parent.name,
        source,
        _webp(small, quality=SMALL_QUALITY),
        plain.width,
        plain.height,
        round(SHOWN * plain.width),
        bool(np.asarray(small).mean() > PAPER),
    )


def _moving(path: Path) -> str:
    """A GIF as an animated WebP with the same frames: a third as large."""
    with Image.open(path) as image:
        frames = [(frame.convert("RGB"), frame.info["duration"]) for frame in ImageSequence.Iterator(image)]
    (first, *others), durations = zip(*frames, strict=True)
    return _webp(first, lossless=True, quality=76, save_all=True, append_images=others, duration=durations, loop=0)


def _webp(image: Image.Image, **options: Any) -> str:
    buffer = io.BytesIO()
    image.save(buffer, format="WEBP", method=4, **options)
    return "data:image/webp;base64," + base64.b64encode(buffer.getvalue()).decode()
