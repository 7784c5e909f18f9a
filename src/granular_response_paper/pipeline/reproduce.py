"""Runs the pipeline of a collection and says how far it is: stages done, and the time gone.

``dvc repro`` decides what is out of date and runs it. Within a stage its own tasks are shown on a terminal.
"""

from __future__ import annotations

import re
import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

from granular_response.inputs import read_text
from granular_response.scene import text
from granular_response_paper import checkout
from granular_response_paper.pipeline import dvc
from granular_response_paper.registry import Collection

#: What DVC prints where a stage begins, and where it need not run.
_BEGINS = re.compile(r"^Running stage '(?:.*:)?([\w@]+)':")
_SKIPPED = re.compile(r"^Stage '(?:.*:)?([\w@]+)' (?:didn't change, skipping|is cached)")

#: Lines of a stage that are shown if it fails.
_KEPT = 40

#: Drawn before all else where it is out of date: it needs no simulation, so the first picture is there within seconds.
_FIRST = "draw@theory"


def stage_names(collection: Collection, root: Path) -> list[str]:
    """Every stage of a collection, as its pipeline names them."""
    stages = text.read(read_text(root / collection.folder / "dvc.yaml"))["stages"]
    of = {kind: collection.groups if "foreach" in one else () for kind, one in stages.items()}
    return [name for kind, groups in of.items() for name in ([f"{kind}@{one}" for one in groups] or [kind])]


def reproduce(
    collection: Collection,
    root: Path,
    *,
    group: str = "",
    arguments: Sequence[str] = (),
    say: Callable[[str], None] = print,
) -> int:
    """Bring a collection, or the figures of one ``group``, up to date; returns the exit status of DVC.

    ``arguments`` go to ``dvc repro``; ``root`` is the folder of the checkout. Raises CheckoutError where other sources
    would run than those of the checkout.
    """
    checkout.check(collection, root / collection.folder)
    names = [name for name in stage_names(collection, root) if name.partition("@")[2] == group or not group]
    order = [[f"draw@{group}"]] if group else [[_FIRST], []] if _FIRST in names else [[]]
    start, begun, current = time.monotonic(), 0.0, ""
    seen, ran, last = set[str](), set[str](), deque[str](maxlen=_KEPT)

    def ended() -> None:
        nonlocal current
        if current:
            now = time.monotonic()
            seen.add(current)
            ran.add(current)
            say(f"{len(seen):3} of {len(names)}  {current:36} {now - begun:6.1f} s   {_clock(now - start)} gone")
            current = ""

    for targets in order:
        with dvc.running(["repro", *arguments, *targets], root / collection.folder) as run:
            assert run.stdout is not None
            for line in run.stdout:
                last.append(line.rstrip("\n"))
                if match := _BEGINS.match(line):
                    ended()
                    current, begun = match[1], time.monotonic()
                elif match := _SKIPPED.match(line):
                    ended()
                    seen.add(match[1])
        if run.returncode:
            say("\n".join(last))
            return run.returncode
        ended()
    gone = _clock(time.monotonic() - start)
    say(f"{group or collection.title}: {len(ran)} stages run, {len(names) - len(ran)} were up to date, {gone} gone")
    return 0


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"
