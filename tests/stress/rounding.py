"""Rest states disturbed in their last digits: does the static response change?

A rest state is displaced by about 1e-12 of a radius, brought back to equilibrium, and loaded as the undisturbed one
was. Where a packing has one equilibrium nearby the response changes by rounding; where two branches meet, or a chain
of small events decides, it changes by more, and then digits beyond that change mean nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from granular_response.observe.floor import floor_disks, floor_force
from granular_response.scene import Scene
from granular_response.solvers.energy import minimise
from granular_response.solvers.equilibrium import finish
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states, rest_state
from granular_response.studies import lost
from granular_response_paper.records import column, record


@record
class Disturbed:
    """What a displacement of the rest state changes."""

    rest_change: float = column(
        "largest displacement left after the disturbed rest state is back in equilibrium, in mean radii"
    )
    response_change: float = column("largest change of the floor response by the disturbance, per its largest value")
    excess_coordination: float = column("contacts per bearing disk beyond the isostatic number")
    loose_disks: int = column("disks with fewer than two contacts")
    negative_modes: int | None = column("negative modes of the rest state")
    lost: int = column("equilibria that the path has lost")


def disturb(scene: Scene, size: float, seeds: Sequence[int]) -> list[Disturbed]:
    """Solve a scene with one load as it is and, for each seed, from a rest state displaced by ``size`` (mean radii)."""
    problem = Problem.from_scene(scene)
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    count = rest.contact_count()
    bearing = count >= 2
    # a contact has one force without friction and two with it; each disk has two equations or three
    contacts = rest.pairs.touching.sum() + rest.walls.touching.sum() - count[~bearing].sum()
    needed = 1.5 if problem.rotations else 2.0
    certificate = rest.certificate
    (loaded,) = loaded_states(problem, rest, [1.0])[1]
    disks = floor_disks([rest, loaded])
    response = floor_force(loaded, disks) - floor_force(rest, disks)
    found = []
    for seed in seeds:
        generator = np.random.default_rng(seed)
        moved = replace(rest, position=rest.position + size * generator.uniform(-1.0, 1.0, rest.position.shape))
        settle = finish if problem.rotations else minimise
        again = settle(problem, problem.with_static_forces(moved))
        (other,) = loaded_states(problem, again, [1.0])[1]
        changed = floor_force(other, disks) - floor_force(again, disks)
        found.append(
            Disturbed(
                rest_change=float(np.abs(again.position - rest.position).max()),
                response_change=float(np.abs(changed - response).max() / np.abs(response).max()),
                excess_coordination=float(contacts / bearing.sum() - needed),
                loose_disks=certificate.loose_disks,
                negative_modes=certificate.negative_modes,
                lost=len(lost([loaded])),
            )
        )
    return found
