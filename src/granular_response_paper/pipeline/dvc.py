"""DVC with a lock that is replaced in one step: ``python -m granular_response_paper.pipeline.dvc repro``.

Around every stage DVC reads ``dvc.lock``, empties it and takes a third of a second to write it. A run that is killed
meanwhile would lose the record of all stages. DVC also reads it in a way that keeps comments, of which a lock has none;
without that each stage costs half a second less, and the text is the same.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from granular_response.store import atomic


@contextmanager
def modified(path: str | os.PathLike[str], fs: Any = None) -> Iterator[dict[str, Any]]:
    """What DVC calls to change a lock: its content, which is written at the end; the file is whole at any moment."""
    from dvc.utils.serialize import dumps_yaml, parse_yaml

    file = Path(path)
    content = parse_yaml(file.read_text(encoding="utf-8"), path) if file.exists() else {}
    yield content
    atomic.write_bytes(file, dumps_yaml(content).encode())


if __name__ == "__main__":
    from dvc import dvcfile
    from dvc.cli import main

    assert callable(dvcfile.modify_yaml), "DVC changes its lock in another way"
    dvcfile.modify_yaml = modified
    sys.exit(main())
