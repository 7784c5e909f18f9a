"""Pictures of pages, drawn by the page's own code: ``python docs/pictures_of_pages.py`` draws all anew, or those of the
pages that are named.

An image of a page that lies in ``docs/pictures`` is a figure that the blocks of Python above it have made; several in a
row are its figures in turn. All blocks of a page run in turn and share their names. Files are small: few pixels, few
colours.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import gallery_look
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "pictures"
PARTS = re.compile(r"```python\n(?P<code>.*?)```|!\[[^\]]*\]\((?:docs/)?pictures/(?P<file>[\w-]+\.png)\)", re.DOTALL)
#: Dots per inch, and colours of the palette: legible at 600 to 700 pixels, 40 kB a picture. With fewer colours rare
#: ones turn into others, such as those of a legend.
DPI, COLOURS = 100, 256
#: Two pictures are the same if at most a part of their pixels differ by more than so many of 256 levels.
LEVELS, PART = 64, 0.01


class Drawn(NamedTuple):
    """The images of a page, and what each of its blocks printed."""

    files: list[str]
    printed: list[str]


def page(name: str) -> Path:
    """The Markdown file of a page: ``README`` or one of ``docs``."""
    return ROOT / "README.md" if name == "README" else ROOT / "docs" / f"{name}.md"


def pages() -> list[str]:
    """All pages with such images."""
    return [name for name in ["README", *sorted(path.stem for path in ROOT.glob("docs/*.md"))] if images(name)]


def images(name: str) -> list[str]:
    return [part["file"] for part in PARTS.finditer(page(name).read_text(encoding="utf-8")) if part["file"]]


def drawn(name: str, folder: Path) -> Drawn:
    """Run the blocks of a page in the working directory; its images go to ``folder``.

    Raises RuntimeError, with the page's name, if its code fails, an image stands where nothing was drawn, or a figure
    has no image.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    found = Drawn([], [])
    plt.close("all")
    gallery_look.apply({}, name)
    try:
        for part in PARTS.finditer(page(name).read_text(encoding="utf-8")):
            if part["code"] is not None:
                with contextlib.redirect_stdout(io.StringIO()) as said:
                    exec(compile(part["code"], name, "exec"), names)
                found.printed.append(said.getvalue())
                continue
            if not plt.get_fignums():
                raise ValueError(f"nothing was drawn before {part['file']}")
            save(plt.get_fignums()[0], folder / part["file"])
            found.files.append(part["file"])
        if plt.get_fignums() or len(set(found.files)) < len(found.files):
            raise ValueError("a figure has no image, or an image stands twice")
    except Exception as error:
        raise RuntimeError(f"{name}: {error}") from error
    finally:
        plt.close("all")
    return found


def save(number: int, path: Path) -> None:
    """Store a figure with a palette, and close it."""
    whole = io.BytesIO()
    plt.figure(number).savefig(whole, dpi=DPI, format="png")
    plt.close(number)
    small = Image.open(whole).convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    small.save(path, optimize=True)


def same(one: Path, other: Path) -> bool:
    """Whether two pictures show the same."""
    first, second = (Image.open(path).convert("RGB") for path in (one, other))
    if first.size != second.size:
        return False
    apart = np.abs(np.asarray(first, np.int16) - np.asarray(second, np.int16)).max(axis=2)
    return bool((apart > LEVELS).mean() <= PART)


@contextlib.contextmanager
def scratch() -> Any:
    """A working directory in which a page may write, with the examples beside it."""
    here = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(ROOT / "examples", Path(folder, "examples"))
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(here)


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or pages():
        with scratch():
            for file in drawn(name, FOLDER).files:
                print(f"docs/pictures/{file} {(FOLDER / file).stat().st_size}")


if __name__ == "__main__":
    main()
