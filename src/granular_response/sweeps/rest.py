"""Rest states that studies share: a packing of one material is settled once in the whole pipeline.

A rest state depends on the packing, the contact laws, the preparation and the numerics that settle it, not on the
loads that follow. ``rest_state`` keeps each one under a name made from just these, in the folder that
``FOLDER_VARIABLE`` names (the pipeline does; without it nothing is kept). States are exact copies, so a study
gives the same bytes whether it finds a state or computes it. States of other sources of the solvers are removed.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import re
import shutil
from functools import cache
from importlib import metadata
from pathlib import Path

from granular_response.solve import Problem
from granular_response.solve import solution as solvers
from granular_response.solve.choice import rest_method, stop_energy
from granular_response.solve.timestep import resolve_time_step
from granular_response.state import State
from granular_response.store import atomic
from granular_response.sweeps.tasks import digest

#: Names the folder of kept rest states.
FOLDER_VARIABLE = "GRANULAR_RESPONSE_REST_STATES"


_SHELF = re.compile("[0-9a-f]{32}")


def rest_state(problem: Problem) -> State:
    """The certified state at rest under gravity, kept or computed; see ``solve.rest_state``.

    Raises what that raises. A kept state that cannot be read counts as none.
    """
    folder = os.environ.get(FOLDER_VARIABLE)
    if not folder:
        return solvers.rest_state(problem)
    path = _shelf(Path(folder)) / f"{name(problem)}.pickle"
    try:
        return _unsealed(path.read_bytes())
    except (OSError, ValueError):
        state = solvers.rest_state(problem)
    body = pickle.dumps(state, protocol=5)
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_bytes(path, hashlib.sha256(body).digest() + body)
    return state


def name(problem: Problem) -> str:
    """Equal for problems with the same rest state."""
    packing, protocol = problem.packing, problem.scene.protocol
    method = rest_method(problem).method
    numerics: tuple = ()
    if method == "dynamics":  # only then must the time step be a stable one
        numerics = (
            protocol.integrator,
            resolve_time_step(problem),
            stop_energy(problem),
            protocol.stop_rule,
            protocol.maximum_steps,
            protocol.static_finish,
        )
    return digest(
        packing,
        problem.pair_law,
        problem.wall_law,
        problem.rule,
        problem.scene.preparation,
        method,
        numerics,
    )


def _shelf(folder: Path) -> Path:
    """The folder of states of these sources; those of other sources go."""
    shelf = folder / _sources()
    if folder.is_dir() and not shelf.is_dir():
        for old in folder.iterdir():
            # another process may have made the shelf by now; what was not made here is not touched
            if old != shelf and _SHELF.fullmatch(old.name) and all(file.suffix == ".pickle" for file in old.glob("*")):
                shutil.rmtree(old, ignore_errors=True)
    return shelf


@cache
def _sources() -> str:
    """Changes with the code that settles a packing."""
    home = Path(solvers.__file__).parent.parent
    parts = ("contact", "kernels", "machine", "scene", "solve", "state")
    files = sorted(path for part in parts for path in (home / part).rglob("*.py"))
    versions = [metadata.version(package) for package in ("numba", "numpy", "scipy")]
    return digest({path.relative_to(home).as_posix(): path.read_bytes() for path in files}, versions)


def _unsealed(data: bytes) -> State:
    body = data[32:]
    if hashlib.sha256(body).digest() != data[:32]:
        raise ValueError("damaged")
    return pickle.loads(body)
