"""Small problems for tests of the solvers."""

from dataclasses import replace

import numpy as np

from granular_response.scene import Packing, Scene
from granular_response.solvers.equations import Configuration
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.solvers.system import StaticSystem
from granular_response.state import State


def scene(layers=4, disks_per_row=7, **changes) -> Scene:
    """A small slab; ``changes`` as in ``Scene.updated`` with ``__`` for the dot."""
    base = Scene.from_dict({"packing": {"kind": "slab", "layers": layers, "disks_per_row": disks_per_row}})
    return base.updated({key.replace("__", "."): value for key, value in changes.items()})


def pushed(x: float, z: float, torque: float = 0.0) -> list[dict]:
    """The loads of a scene that is pushed on the disk in the middle of its top row."""
    return [{"disk": "top-centre", "force": [x, z], "torque": torque}]


def free_disks(
    position, radius=None, *, width=1000.0, velocity=None, spin=None, described=None, **changes
) -> tuple[Problem, State]:
    """Disks at given places far from side walls (unless ``width`` is small), with given motion.

    Laws, loads and protocol are those of ``described`` or of the small slab, with ``changes`` as in :func:`scene`.
    """
    position = np.array(position, float)
    n = len(position)
    radius = np.ones(n) if radius is None else np.array(radius, float)
    packing = Packing(position, radius, np.full(n, -1, np.int32), width)
    problem = Problem.from_scene(scene(**changes) if described is None else described, packing)
    state = problem.bare_state()
    if velocity is not None:
        state = replace(state, velocity=np.array(velocity, float))
    if spin is not None:
        state = replace(state, angular_velocity=np.array(spin, float))
    return problem, state


def at_rest(described: Scene) -> tuple[Problem, State]:
    """The problem of a scene with its loads on their disks, and its rest state."""
    problem = Problem.from_scene(described)
    rest = rest_state(problem)
    return problem.with_loads(rest.position), rest


def started(problem: Problem, state: State) -> tuple[StaticSystem, Configuration]:
    """The static equations of a state, and what is known of it where they start."""
    system = StaticSystem(problem, state)
    return system, system.start(state)


def shaken(problem: Problem, seed=0, *, size=2e-3, spring=2e-4) -> State:
    """The bare packing pressed together a little, shaken, and with random springs in closed contacts."""
    rng = np.random.default_rng(seed)
    bare = problem.bare_state()
    position = bare.position * (1.0 - 2e-3) + rng.normal(0, size, bare.position.shape)
    state = replace(
        bare,
        position=position,
        angle=rng.normal(0, 1e-2, problem.n),
        pairs=replace(bare.pairs, spring=rng.normal(0, spring, len(bare.pairs.first))),
        walls=replace(bare.walls, spring=rng.normal(0, spring, len(bare.walls.first))),
    )
    return problem.with_static_forces(state)
