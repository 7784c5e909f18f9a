"""How an equilibrium goes on: closed forms of one disk, and rates of random packings without contradictions."""

import numpy as np
import pytest
from small_scenes import free_disks, scene, shaken, started

from granular_response.kernels import transitions
from granular_response.solvers.equilibrium import finish
from granular_response.solvers.path import PathError, PathRecord, follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.rates import RateProblem
from granular_response.state import OPEN, SLIDING, STICKING


def test_a_disk_on_a_floor_sticks_and_slides_at_the_limit():
    """A torque keeps it from rolling: the floor bears the force up to friction times weight, and nothing beyond."""
    loads = [{"disk": 0, "force": [1.0, 0.0], "torque": 1.0}]
    alone, state = free_disks(
        [[500.0, 1.0 - 1.0 / 6000.0]], wall__friction=0.3, loads=loads, protocol__maximum_steps=5000
    )
    rest = finish(alone, state)
    problem = alone.with_loads(rest.position)
    up, back = follow(problem, rest, [0.29, 0.0])
    assert up.walls.tangential_force[0] == pytest.approx(0.29, abs=1e-12)
    assert back.walls.tangential_force[0] == pytest.approx(0.0, abs=1e-12)
    record = PathRecord()
    with pytest.raises(PathError):
        follow(problem, rest, [0.4], record=record)
    first = record.events[0]
    assert (first.kind, first.at_wall) == ("slides", True)
    assert first.load_factor == pytest.approx(0.3, abs=1e-8)


def squeezed(friction=0.1):
    """A disk in a slot that is too narrow for it, pressed down; the springs along the sides are slack at rest."""
    loads = [{"disk": 0, "force": [0.0, -1.0]}]
    rubs = {"contact__friction": friction, "wall__friction": friction}
    alone, state = free_disks([[1.0 - 1e-3, 1.0 - 1.0 / 6000.0]], width=2.0 - 2e-3, loads=loads, **rubs)
    rest = finish(alone, state)
    return alone.with_loads(rest.position), rest


def test_a_disk_between_walls_slides_along_both_at_one_load_and_sticks_where_the_load_turns():
    problem, rest = squeezed()
    law = problem.wall_law
    normal, tangential = law.normal_stiffness, law.tangential_stiffness
    slips = law.friction * 1e-3 * normal * (normal + 2.0 * tangential) / tangential
    target, unloaded = 2.0 * slips, 1.5 * slips
    before, state, back = follow(problem, rest, [0.5 * slips, target, unloaded])
    stiff = normal + 2.0 * tangential
    assert rest.position[0, 1] - before.position[0, 1] == pytest.approx(0.5 * slips / stiff, rel=1e-9)
    assert [(e.kind, e.second) for e in state.reached.events] == [("slides", 1), ("slides", 2)]
    assert [e.load_factor for e in state.reached.events] == [pytest.approx(slips, abs=1e-8)] * 2
    lower = slips / stiff + (target - slips) / normal
    assert rest.position[0, 1] - state.position[0, 1] == pytest.approx(lower, rel=1e-9)
    assert [(e.kind, e.second) for e in back.reached.events] == [("sticks", 1), ("sticks", 2)]
    assert {e.load_factor for e in back.reached.events} == {target}
    lower -= (target - unloaded) / stiff
    assert rest.position[0, 1] - back.position[0, 1] == pytest.approx(lower, rel=1e-9)


#: Packings of which rates are asked.
DRAWN = 300


