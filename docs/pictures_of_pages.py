"""Pictures of pages, drawn by the page's own code when the site is built.

A page with the comment ``<!-- picture: TEXT -->`` after a block of Python gets there the figures that its blocks have
made since the last such comment, with the text for those who cannot see them. All blocks of a page run in turn and
share their names. In a plain Markdown viewer the page is the same without pictures.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import gallery_look
import matplotlib.pyplot as plt

#: Beside the pages; not in git.
FOLDER = "_drawn"
PARTS = re.compile(r"```python\n(?P<code>.*?)```|<!-- picture: (?P<text>[^>]*) -->", re.DOTALL)


class Drawn(NamedTuple):
    """A page with images in place of its comments, and what each of its blocks printed."""

    text: str
    printed: list[str]


def drawn(page: str, text: str, folder: Path) -> Drawn:
    """Run the blocks of a page; the files of its images go to ``folder``.

    Raises RuntimeError, with the page's name, if its code fails or a comment stands where nothing was drawn.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    printed: list[str] = []
    count = 0

    def replaced(part: re.Match[str]) -> str:
        nonlocal count
        if part["code"] is not None:
            with contextlib.redirect_stdout(io.StringIO()) as said:
                exec(compile(part["code"], page, "exec"), names)
            printed.append(said.getvalue())
            return part[0]
        lines = []
        for number in plt.get_fignums():
            count += 1
            file = f"{page}-{count}.png"
            plt.figure(number).savefig(folder / file, dpi=150)
            lines.append(f"```{{image}} {FOLDER}/{file}\n:alt: {part['text']}\n:width: 90%\n```")
        plt.close("all")
        if not lines:
            raise ValueError(f"nothing was drawn before the comment {part['text']!r}")
        return "\n\n".join(lines)

    plt.close("all")
    gallery_look.apply({}, page)
    try:
        return Drawn(PARTS.sub(replaced, text), printed)
    except Exception as error:
        raise RuntimeError(f"{page}: {error}") from error
    finally:
        plt.close("all")


def draw(app: Any, page: str, source: list[str]) -> None:
    """The handler of Sphinx's event ``source-read``. Files that the code writes are not kept."""
    if "<!-- picture: " not in source[0]:
        return
    folder = Path(app.srcdir) / FOLDER
    folder.mkdir(exist_ok=True)
    here = os.getcwd()
    with tempfile.TemporaryDirectory() as scratch:
        os.symlink(folder.parents[1] / "examples", Path(scratch, "examples"))
        os.chdir(scratch)
        try:
            source[0] = drawn(page, source[0], folder).text
        finally:
            os.chdir(here)


def setup(app: Any) -> dict[str, bool]:
    app.connect("source-read", draw)
    return {"parallel_read_safe": False}
