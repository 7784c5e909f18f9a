"""Energy that a disk keeps in a bounce off a wall with friction, ours and other codes (`bounce.py`).

`python -m peers.bounces OUTPUT.json`. Codes that are not installed are named as skipped (`codes.py`).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from peers import bounce, codes
from timing import write

from granular_response import __version__

#: Difference from the closed form of a disk that slides below which ours has slid all the time.
SLID = 1e-4


def table(others: dict[str, tuple[str | None, Callable[..., bounce.After]]]) -> list[dict[str, Any]]:
    """One record for each code, dashpot and angle; ours first."""
    rows = []
    for damping in bounce.DAMPING:
        for code, (version, bounced) in {"granular_response": (__version__, bounce.our_bounce), **others}.items():
            after = bounced(damping)
            kept, slides = bounce.energy(after), bounce.sliding(after)
            # moment of inertia that the code gave the disk: impulse along the wall over spin
            change = after.velocity[:, 0] - bounce.incoming()[:, 0]
            for k, angle in enumerate(bounce.ANGLES):
                rows.append(
                    {
                        "code": code,
                        "version": version,
                        "damping_ratio": damping,
                        "angle": float(angle),
                        "energy_kept": float(kept[k]),
                        "if_it_slid": float(slides[k]),
                        "normal_restitution": float(-after.velocity[k, 1] / bounce.incoming()[k, 1]),
                        "inertia": float(change[k] / after.spin[k]) if after.spin[k] else None,
                    }
                )
            print(code, damping, np.round(kept, 4), flush=True)
    return rows


def compared(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """For each code what its bounces keep beside ours, and beside a disk that slides where ours does.

    The closed form is that of the weaker dashpots: it leaves out that they pull at the end of a contact.
    """

    def of(code: str, damping: float) -> dict[float, dict[str, Any]]:
        return {row["angle"]: row for row in rows if (row["code"], row["damping_ratio"]) == (code, damping)}

    weak, strong = bounce.DAMPING
    found = []
    for code, version in dict.fromkeys((row["code"], row["version"]) for row in rows):
        entry: dict[str, Any] = {"code": code, "version": version}
        for damping, name in ((weak, "weak"), (strong, "strong")):
            ours, theirs = of("granular_response", damping), of(code, damping)
            entry[f"from_ours_{name}"] = max(abs(theirs[a]["energy_kept"] - ours[a]["energy_kept"]) for a in ours)
        slid = [a for a, row in of("granular_response", weak).items() if slides(row)]
        excess = {a: row["energy_kept"] - row["if_it_slid"] for a, row in of(code, weak).items() if a in slid}
        worst = max(excess, key=lambda a: abs(excess[a]))
        found.append({**entry, "excess": excess[worst], "at_angle": worst})
    return found


def slides(row: dict[str, Any]) -> bool:
    """Whether a bounce kept what the closed form says."""
    return abs(row["energy_kept"] - row["if_it_slid"]) < SLID


def main(path: str) -> None:
    there, skipped = codes.there()
    rows = table({peer.name: (peer.version, peer.bounce) for peer in there})
    write(path, {"friction": bounce.FRICTION, "skipped": skipped, "runs": rows, "compared": compared(rows)})


if __name__ == "__main__":
    main(sys.argv[1])