def test_rates_of_random_packings_do_not_contradict_themselves():
    """Every contact at the limit slides in its direction or stays below, by a small step with the return map."""
    at_limit = stuck = 0
    for seed in range(DRAWN):
        rng = np.random.default_rng(seed)
        law = ("linear", "hertz")[seed % 2]
        push = rng.normal(size=2)
        problem = Problem.from_scene(
            scene(
                int(rng.integers(2, 4)), int(rng.integers(3, 5)), contact__law=law, contact__friction=0.3,
                wall__friction=0.2, loads=[{"disk": "top-centre", "force": (push / np.hypot(*push)).tolist()}],
            )
        )  # fmt: skip
        state = shaken(problem, seed, size=2e-4, spring=1e-5)
        problem = problem.with_loads(state.position)
        system, known = started(problem, state)
        trial = system.trial(known, known.q)
        friction = np.repeat([0.3, 0.2], [len(system.first), len(system.wall_disk)])
        limit = friction * trial.normal
        slides = (rng.random(len(limit)) < 0.4) & (trial.status != OPEN)
        stiffness = problem.pair_law.tangential_stiffness, problem.wall_law.tangential_stiffness
        stretched = limit / np.repeat(stiffness, [len(system.first), len(system.wall_disk)])
        sign = rng.choice([-1.0, 1.0], len(limit))
        known = type(known)(known.q, np.where(slides, -sign * stretched, known.spring), known.overlap)
        sense = np.where(slides, sign * SLIDING, trial.status).astype(np.int8)
        here = system.trial(known, known.q, fixed=sense)
        rates = RateProblem(system, 1.0, force=1e-9).solve(here, sense)
        assert rates is not None
        h = 1e-8
        kept, free = (system.trial(known, known.q + h * rates.velocity, fixed=f) for f in (rates.sense, None))
        # the forces of contacts grow as the load asks, up to the turn of those that bear something
        grown = (kept.contact_force - here.contact_force) / h
        assert np.abs(grown + problem.load_vector).max() < 2e-2 * max(1.0, np.abs(rates.velocity).max() * 10.0)
        assert np.array_equal(rates.sense[~slides], sense[~slides])
        assert (np.abs(rates.sense[slides]) == SLIDING).tolist() == (free.status[slides] == SLIDING).tolist()
        moving = np.abs(rates.sense) == SLIDING
        assert (np.sign(free.tangential[moving]) == np.sign(rates.sense[moving])).all()
        at_limit += int(slides.sum())
        stuck += int((rates.sense[slides] == STICKING).sum())
    assert 0.1 * at_limit < stuck < 0.9 * at_limit


@pytest.mark.parametrize(("less", "together"), [(3e-4, 2), (3e-3, 1)])
def test_contacts_that_contradict_themselves_change_all_at_once_for_some_rounds_and_then_the_worst(
    monkeypatch, less, together
):
    """Eight rounds, and then two times forty; of two contacts one is by a part less bad than the other."""
    problem = Problem.from_scene(scene())
    system, known = started(problem, problem.bare_state())
    trial = system.trial(known, known.q)
    begin = np.full(len(trial.sense), STICKING, np.int8)
    seen: list[np.ndarray] = []

    def contradicts(_self, _trial, _velocity, sense):
        """Two contacts, by a Gray code, so that no statuses come again."""
        step = 1 if np.array_equal(sense, begin) else contradicts.step + 1
        contradicts.step = step
        seen.append(sense)
        place = (step & -step).bit_length() - 1
        what, left, rate = np.zeros((3, len(sense)))
        two = [2 * place, 2 * place + 1]
        what[two] = np.where(sense[two] == STICKING, transitions.SLIDES, transitions.STICKS)
        left[:], rate[two] = 1.0, (1.0, 1.0 - less)
        left[two] = 0.0
        return transitions.Changes(what, left, rate)

    monkeypatch.setattr(RateProblem, "changes", contradicts)
    monkeypatch.setattr(RateProblem, "velocity", lambda *_: np.zeros(system.dof))
    monkeypatch.setattr(system, "updated_factor", lambda *_: None)
    monkeypatch.setattr(system, "renewed_factor", lambda *_: None)
    assert RateProblem(system, 1.0, force=1e-9).solve(trial, begin) is None
    begins = [k for k, sense in enumerate(seen) if np.array_equal(sense, begin)]
    assert np.diff([*begins, len(seen)]).tolist() == [8, 40, 40]
    assert [int((seen[k + 1] != begin).sum()) for k in begins] == [2, together, together]
