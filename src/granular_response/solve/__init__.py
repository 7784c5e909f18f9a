"""How equilibrium is reached.

``solve_scene`` settles and loads a scene. Below it: ``rest_state`` and ``loaded_states`` for studies that share a
rest state, ``dynamics`` (explicit relaxation), ``minimise`` (no friction), ``equilibrium`` (Newton on the contact
law), ``path`` (quasi-static loading), ``choice`` (which of them, and why).
"""

from .choice import Choice
from .dynamics import Dynamics, DynamicsError, Stop, relax
from .equilibrium import Certificate, EquilibriumError, certify, finish
from .minimise import minimise
from .path import PathError, PathRecord, follow
from .problem import Problem
from .solution import NotSettled, Solution, loaded_states, rest_state, solve_scene
from .state import State
from .timestep import UnstableTimeStep

#: Everything that can go wrong with a well-formed scene.
SOLVE_ERRORS = (DynamicsError, EquilibriumError, NotSettled, PathError, UnstableTimeStep)

__all__ = [
    "SOLVE_ERRORS",
    "Certificate",
    "Choice",
    "Dynamics",
    "DynamicsError",
    "EquilibriumError",
    "NotSettled",
    "PathError",
    "PathRecord",
    "Problem",
    "Solution",
    "State",
    "Stop",
    "UnstableTimeStep",
    "certify",
    "finish",
    "follow",
    "loaded_states",
    "minimise",
    "relax",
    "rest_state",
    "solve_scene",
]
