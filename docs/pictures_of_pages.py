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
from typing import Any

import gallery_look
import matplotlib.pyplot as plt

#: Beside the pages; not in git.
FOLDER = "_drawn"
PARTS = re.compile(r"```python\n(?P<code>.*?)```|<!-- picture: (?P<text>[^>]*) -->", re.DOTALL)


def drawn(page: str, text: str, folder: Path) -> str:
    """``text`` with images in place of its comments; their files are in ``folder``.

    Raises RuntimeError, with the page's name, if its code fails or a comment stands where nothing was drawn.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    count = 0

    def replaced(part: re.Match[str]) -> str:
        nonlocal count
        if part["code"] is not None:
            exec(compile(part["code"], page, "exec"), names)
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
        return PARTS.sub(replaced, text)
    except Exception as error:
        raise RuntimeError(f"{page}: {error}") from error
    finally:
        plt.close("all")


def draw(app: Any, page: str, source: list[str]) -> None:
    """The handler of Sphinx's event ``source-read``. What the code writes and prints is not kept."""
    if "<!-- picture: " not in source[0]:
        return
    folder = Path(app.srcdir) / FOLDER
    folder.mkdir(exist_ok=True)
    here = os.getcwd()
    with tempfile.TemporaryDirectory() as scratch, contextlib.redirect_stdout(io.StringIO()):
        os.chdir(scratch)
        try:
            source[0] = drawn(page, source[0], folder)
        finally:
            os.chdir(here)


def setup(app: Any) -> dict[str, bool]:
    app.connect("source-read", draw)
    return {"parallel_read_safe": False}
