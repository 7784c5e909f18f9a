"""Where the time of a whole solution goes: fall, motion, searches, and kernels and Python at the events between.

`python benchmarks/shares.py OUTPUT.json`. Processor time on one thread, of the fastest of several solutions. Every
compiled function is timed where a module of solvers or of linear algebra calls it, which adds less than a microsecond
to each call. Arrays of numpy and solutions of scipy count as Python.
"""

from __future__ import annotations

import importlib
import pkgutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.dispatcher import Dispatcher
from timing import write

from granular_response import linalg, solvers
from granular_response.scene import Scene
from granular_response.solvers import path, solution
from granular_response.solvers.path import losses

#: Solutions of each scene after the first, which loads kernels; the fastest counts.
REPEATS = 5

#: Parts of a solution, by the functions that each is made of, as modules call them; the innermost one counts.
PARTS: dict[str, tuple[tuple[Any, str], ...]] = {
    "fall": ((solution, "rest_state"),),
    "python": ((solution, "follow"),),
    "motion": ((path, "by_motion"), (losses, "by_motion")),
    "searches": ((path, "beyond"),),
    "stability": ((path, "diverges"), (path, "first_unstable"), (losses, "diverges")),
}


def slab(friction: float, force: float, **sections: dict[str, Any]) -> Scene:
    """The paper's slab with one load on the middle of its top row; ``sections`` besides."""
    contact = {"friction": friction, **sections.pop("contact", {})}
    return Scene.from_dict({"contact": contact, "loads": [{"disk": "top-centre", "force": [0, -force]}], **sections})


def disordered(friction: float, force: float, polydispersity: float, realization: int) -> Scene:
    """The same of disks that differ, as in the paper's ensembles."""
    packing = {
        "kind": "slab", "polydispersity": polydispersity, "lattice_constant": "touching-largest",
        "realization": realization,
    }  # fmt: skip
    protocol = {"integrator": "leapfrog", "time_step": 0.0011, "stop_kinetic_energy": 1e-9}
    return slab(friction, force, packing=packing, contact={"stiffness_ratio": 0.8}, protocol=protocol)


SCENES = {
    "ordered, friction 0.05, 4 mg": slab(0.05, 4.0),
    "ordered, friction 0.2, 15 mg": slab(0.2, 15.0),
    "ordered, friction 1, 50 mg": slab(1.0, 50.0),
    "polydispersity 0.1, friction 0.2, 30 mg, first": disordered(0.2, 30.0, 0.1, 0),
    "polydispersity 0.1, friction 0.2, 30 mg, second": disordered(0.2, 30.0, 0.1, 1),
    "polydispersity 0.1, friction 0.2, 30 mg, third": disordered(0.2, 30.0, 0.1, 2),
    "polydispersity 0.25, friction 0.2, 20 mg": disordered(0.2, 20.0, 0.25, 0),
    "ordered, 3/2 law, friction 0.2, 15 mg": slab(0.2, 15.0, contact={"law": "hertz"}),
    "ordered, rolling resistance, friction 0.2, 10 mg": slab(
        0.2, 10.0, contact={"rolling_friction": 0.1, "rolling_stiffness_ratio": 1.0}
    ),
}


class Parts:
    """Processor time by part; that of an inner part is not the outer one's."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(["set-up", *PARTS, "kernels"], 0.0)
        self._within = ["set-up"]
        self._since = time.process_time()

    def _pass(self) -> None:
        now = time.process_time()
        self.seconds[self._within[-1]] += now - self._since
        self._since = now

    def timed(self, function: Callable[..., Any], part: str) -> Callable[..., Any]:
        """The same function, whose time counts for a ``part``; kernels do so between two events only."""

        def call(*given: Any, **named: Any) -> Any:
            if part == "kernels" and self._within[-1] != "python":
                return function(*given, **named)
            self._pass()
            self._within.append(part)
            try:
                return function(*given, **named)
            finally:
                self._pass()
                self._within.pop()

        return call


@contextmanager
def watched() -> Iterator[Parts]:
    """Time the parts of what is solved within."""
    parts, before = Parts(), []
    places = [(module, name, part) for part, functions in PARTS.items() for module, name in functions]
    for package in (solvers, linalg):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            importlib.import_module(found.name)
    for name, module in list(sys.modules.items()):
        if name.startswith("granular_response."):
            places += [(module, key, "kernels") for key, one in vars(module).items() if isinstance(one, Dispatcher)]
    for module, name, part in places:
        before.append((module, name, getattr(module, name)))
        setattr(module, name, parts.timed(getattr(module, name), part))
    try:
        yield parts
    finally:
        for module, name, function in before:
            setattr(module, name, function)


def measure(what: str, scene: Scene) -> dict[str, Any]:
    """Seconds and events of one scene, and the shares of the parts."""
    solution.solve_scene(scene)
    best: dict[str, float] = {}
    for _ in range(REPEATS):
        with watched() as parts:
            solved = solution.solve_scene(scene)
        if not best or sum(parts.seconds.values()) < sum(best.values()):
            best = parts.seconds
    whole, events = sum(best.values()), sum(len(state.reached.events) for state in solved.loaded)
    row = {"what": what, "seconds": whole, "events": events, "per_event": 1e3 * (whole - best["fall"]) / events}
    return row | {part: one / whole for part, one in best.items()}


def main(output: str) -> None:
    rows = []
    for what, scene in SCENES.items():
        rows.append(measure(what, scene))
        print(rows[-1], flush=True)
    write(output, {"runs": rows})


if __name__ == "__main__":
    main(sys.argv[1])
