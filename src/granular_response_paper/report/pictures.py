"""The drawn pictures as a page shows them, with their captions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from granular_response.inputs import read_json
from granular_response_paper import captions
from granular_response_paper.registry import collection_of, group_path

#: Pixels of the page per pixel of a drawn picture: of 7 inches, with 200 to an inch, it takes 1000 where there is room.
SHOWN = 5 / 7

#: Of 255: a picture that is brighter on average is a plot on white paper, which a dark page shows inverted.
PAPER = 160.0

#: The end of a first sentence, which the next one follows.
_SENTENCE = re.compile(r"(?<!Fig.)(?<!Figs.)(?<!Sec.)(?<!Secs.)(?<!Eq.)(?<!eq.)(?<=[.?!])\s+(?=[A-Z(])")


@dataclass(frozen=True)
class Picture:
    """A picture and the module that draws it."""

    stem: str
    group: str
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


def collect(folder: Path) -> list[Picture]:
    """All pictures ``GROUP/STEM.png`` of a folder with their captions, by stem, as a page in the folder shows them."""
    said = {path.parent.name: read_json(path) for path in folder.glob(f"*/{captions.FILE}")}
    paths = sorted(folder.glob("*/*.png"), key=lambda path: (path.stem, path.parent.name))
    return [_shown(path, said.get(path.parent.name, {}).get(path.stem)) for path in paths]


def _shown(path: Path, said: Mapping[str, Any] | None) -> Picture:
    with Image.open(path) as image:
        width, height = image.size
        plot = float(np.asarray(image.convert("RGB").reduce(8)).mean()) > PAPER
    texts = {}
    if said:
        given = captions.Caption("", "", said["parameters"]).whole.strip()
        texts = {"name": said["title"], "alternative": said["alternative"], "parameters": given}
        texts["caption"] = said["caption"].removesuffix(given).strip()
    return Picture(path.stem, path.parent.name, width, height, round(SHOWN * width), plot, **texts)
