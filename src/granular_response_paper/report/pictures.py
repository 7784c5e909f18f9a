"""The drawn figures as pictures inside a page, by the question that they answer."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageSequence

from granular_response.inputs import read_json
from granular_response.machine import threads
from granular_response_paper import captions

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

#: The questions that the figures answer, and the figure groups of each. What is in none stands behind them.
QUESTIONS: Mapping[str, tuple[str, ...]] = {
    "What do continuum theories predict?": ("theory", "slab_comparison", "moduli"),
    "When does one peak become two?": (
        "frictionless_crossover",
        "stiffness_ratio_crossover",
        "crossover_scaling",
        "peak_width",
    ),
    "What does friction change?": (
        "friction_linear_range",
        "friction_fields",
        "preparation",
        "symmetry_breaking",
        "tangent_moduli",
    ),
    "What does disorder change?": ("polydisperse_averages", "phase_diagram", "explorer", "network", "experiments"),
    "What do piles, torques and several forces do?": (
        "pile_dip",
        "torque",
        "superposition",
        "influence",
        "hysteresis",
        "rolling_resistance",
    ),
    "How certain are the numbers?": ("sensitivity", "numerics", "contact_law", "stability"),
}
FURTHER = "Further figures"

#: The end of a first sentence, which the next one follows.
_SENTENCE = re.compile(r"(?<!Fig.)(?<!Figs.)(?<!Sec.)(?<!Secs.)(?<!Eq.)(?<!eq.)(?<=[.?!])\s+(?=[A-Z(])")


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
    plot: bool  #: whether it is drawn on white paper
    caption: str = ""  #: with all its parameters, in plain text
    alternative: str = ""  #: what stands for it where it cannot be seen

    @property
    def files(self) -> tuple[tuple[str, str], ...]:
        """What belongs to it, in words, and the path from the root of the project."""
        folder = f"src/granular_response_paper/groups/{self.group}"
        return (
            ("PNG", f"figures/{self.group}/{self.stem}.png"),
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
    """All drawn pictures."""

    overview: tuple[Picture, ...]
    questions: Mapping[str, tuple[Picture, ...]]  #: the pictures by question, first those of the paper's figures

    def all(self) -> Iterator[Picture]:
        yield from self.overview
        for found in self.questions.values():
            yield from found

    @property
    def first(self) -> dict[int, str]:
        """The stem of the first picture of each figure of the paper that is drawn."""
        found: dict[int, str] = {}
        for picture in self.all():
            if picture.number:
                found.setdefault(picture.number, picture.stem)
        return dict(sorted(found.items()))


def collect(folder: Path) -> Pictures:
    """All pictures ``folder/GROUP/STEM.png`` with their captions; one that begins with ``figNN`` is of that figure.

    Raises ValueError if a file of captions is none.
    """
    said = _said(folder)
    paths = sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name))
    with threads.using(threads.cores()), threads.mapping() as several:  # encoding is most of the time of a page
        embedded = several(embed, paths)
    shown = [replace(plain, **said.get((plain.group, plain.stem), {})) for plain in embedded]
    shown.sort(key=lambda picture: picture.number or captions.NUMBER_OF_FIGURES + 1)  # the others as they are
    overview = sorted((p for p in shown if p.group == OVERVIEW), key=lambda picture: picture.stem != OVERVIEW)
    known = {group: question for question, groups in QUESTIONS.items() for group in groups}
    by_question = {
        question: tuple(p for p in shown if p.group != OVERVIEW and known.get(p.group, FURTHER) == question)
        for question in (*QUESTIONS, FURTHER)
    }
    return Pictures(tuple(overview), {question: found for question, found in by_question.items() if found})


def _said(folder: Path) -> dict[tuple[str, str], dict[str, Any]]:
    """Caption and alternative text of each picture, by group and stem."""
    found = {}
    for path in folder.glob(f"*/{captions.FILE}"):
        try:
            for stem, entry in read_json(path).items():
                found[path.parent.name, stem] = {name: str(entry[name]) for name in ("caption", "alternative")}
        except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
            raise ValueError(f"{path}: holds no captions: {type(error).__name__} {error}") from None
    return found


def embed(path: Path) -> Picture:
    """A drawn picture as a data URI: as many pixels as drawn in 256 colours, a third as large as the PNG.

    A smooth map is in all colours, with little loss, which is smaller. Where an animation is beside it, that stands in
    its place.
    """
    with Image.open(path) as image:
        plain = image.convert("RGB")
    small = plain.copy()
    small.thumbnail(SMALL)
    moving = path.with_suffix(".gif")
    few = plain.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    still = _webp(few.convert("RGB"), lossless=True, quality=76)
    return Picture(
        path.stem,
        path.parent.name,
        _moving(moving) if moving.exists() else min(still, _webp(plain, quality=MAP_QUALITY), key=len),
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
