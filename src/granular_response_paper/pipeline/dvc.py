"""DVC with a lock that is replaced in one step: ``python -m granular_response_paper.pipeline.dvc repro``.

Around every stage DVC empties ``dvc.lock`` and takes most of a second to write it. A run that is killed meanwhile
would lose the record of all stages.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from typing import Any

from granular_response.store import atomic


def dump(path: str | os.PathLike[str], data: Any, dumper: Callable[..., None], fs: Any = None, **options: Any) -> None:
    """What DVC calls to write a file of YAML: the file is whole at any moment."""
    content = io.StringIO()
    dumper(data, content, **options)
    atomic.write_bytes(path, content.getvalue().encode())


if __name__ == "__main__":
    from dvc.cli import main
    from dvc.utils.serialize import _common

    assert callable(_common._dump_data), "DVC writes its lock in another way"
    _common._dump_data = dump
    sys.exit(main())
