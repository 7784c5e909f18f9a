"""One or two disks whose motion is known in closed form, and bounds that no contact may break.

Everything is free of gravity unless it says so, in reduced units: mass 1, radius 1, moment of inertia 1/2.
"""

from __future__ import annotations

import numpy as np
from small_scenes import free_disks

from granular_response.kernels.statics import elastic_energy
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import stability_limit
from granular_response.state import FloatArray
from stress import time_steps

#: Where it happens, far from side walls.
FAR = 500.0
#: No collision takes longer, its short flight included; time steps between two looks at whether it is over.
LONGEST_COLLISION, LOOK_EVERY = 4.0, 20


def mechanical_energy(dynamics: Dynamics, gravity: float = 1.0) -> float:
    """Kinetic energy, elastic energy of normal and tangential springs, and that of the weight."""
    problem, state = dynamics.problem, dynamics.state()
    total = dynamics.kinetic_energy() * problem.n + gravity * float(problem.weight @ state.position[:, 1])
    for contacts, (law, *_), shape in problem.kinds(state):
        total += elastic_energy(contacts.overlap, shape, law)
        total += 0.5 * law.tangential_stiffness * float((contacts.spring[contacts.touching] ** 2).sum())
    return total


def collision(scene: Scene, angle: float, spin: float, step: float, *, pair: bool) -> float:
    """Kinetic energy after over that before a disk of speed 1 hits the floor, or another disk that is at rest.

    ``angle`` in degrees from grazing (0) to head-on (90); ``spin`` is the hitting disk's. Springs are not counted:
    when the contact has opened they are gone.
    """
    a = np.radians(angle)
    gap = min(0.01, 0.1 * np.sin(a) ** 2)  # a grazing disk starts so near that it touches before it has passed
    flight = (np.cos(a), -np.sin(a))
    if pair:
        position, velocity, spins = [(FAR, 4.0 + gap), (FAR, 2.0)], [flight, (0.0, 0.0)], [spin, 0.0]
    else:
        position, velocity, spins = [(FAR, 1.0 + gap)], [flight], [spin]
    problem, state = free_disks(position, velocity=velocity, spin=spins, described=scene)
    dynamics = Dynamics(problem, state, scene.protocol.integrator, step)
    dynamics.set_ramps(gravity=(0.0, 0.0, 0.0))
    before = dynamics.kinetic_energy()
    touched = False
    for _ in range(int(LONGEST_COLLISION / step) // LOOK_EVERY):
        dynamics.advance(LOOK_EVERY)
        touching = bool(dynamics.touching().any())
        if touched and not touching:
            return dynamics.kinetic_energy() / before
        touched = touched or touching
    return float("nan")


def drift(scene: Scene, system: str, integrator: str, part: float, time: float, kick: float, seed: int) -> FloatArray:
    """Change (101,) of the total energy of an undamped system, per energy that it moves with.

    The system is a disk that bounces on the floor, or a slab at rest that is kicked.
    The kick is strong enough for contacts to open and slide. Springs are ahead of positions by half a time step, so
    in a feeble motion about large forces the total energy cannot be read off.
    """
    undamped = scene.updated({"contact.damping_ratio": 0.0, "wall.damping_ratio": 0.0})
    if system == "bouncing disk":
        problem, state = free_disks([(FAR, 1.5)], described=undamped)
    else:
        problem, state, _ = time_steps.prepared(Problem.from_scene(undamped))
        state = time_steps.kick(problem, state, seed, kick)
    step = part * stability_limit(problem, "verlet")
    dynamics = Dynamics(problem, state, integrator, step)
    dynamics.set_ramps()
    moving = 0.5 if system == "bouncing disk" else dynamics.kinetic_energy() * problem.n
    energy = [mechanical_energy(dynamics)]
    for _ in range(100):
        dynamics.advance(max(1, round(0.01 * time / step)))
        energy.append(mechanical_energy(dynamics))
    return (np.array(energy) - energy[0]) / moving
