"""How equilibrium is reached.

``solve_scene`` settles and loads a scene. Below it: ``rest_state`` and ``loaded_states`` for studies that share a
rest state, ``dynamics`` (explicit relaxation), ``minimise`` (no friction),
``equilibrium`` (Newton on the contact law), ``path`` (quasi-static loading), ``choice`` (which of them, and why).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .choice import Choice
    from .dynamics import Dynamics, DynamicsError, Relaxation, Stop, relax
    from .energy import minimise
    from .equilibrium import EquilibriumError, certify, finish
    from .path import PathError, PathRecord, follow
    from .problem import Problem
    from .settle import NotSettled
    from .small_loads import contact_answers, influence
    from .solution import Solution, continue_solution, loaded_states, rest_state, solve_scene
    from .strain import strained
    from .timestep import UnstableTimeStep

# Names are looked up on first use: whoever reads states alone does not load the solvers.
_PLACES = {
    "choice": "Choice",
    "dynamics": "Dynamics DynamicsError Relaxation Stop relax",
    "energy": "minimise",
    "equilibrium": "EquilibriumError certify finish",
    "path": "PathError PathRecord follow",
    "problem": "Problem",
    "settle": "NotSettled",
    "small_loads": "contact_answers influence",
    "solution": "Solution continue_solution loaded_states rest_state solve_scene",
    "strain": "strained",
    "timestep": "UnstableTimeStep",
}
_HOME = {name: module for module, names in _PLACES.items() for name in names.split()}
_ERRORS = ("DynamicsError", "EquilibriumError", "NotSettled", "PathError", "UnstableTimeStep")


def __getattr__(name: str) -> Any:
    if name == "SOLVE_ERRORS":  # everything that can go wrong with a well-formed scene
        return tuple(__getattr__(error) for error in _ERRORS)
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


__all__ = [
    "SOLVE_ERRORS",
    "Choice",
    "Dynamics",
    "DynamicsError",
    "EquilibriumError",
    "NotSettled",
    "PathError",
    "PathRecord",
    "Problem",
    "Relaxation",
    "Solution",
    "Stop",
    "UnstableTimeStep",
    "certify",
    "contact_answers",
    "continue_solution",
    "finish",
    "follow",
    "influence",
    "loaded_states",
    "minimise",
    "relax",
    "rest_state",
    "solve_scene",
    "strained",
]
