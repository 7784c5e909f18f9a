"""Error of the floor response against the time that it takes, ours and those of other codes, one core each.

`python -m peers.responses OUTPUT.json [MOST_STEPS]`. The scenes and the quasi-static limit are those of
`precision.py`; ours by statics and by dynamics, the others by runs whose ramps and rests grow, of at most MOST_STEPS
steps. One style stands for each code (`codes.py`). Every time includes the fall under gravity; starting and compiling
it does not. Runs of other codes run once: their processor time tells, where the system tells it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from peers import codes, precision
from timing import least, write

from granular_response import __version__
from granular_response.scene import Scene

#: Ramp time, steps to rest and steps under load of the other codes; `precision.py` has longer ones.
PLANS = [(1.0, 10_000, 6_000), (5.0, 20_000, 20_000), (20.0, 40_000, 45_000)]
TIME_STEP = 5e-4
#: Runs of ours, of which the least time counts.
REPEATS = 3


#: Our own ways to a response, by scene: settings of `precision.solve`.
OURS: dict[str, dict[str, list[dict[str, Any]]]] = {
    "friction": {
        "load path": [{"method": "path"}],
        "dynamics": [{"method": "dynamics", "ramp_time": ramp} for ramp in (1.0, 5.0, 20.0)],
    },
    "frictionless": {
        "minimisation": [{"method": "auto"}],
        "dynamics": [{"method": "dynamics", "ramp_time": ramp} for ramp in (1.0, 20.0)],
    },
}


def responses(there: list[codes.Peer], most: int) -> Iterator[list[dict]]:
    """Time and error of responses, all that are known so far again and again.

    First ours by statics and by dynamics, then the others by runs that grow longer, scene by scene.
    """
    rows: list[dict] = []
    packing = Scene().packing.build()
    disk = int(np.flatnonzero(packing.row == packing.row.max())[30])
    limits = {scene: precision.quasi_static(scene) for scene in precision.SCENES}

    def add(code: str, version: str | None, scene: str, response: np.ndarray, used: dict[str, Any], **more: Any):
        limit, change = limits[scene]
        error = max(float(np.abs(response - limit).max()), change)  # no nearer than the limit is known
        rows.append({"code": code, "version": version, "scene": scene, "error": error, **used, **more})
        print(rows[-1], flush=True)
        return rows

    for scene in limits:
        for name, settings in OURS[scene].items():
            for setting in settings:
                precision.solve(scene, **setting)  # compiles
                response, used = least(lambda: precision.solve(scene, **setting), REPEATS)  # noqa: B023 called at once
                yield add(f"granular_response, {name}", __version__, scene, response, used)
    for ramp, rest, steps in PLANS:
        for scene in limits:
            friction, force = precision.SCENES[scene]
            for peer in there:
                if peer.response is not None and rest + steps <= most:
                    run = peer.response(packing, friction, disk, force, ramp, rest, steps, time_step=TIME_STEP)
                    used = {"seconds": run.seconds, "processor": run.processor}
                    response = (run.floor - run.floor_rest) / force
                    yield add(peer.name, peer.version, scene, response, used, ramp_time=ramp, steps=run.steps)


#: Errors for which the page says the time that reaches them.
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5)


def reached(rows: list[dict]) -> list[dict]:
    """For each scene and code the least time of the runs within each error, and the least error of all."""
    found = []
    for scene, code in dict.fromkeys((row["scene"], row["code"]) for row in rows):
        mine = [row for row in rows if (row["scene"], row["code"]) == (scene, code)]
        key = "processor" if all(row["processor"] is not None for row in rows) else "seconds"
        entry: dict[str, Any] = {"scene": scene, "code": code, "time": key}
        for target in TARGETS:
            entry[f"{target:g}"] = min((row[key] for row in mine if row["error"] <= target), default=None)
        found.append({**entry, "least_error": min(row["error"] for row in mine)})
    return found


def not_run(rows: list[dict], there: list[codes.Peer]) -> list[str]:
    """Runs of the plans that are not among the records."""
    done = {(row["code"], row["scene"], row.get("ramp_time")) for row in rows}
    names = [peer.name for peer in there if peer.response is not None]
    asked = [(name, scene, ramp) for scene in precision.SCENES for ramp, _, _ in PLANS for name in names]
    return [f"{code}, {scene}, ramp {ramp:g}" for code, scene, ramp in asked if (code, scene, ramp) not in done]


def main(path: str, most: int = 10**9) -> None:
    there, skipped = codes.there()
    for rows in responses(there, most):  # after every run: the last ones take long
        write(
            path,
            {
                "time_step": TIME_STEP,
                "skipped": skipped,
                "not_run": not_run(rows, there),
                "runs": rows,
                "reached": reached(rows),
            },
        )


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:3]))
