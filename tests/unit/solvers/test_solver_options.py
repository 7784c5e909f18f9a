"""The numbers that solvers go by: another value of each is noticed."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from refusals import refuses
from small_scenes import at_rest, pushed, scene

from granular_response.errors import EquilibriumError
from granular_response.solvers import equilibrium, path, rates, system
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.equilibrium import external_force, finish, newton
from granular_response.solvers.path import follow, landing, losses, points
from granular_response.solvers.problem import Problem
from granular_response.solvers.system import StaticSystem
from granular_response.state import State


@pytest.fixture(scope="module")
def loaded() -> tuple[Problem, State]:
    """A packing at rest, with the load that it is to bear."""
    return at_rest(scene(6, 13, contact__friction=0.2, loads=pushed(0.0, -12.0)))


def test_newtons_method_ends_where_its_options_say(monkeypatch):
    problem = Problem.from_scene(scene(contact__friction=0.2, wall__friction=0.2))
    state = relax(Dynamics(problem, problem.bare_state()), Stop(1e-8))  # nearly at rest
    equations, external = StaticSystem(problem, state), external_force(problem, 0.0)
    known = equations.start(state)
    assert newton(equations, known, external)[1].residual < system.OPTIONS.tolerance
    usual = equilibrium.OPTIONS
    refuses(EquilibriumError, "within 0 Newton iterations", finish, problem, state, maximum_iterations=0)
    monkeypatch.setattr(equilibrium, "OPTIONS", replace(usual, farthest=0.0))
    refuses(EquilibriumError, "mean radii away", finish, problem, state)
    monkeypatch.setattr(equilibrium, "OPTIONS", replace(usual, longest_step=1e-12))
    assert not newton(equations, known, external)[1].converged


def test_a_landing_leaves_force_and_a_factorisation_as_its_options_say(loaded, monkeypatch):
    """Coarser events have other loads, by no more than the force that is left; the floor feels nothing of it."""

    def followed(finer: float = 1.0, **options) -> State:
        tolerance = finer * system.OPTIONS.tolerance
        with monkeypatch.context() as changed:
            for module in (points, landing, equilibrium, rates):
                changed.setattr(module, "SYSTEM", replace(system.OPTIONS, tolerance=tolerance))
            changed.setattr(path, "OPTIONS", replace(path.OPTIONS, **options))
            return follow(*loaded, [1.0])[0]

    exact, coarse, renewed = followed(0.01), followed(), followed(outdated=0)
    for other in (coarse, renewed):
        assert [event.kind for event in other.reached.events] == [event.kind for event in exact.reached.events]
        assert np.abs(other.wall_force() - exact.wall_force()).max() < system.OPTIONS.bare
    at = np.array([[e.load_factor for e in state.reached.events] for state in (exact, coarse)])
    assert 0.0 < np.median(np.abs(at[1] - at[0])) < system.OPTIONS.event
    assert renewed.reached.factorisations > 2 * coarse.reached.factorisations


@pytest.mark.parametrize("factor", [0.0321, 0.0407, 0.0513])
def test_a_loss_of_stability_is_found_to_a_millionth_of_a_weight(loaded, factor, monkeypatch):
    """Here equilibria shall be unstable from where the loaded disk has sunk as far as at this load factor."""
    problem, rest = loaded
    disk, unit = int(problem.load_disk[0]), 12.0
    deepest = follow(problem, rest, [factor])[0].position[disk, 1]

    class Lost(Exception):
        pass

    def diverges(point, trial, sense, near=None):
        sunk = point.system.state(trial, 0.0).position[disk, 1] < deepest
        return (np.ones(point.system.dof) if sunk else None), None

    def by_motion(leg, last, *_):
        raise Lost(last.factor)

    monkeypatch.setattr(path, "followed", partial(path.followed, watched=True))
    monkeypatch.setattr(losses, "diverges", diverges)
    monkeypatch.setattr(losses, "by_motion", by_motion)
    with pytest.raises(Lost) as lost:
        follow(problem, rest, [1.0])
    assert 0.0 <= (factor - lost.value.args[0]) * unit < 1e-6


def test_the_next_equilibrium_is_stepped_over_to_if_it_is_a_thousandth_of_a_radius_away(loaded, monkeypatch):
    """Where no statuses go on, by loads that double until it is farther and left to motion."""

    class Moves(Exception):
        pass

    def by_motion(*_):
        raise Moves

    monkeypatch.setattr(rates.RateProblem, "solve", lambda *_: None)
    monkeypatch.setattr(losses, "by_motion", by_motion)
    record = path.PathRecord()
    with pytest.raises(Moves):
        follow(*loaded, [1.0], record=record)
    ways = [event.displacement for event in record.events if event.kind == "stepped over"]
    assert 2.5e-4 < ways[-1] == max(ways) < 1e-3
