"""What documents say that code prints, and what a command shows of a result."""

import io
import re
from pathlib import Path

from rich.console import Console

from granular_response.store.summary import summarise


def rounded(text: str) -> str:
    """Without the digits of rounding errors."""
    return re.sub(r"\d\.\de-\d\d", "#", text)


def shown(path: Path) -> str:
    """What ``granular-response show`` prints."""
    console = Console(width=200, file=io.StringIO())
    for part in summarise(path):
        console.print(part)
    return console.file.getvalue()
